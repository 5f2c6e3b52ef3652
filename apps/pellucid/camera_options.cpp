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
        fmt::format("--camera: '{}' is not azimuth,elevation,distance (degrees, degrees, radii)", whole));
  }
  return value;
}

}  // namespace

Viewpoint parse_camera(const std::string& text) {
  const std::string orbit = "orbit:";
  const std::string numbers = text.starts_with(orbit) ? text.substr(orbit.size()) : text;
  const std::size_t first = numbers.find(',');
  const std::size_t second = first == std::string::npos ? first : numbers.find(',', first + 1);
  if (second == std::string::npos) parse_number("", text);
  const double radians = std::numbers::pi / 180;
  const double azimuth = radians * parse_number(numbers.substr(0, first), text);
  const double elevation = radians * parse_number(numbers.substr(first + 1, second - first - 1), text);
  const double distance = parse_number(numbers.substr(second + 1), text);
  if (!std::isfinite(azimuth) || !std::isfinite(elevation)) parse_number("", text);
  if (!(distance > 1)) {
    throw Error(ErrorKind::bad_argument, "--camera: the distance must be more than 1 bounding radius");
  }
  return {
      {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth)},
      distance};
}

bool is_file_camera(const std::string& text) {
  return text.starts_with(kFileCamera);
}

Camera camera_from(const std::string& text, const Model& model, const Scene& scene, std::uint32_t width,
                   std::uint32_t height) {
  if (!is_file_camera(text)) return look_at_sphere(scene.sphere, parse_camera(text), width, height);
  return file_camera(model, text.substr(kFileCamera.size()), scene, width, height);
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
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    ++number;
    const std::string camera = trimmed(line.substr(0, line.find('#')));
    if (camera.empty()) continue;
    shots.push_back(shot_of(camera));
    if (is_file_camera(shots.back().camera)) continue;
    try {
      parse_camera(shots.back().camera);
    } catch (const Error&) {
      throw Error(ErrorKind::bad_input,
                  fmt::format("{}:{}: '{}' is no camera: AZIMUTH,ELEVATION,DISTANCE, and "
                              "maybe the time",
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
