// What is in every pixel as heat maps: see pellucid/budget_maps.h.
#include "pellucid/budget_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/overdraw_pictures.h"

namespace pellucid {
namespace {

struct MapWords {
  std::string name, words, unit;
};

template <class Value>
NamedMap map_of(const MapWords& words, const std::vector<Value>& values, const RenderResult& result,
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

// Of a list in any sequence, which it sorts: fragments at the depth of another one.
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

std::vector<NamedMap> budget_pictures(const RenderResult& result, std::uint32_t samples) {
  const BudgetMaps& maps = result.maps;
  if (maps.k.empty()) return {};
  return {map_of({"importance", "importance", ""}, maps.importance, result, samples),
          map_of({"k", "k, slots for fragments", "slots"}, maps.k, result, samples),
          map_of({"loss", "fragments lost to the tail", "fragments"}, maps.lost, result, samples)};
}

std::vector<NamedMap> fragment_pictures(const RenderResult& result, std::uint32_t samples) {
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
  return {map_of({"fragments", "fragments of a pixel", "fragments"}, fragments, result, samples),
          map_of({"coplanar", "fragments at the depth of another", "fragments"}, coplanar, result, samples)};
}

}  // namespace pellucid
