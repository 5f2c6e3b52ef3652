// Several pictures of one scene: where the camera is for each, and when.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pellucid::cli {

struct Shot {
  std::string camera;          // as --camera has it
  std::optional<double> time;  // seconds of --animation; none: --time
};

// `count` cameras around the scene, evenly, the first where `camera` (AZIMUTH,ELEVATION,DISTANCE) is. Throws
// Error{bad_argument} for a camera of a file.
std::vector<Shot> orbit(const std::string& camera, std::uint32_t count);

// One camera a line, as --camera has it, and after a space, where there is one, the time. Empty lines, and
// what follows a #, are nothing. Throws Error{bad_input} naming file and line, Error{cannot_read}.
std::vector<Shot> read_camera_path(const std::string& path);

// "out.png" -> "out-007.png": the picture with this number (from 1) of `count`.
std::string numbered_output(const std::string& output, std::size_t number, std::size_t count);

}  // namespace pellucid::cli
