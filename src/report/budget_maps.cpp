// Importance, k and loss of every pixel as heat maps: see pellucid/budget_maps.h.
#include "pellucid/budget_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "overdraw_pictures.h"

namespace pellucid {
namespace {

// Between the colours of the ramp, so that small differences show.
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

template <class Value>
NamedMap map_of(const std::string& name, const std::string& words, const std::vector<Value>& values,
                const RenderResult& result, std::uint32_t samples) {
  NamedMap map{name, {}, {result.width, result.height, {}}};
  const Value most = values.empty() ? Value{} : *std::max_element(values.begin(), values.end());
  for (std::size_t p = 0; p < values.size(); p += samples) {
    const double share = most > 0 ? static_cast<double>(values[p]) / static_cast<double>(most) : 0;
    const Rgb color = values[p] > 0 ? heat_between(share) : heat_color(0);
    map.image.rgb.insert(map.image.rgb.end(), color.begin(), color.end());
  }
  map.caption = fmt::format("{}: white 0, darkest {:.4g}", words, static_cast<double>(most));
  return map;
}

}  // namespace

std::vector<NamedMap> budget_pictures(const RenderResult& result, std::uint32_t samples) {
  const BudgetMaps& maps = result.maps;
  if (maps.k.empty()) return {};
  return {map_of("importance", "importance", maps.importance, result, samples),
          map_of("k", "k, slots for fragments", maps.k, result, samples),
          map_of("loss", "fragments lost to the tail", maps.lost, result, samples)};
}

}  // namespace pellucid
