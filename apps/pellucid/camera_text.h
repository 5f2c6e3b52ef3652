// Cameras as --camera and the lines of --path have them.
#pragma once

#include <string>
#include <string_view>

#include "pellucid/view.h"

namespace pellucid::cli {

// "orbit:30,20,3" or "30,20,3": azimuth and elevation in degrees, distance in bounding radii (or inf).
Viewpoint parse_camera(const std::string& text);

// "file:NAME" or "file:NUMBER"?
constexpr std::string_view kFileCamera = "file:";
bool is_file_camera(const std::string& text);

}  // namespace pellucid::cli
