// Cameras of --camera: around the scene, or those of the file.
#pragma once

#include <string>

#include "camera_text.h"
#include "scene.h"

namespace pellucid::cli {

// What --camera says: a camera of the file, its planes fitted to the scene, or as parse_camera has it. Throws
// Error{bad_argument} for a camera that is not there.
Camera camera_from(const std::string& text, const Model& model, const Scene& scene, std::uint32_t width,
                   std::uint32_t height);

}  // namespace pellucid::cli
