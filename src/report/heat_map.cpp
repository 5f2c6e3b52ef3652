// Fragments shaded in vain as colours, alone and side by side: see pellucid/overdraw_report.h.
#include <algorithm>
#include <cmath>

#include "report/overdraw_pictures.h"

namespace pellucid {
namespace {

constexpr Rgb kBackground{255, 255, 255};
// Even steps of OKLab lightness (0.915 to 0.265), so that the order survives any kind of colour vision and
// print without colour; the hue goes from blue to warm, so that the first fragment in vain is seen at once.
constexpr std::array<Rgb, kHeatSteps> kRamp{
    {{218, 228, 239}, {226, 170, 87}, {204, 101, 38}, {144, 45, 38}, {68, 16, 24}}};
// Between pictures, and where a row has none.
constexpr Rgb kGutterColor{196, 203, 211};
constexpr std::uint32_t kGutter = 2;  // pixels

void paint(Image& image, std::uint32_t x, std::uint32_t y, const Rgb& color) {
  std::copy(color.begin(), color.end(),
            image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * (std::size_t{y} * image.width + x)));
}

Image filled(std::uint32_t width, std::uint32_t height, const Rgb& color) {
  Image image{width, height, std::vector<std::uint8_t>(std::size_t{3} * width * height)};
  for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = color[i % 3];
  return image;
}

void check_size(const HeatMap& map) {
  if (map.shaded.size() == std::size_t{map.size} * map.size) return;
  throw Error(ErrorKind::bad_argument, "heat map of " + std::to_string(map.size) + " pixels a side with " +
                                           std::to_string(map.shaded.size()) + " pixels");
}

// With its upper left corner at (left, top).
void draw(Image& image, const HeatMap& map, std::uint32_t left, std::uint32_t top) {
  check_size(map);
  for (std::uint32_t y = 0; y < map.size; ++y) {
    for (std::uint32_t x = 0; x < map.size; ++x)
      paint(image, left + x, top + y, heat_color(map.shaded[std::size_t{y} * map.size + x]));
  }
}

}  // namespace

Rgb heat_color(std::uint32_t shaded) {
  return shaded == 0 ? kBackground : kRamp[std::min(shaded, kHeatSteps) - 1];
}

Rgb heat_between(double share) {
  const double place = 1 + std::clamp(share, 0.0, 1.0) * (kHeatSteps - 1);
  const auto low = static_cast<std::uint32_t>(place);
  const Rgb a = heat_color(low);
  const Rgb b = heat_color(std::min(low + 1, kHeatSteps));
  Rgb color{};
  for (std::size_t c = 0; c < color.size(); ++c)
    color.at(c) = static_cast<std::uint8_t>(std::lround(std::lerp(a.at(c), b.at(c), place - low)));
  return color;
}

Image heat_picture(const HeatMap& map) {
  Image image = filled(map.size, map.size, kBackground);
  draw(image, map, 0, 0);
  return image;
}

Image contact_sheet(const std::vector<std::vector<HeatMap>>& sheet) {
  std::size_t columns = 0;
  std::uint32_t cell = 0;
  for (const std::vector<HeatMap>& row : sheet) {
    columns = std::max(columns, row.size());
    for (const HeatMap& map : row) cell = std::max(cell, map.size);
  }
  if (cell == 0) return {};
  const std::uint32_t pitch = cell + kGutter;
  Image image = filled(static_cast<std::uint32_t>(columns) * pitch - kGutter,
                       static_cast<std::uint32_t>(sheet.size()) * pitch - kGutter, kGutterColor);
  for (std::uint32_t row = 0; row < sheet.size(); ++row) {
    for (std::uint32_t column = 0; column < sheet[row].size(); ++column)
      draw(image, sheet[row][column], column * pitch, row * pitch);
  }
  return image;
}

}  // namespace pellucid
