// Cameras in the form of --camera and of the lines of --path. In: text. Out: cameras and times.
#pragma once

#include <CLI/CLI.hpp>
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
// inf), which may lie inside the bounding sphere. Without a distance ("30,20") it is kFitDistance, see
// fits(). Throws Error{bad_argument}.
Viewpoint parse_camera(const std::string& text);

// A camera without a distance is turned and zoomed until the scene fills the image.
constexpr double kFitDistance = 3;
bool fits(const std::string& text);

// What else there is to say about a camera.
struct LensOptions {
  std::string target;  // "X,Y,Z" in the coordinates of the file: what the camera looks at and goes round
  double zoom = 1;     // enlarges the image
  std::optional<double> fov;         // vertical angle of view in degrees
  std::optional<double> near_plane;  // in the units of the file: nothing nearer is drawn
};
// Adds --target, --zoom, --fov and --near.
void add_lens_options(CLI::App& command, LensOptions& lens);

// Returns whether the text is "file:NAME" or "file:NUMBER".
constexpr std::string_view kFileCamera = "file:";
bool is_file_camera(const std::string& text);

// Returns the camera that the text names: one of the file, with near and far planes fitted to the scene, or
// one that parse_camera() reads. Throws Error{bad_argument} for a camera that does not exist, and for lens
// options that do not fit it.
Camera camera_from(const std::string& text, const LensOptions& lens, const Model& model, const Scene& scene,
                   std::uint32_t width, std::uint32_t height);

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
