// A scene at a moment of an animation.
#pragma once

#include <string>

#include "scene.h"

namespace pellucid::cli {

// Moves the vertices of `scene`, which is that of `model`, to where they are at `time` (seconds) of the
// animation of that name or number, with normals to match; without a name to where skins and morph targets
// have them at rest. Throws Error{bad_argument} for an animation that is not there.
void pose_scene(const Model& model, const std::string& animation, double time, Scene& scene);

}  // namespace pellucid::cli
