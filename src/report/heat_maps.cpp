// Implements heat_maps.h and the heat maps of the public headers: overdraw, alone and side by side, and
// fragments and memory budgets of every pixel. In: counts or shares of every pixel. Out: images.
#include "report/heat_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellucid/compare_report.h"

namespace pellucid {
namespace {

// ------------------------------------------------------------------------------------------------ overdraw

constexpr Rgb kBackground{255, 255, 255};
// Even steps of OKLab lightness (0.915 to 0.265), so that the colours keep their order for any kind of colour
// vision and in print without colour. The hue changes from blue to warm, so that the first wasted fragment
// stands out.
constexpr std::array<Rgb, kHeatSteps> kRamp{
    {{218, 228, 239}, {226, 170, 87}, {204, 101, 38}, {144, 45, 38}, {68, 16, 24}}};
// The colour between images, and in places where a row has no image.
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

// Draws a map with its upper left corner at (left, top).
void draw(Image& image, const HeatMap& map, std::uint32_t left, std::uint32_t top) {
  check_size(map);
  for (std::uint32_t y = 0; y < map.size; ++y) {
    for (std::uint32_t x = 0; x < map.size; ++x)
      paint(image, left + x, top + y, heat_color(map.shaded[std::size_t{y} * map.size + x]));
  }
}

// ----------------------------------------------------------------------------------- fragments and budgets

struct MapWords {
  std::string name, words, unit;
};

template <class Value>
NamedMap heat_map_of(const MapWords& words, const std::vector<Value>& values, const RenderResult& result,
                     std::uint32_t samples) {
  NamedMap map{words.name, {}, {result.width, result.height, {}}, words.words, words.unit};
  const Value most = values.empty() ? Value{} : *std::max_element(values.begin(), values.end());
  for (std::size_t p = 0; p < values.size(); p += samples) {
    const double share = most > 0 ? static_cast<double>(values[p]) / static_cast<double>(most) : 0;
    const Rgb color = values[p] > 0 ? heat_between(share) : heat_color(0);
    map.image.rgb.insert(map.image.rgb.end(), color.begin(), color.end());
  }
  map.most = static_cast<double>(most);
  map.caption = fmt::format("{}: white 0, darkest {:.4g}", words.words, map.most);
  return map;
}

// Returns the number of fragments that share their depth with another one. Sorts the list.
std::uint32_t count_coplanar(std::vector<float>& depths) {
  std::sort(depths.begin(), depths.end());
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const bool as_before = i > 0 && depths[i - 1] == depths[i];
    const bool as_next = i + 1 < depths.size() && depths[i + 1] == depths[i];
    count += as_before || as_next ? 1U : 0U;
  }
  return count;
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

Image heat_image(const HeatMap& map) {
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

std::vector<NamedMap> budget_heat_maps(const RenderResult& result, std::uint32_t samples) {
  const BudgetMaps& maps = result.maps;
  if (maps.k.empty()) return {};
  return {heat_map_of({"importance", "importance", ""}, maps.importance, result, samples),
          heat_map_of({"k", "k, slots for fragments", "slots"}, maps.k, result, samples),
          heat_map_of({"loss", "fragments lost to the tail", "fragments"}, maps.lost, result, samples)};
}

std::vector<NamedMap> fragment_heat_maps(const RenderResult& result, std::uint32_t samples) {
  const CapturedFragments& captured = result.fragments;
  if (captured.offsets.size() < 2) return {};
  std::vector<std::uint32_t> fragments;
  std::vector<std::uint32_t> coplanar;
  std::vector<float> depths;
  for (std::size_t p = 0; p + 1 < captured.offsets.size(); ++p) {
    depths.clear();
    for (std::uint64_t i = captured.offsets[p]; i < captured.offsets[p + 1]; ++i)
      depths.push_back(captured.fragments[i].depth);
    fragments.push_back(static_cast<std::uint32_t>(depths.size()));
    coplanar.push_back(count_coplanar(depths));
  }
  return {
      heat_map_of({"fragments", "fragments of a pixel", "fragments"}, fragments, result, samples),
      heat_map_of({"coplanar", "fragments at the depth of another", "fragments"}, coplanar, result, samples)};
}

}  // namespace pellucid
