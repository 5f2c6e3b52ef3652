// See camera_text.h.
#include "camera_text.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

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

}  // namespace pellucid::cli
