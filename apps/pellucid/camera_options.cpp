// Implements camera_options.h: cameras as text.
#include "camera_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "pellucid/base.h"

namespace pellucid::cli {
namespace {

double parse_number(const std::string& item, const std::string& whole) {
  if (item == "inf") return kInfiniteDistance;
  char* rest = nullptr;
  const double value = std::strtod(item.c_str(), &rest);
  if (item.empty() || rest != item.c_str() + item.size() || !std::isfinite(value)) {
    throw Error(
        ErrorKind::bad_argument,
        fmt::format(
            "--camera: '{}' is not azimuth,elevation or azimuth,elevation,distance (degrees, degrees, radii)",
            whole));
  }
  return value;
}

}  // namespace

Viewpoint parse_camera(const std::string& text) {
  const std::string orbit = "orbit:";
  const std::string numbers = text.starts_with(orbit) ? text.substr(orbit.size()) : text;
  const std::size_t first = numbers.find(',');
  if (first == std::string::npos) parse_number("", text);
  const std::size_t second = std::min(numbers.find(',', first + 1), numbers.size());
  const double radians = std::numbers::pi / 180;
  const double azimuth = radians * parse_number(numbers.substr(0, first), text);
  const double elevation = radians * parse_number(numbers.substr(first + 1, second - first - 1), text);
  const double distance =
      second == numbers.size() ? kFitDistance : parse_number(numbers.substr(second + 1), text);
  if (!std::isfinite(azimuth) || !std::isfinite(elevation)) parse_number("", text);
  if (!(distance > 0)) throw Error(ErrorKind::bad_argument, "--camera: the distance must be greater than 0");
  return {
      {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth)},
      distance};
}

bool fits(const std::string& text) {
  return !is_file_camera(text) && std::count(text.begin(), text.end(), ',') == 1;
}

bool is_file_camera(const std::string& text) {
  return text.starts_with(kFileCamera);
}

void add_lens_options(CLI::App& command, LensOptions& lens) {
  constexpr const char* kGroup = "Camera";
  command
      .add_option("--target", lens.target,
                  "What the camera looks at and goes round, in the file's coordinates (default: the middle "
                  "of the scene)")
      ->type_name("X,Y,Z")
      ->group(kGroup);
  command.add_option("--zoom", lens.zoom, "Enlarge the image by this factor")
      ->check(CLI::Range(1e-3, 1e6))
      ->type_name("X")
      ->capture_default_str()
      ->group(kGroup);
  command
      .add_option("--fov", lens.fov,
                  "Vertical angle of view in degrees (default: what shows the whole scene)")
      ->check(CLI::Range(0.01, 179.0))
      ->type_name("DEGREES")
      ->group(kGroup);
  command
      .add_option("--near", lens.near_plane,
                  "Draw nothing nearer to the camera than this, in the file's units")
      ->check(CLI::PositiveNumber)
      ->type_name("X")
      ->group(kGroup);
}

namespace {

Vec3d parse_target(const std::string& text) {
  Vec3d target;
  const char* at = text.c_str();
  for (double* coordinate : {&target.x, &target.y, &target.z}) {
    char* end = nullptr;
    *coordinate = std::strtod(at, &end);
    const char expected = coordinate == &target.z ? '\0' : ',';
    if (end == at || *end != expected || !std::isfinite(*coordinate))
      throw Error(ErrorKind::bad_argument, fmt::format("--target: '{}' is not X,Y,Z", text));
    at = end + 1;
  }
  return target;
}

// Fits near and far planes to what lies in front of a perspective camera.
void fit_depths(const BoundingSphere& sphere, Camera& camera) {
  constexpr double kNearest = 1e-4;  // of the far plane
  const double depth = dot(sphere.center - camera.eye, camera.forward);
  camera.far_plane = std::max(depth + sphere.radius, sphere.radius) * 1.001;
  camera.near_plane = std::max((depth - sphere.radius) * 0.999, kNearest * camera.far_plane);
}

// The part of the image plane that the scene covers, at the distance 1 of a perspective camera.
struct Covered {
  double left = INFINITY, right = -INFINITY, low = INFINITY, high = -INFINITY;
};
Covered covered_by(const Mesh& mesh, const Camera& camera) {
  Covered covered;
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      const Vec3d offset = to_double(mesh.positions[vertex]) - camera.eye;
      const double depth = dot(offset, camera.forward);
      const double x = dot(offset, camera.right) / depth;
      const double y = dot(offset, camera.up) / depth;
      covered.left = std::min(covered.left, x);
      covered.right = std::max(covered.right, x);
      covered.low = std::min(covered.low, y);
      covered.high = std::max(covered.high, y);
    }
  }
  return covered;
}

// Turns the camera to the middle of what it sees, and sets the angle of view so that the scene fills the
// image but for a small margin. The camera is outside of the bounding sphere.
void fill_image(const Scene& scene, Camera& camera) {
  constexpr double kMargin = 1.04;
  constexpr int kTurns = 4;  // each halves the distance from the middle many times over
  for (int turn = 0; turn < kTurns; ++turn) {
    const Covered seen = covered_by(scene.mesh, camera);
    const Vec3d up = camera.up;
    camera.forward = normalized(camera.forward + camera.right * (0.5 * (seen.left + seen.right)) +
                                camera.up * (0.5 * (seen.low + seen.high)));
    camera.right = normalized(cross(camera.forward, up));
    camera.up = cross(camera.right, camera.forward);
  }
  const Covered seen = covered_by(scene.mesh, camera);
  const double across = std::max(-seen.left, seen.right) * camera.height / camera.width;
  const double upward = std::max(-seen.low, seen.high);
  const double half_height = kMargin * std::max(across, upward);
  if (half_height > 0) camera.half_height = half_height;
  fit_depths(scene.sphere, camera);
}

}  // namespace

Camera camera_from(const std::string& text, const LensOptions& lens, const Model& model, const Scene& scene,
                   std::uint32_t width, std::uint32_t height) {
  const bool of_file = is_file_camera(text);
  if (of_file && !lens.target.empty())
    throw Error(ErrorKind::bad_argument, "--target: a camera of the file looks where the file says");
  Camera camera = of_file ? file_camera(model, text.substr(kFileCamera.size()), scene, width, height)
                          : look_at_sphere(scene.sphere, parse_camera(text), width, height);
  if (lens.fov && !camera.perspective)
    throw Error(ErrorKind::bad_argument, "--fov: the camera is orthographic and has no angle of view");
  if (!lens.target.empty()) {
    camera.eye += parse_target(lens.target) - scene.origin - scene.sphere.center;
    if (camera.perspective) fit_depths(scene.sphere, camera);
  } else if (fits(text) && !lens.fov) {
    fill_image(scene, camera);
  }
  if (lens.fov) camera.half_height = std::tan(*lens.fov * std::numbers::pi / 360);
  camera.half_height /= lens.zoom;
  if (lens.near_plane) {
    if (*lens.near_plane >= camera.far_plane)
      throw Error(ErrorKind::bad_argument, "--near: the whole scene is nearer to the camera");
    camera.near_plane = *lens.near_plane;
  }
  return camera;
}

namespace {

constexpr std::uint64_t kMostPathBytes = std::uint64_t{1} << 24U;
constexpr const char* kBlanks = " \t\r";

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
}

// Returns the number that the whole text is, and nothing for other texts.
std::optional<double> number_in(const std::string& text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc{} && end == text.data() + text.size() && std::isfinite(number);
  return whole ? std::optional(number) : std::nullopt;
}

// Reads a line of --path. Names of cameras may contain blanks, so the time is what follows the last blank, if
// that is a number.
Shot shot_of(const std::string& line) {
  const std::size_t blank = line.find_last_of(kBlanks);
  if (blank != std::string::npos) {
    const std::optional<double> time = number_in(line.substr(blank + 1));
    if (time) return {trimmed(line.substr(0, blank)), time};
  }
  return {line, std::nullopt};
}

}  // namespace

std::vector<Shot> orbit(const std::string& camera, std::uint32_t count) {
  if (is_file_camera(camera))
    throw Error(ErrorKind::bad_argument,
                "--orbit: goes round the scene, so --camera must not be of the file");
  const Viewpoint start = parse_camera(camera);
  const double degrees = 180 / std::numbers::pi;
  const double azimuth = degrees * std::atan2(start.direction.x, start.direction.z);
  const double elevation = degrees * std::asin(std::clamp(start.direction.y, -1.0, 1.0));
  std::vector<Shot> shots;
  for (std::uint32_t i = 0; i < count; ++i)
    shots.push_back(
        {fmt::format("{:.10g},{:.10g},{:.10g}", azimuth + 360.0 * i / count, elevation, start.distance), {}});
  return shots;
}

std::vector<Shot> read_camera_path(const std::string& path) {
  const std::vector<std::byte> bytes = read_file(path, kMostPathBytes);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::vector<Shot> shots;
  std::size_t number = 0;
  for (const std::string& line : text_lines(text)) {
    ++number;
    const std::string camera = trimmed(line.substr(0, line.find('#')));
    if (camera.empty()) continue;
    shots.push_back(shot_of(camera));
    if (is_file_camera(shots.back().camera)) continue;
    try {
      parse_camera(shots.back().camera);
    } catch (const Error&) {
      throw Error(ErrorKind::bad_input, fmt::format("{}:{}: '{}' is no camera: AZIMUTH,ELEVATION or "
                                                    "AZIMUTH,ELEVATION,DISTANCE, and maybe the time",
                                                    path, number, camera));
    }
  }
  if (shots.empty()) throw Error(ErrorKind::bad_input, path + ": there are no cameras in it");
  return shots;
}

std::string numbered_output(const std::string& output, std::size_t number, std::size_t count) {
  const std::filesystem::path path(output);
  const std::size_t digits = std::max<std::size_t>(std::to_string(count).size(), 3);
  const std::string name =
      fmt::format("{}-{:0{}}{}", path.stem().string(), number, digits, path.extension().string());
  return (path.parent_path() / name).string();
}

}  // namespace pellucid::cli
