// A scene at a moment of an animation.
#pragma once

#include <optional>
#include <string>

#include "scene.h"

namespace pellucid::cli {

// Moves the vertices of `scene`, which is that of `model`, to where they are at `time` (seconds) of the
// animation of that name or number, with normals to match; without a name to where skins and morph targets
// have them at rest. Throws Error{bad_argument} for an animation that is not there.
// Returns the number of the animation, if there is a name.
std::optional<std::uint32_t> pose_scene(const Model& model, const std::string& animation, double time,
                                        Scene& scene);

}  // namespace pellucid::cli
