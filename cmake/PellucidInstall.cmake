# Placeholder replaced by the packaging step.
