// checks.h - the list of techniques, and checks of what is asked of them before anything is drawn. Each check
// throws Error{bad_argument} that says what is wrong.
#pragma once

#include "render/capture/technique.h"

namespace pellucid::render {

// Returns the technique of that name. Throws where there is none, or `device` lacks what it needs.
const TechniqueEntry& find_technique(const RenderOptions& options, const DeviceInfo& device);
void check_options(const Camera& camera, const RenderOptions& options, const DeviceInfo& device,
                   std::uint32_t objects);
void check_technique(const TechniqueInfo& technique, const RenderOptions& options, const DeviceInfo& device);

// Returns what KBufferOptions::sync means for a technique; automatic: it has no choice. Throws where the
// device does not support what is asked for, or does not have enough attachments.
Sync choose_sync(const TechniqueInfo& technique, const RenderOptions& options, const DeviceInfo& device);

}  // namespace pellucid::render
