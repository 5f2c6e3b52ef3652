// Cameras in the form of --camera and of the lines of --path. In: text. Out: cameras and times.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pellucid/asset.h"
#include "pellucid/raster.h"
#include "pellucid/scene.h"
#include "pellucid/view.h"

namespace pellucid::cli {

// Reads "orbit:30,20,3" or "30,20,3": azimuth and elevation in degrees, and distance in bounding radii (or
// inf). Throws Error{bad_argument}.
Viewpoint parse_camera(const std::string& text);

// Returns whether the text is "file:NAME" or "file:NUMBER".
constexpr std::string_view kFileCamera = "file:";
bool is_file_camera(const std::string& text);

// Returns the camera that the text names: one of the file, with near and far planes fitted to the scene, or
// one that parse_camera() reads. Throws Error{bad_argument} for a camera that does not exist.
Camera camera_from(const std::string& text, const Model& model, const Scene& scene, std::uint32_t width,
                   std::uint32_t height);

// One of several images of a scene: its camera and its time.
struct Shot {
  std::string camera;          // as for --camera
  std::optional<double> time;  // seconds of --animation; empty: as for --time
};

// Returns `count` cameras around the scene, evenly spaced, beginning at `camera`
// (AZIMUTH,ELEVATION,DISTANCE). Throws Error{bad_argument} for a camera of a file.
std::vector<Shot> orbit(const std::string& camera, std::uint32_t count);

// Reads one camera per line, as for --camera, with an optional time after a space. Ignores empty lines and
// everything after a #. Throws Error{bad_input} that names the file and the line.
std::vector<Shot> read_camera_path(const std::string& path);

// Returns "out-007.png" for "out.png": the image with this number (from 1) of `count`.
std::string numbered_output(const std::string& output, std::size_t number, std::size_t count);

}  // namespace pellucid::cli
