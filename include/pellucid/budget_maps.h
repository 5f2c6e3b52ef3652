// pellucid/budget_maps.h - module `report`: what is in every pixel as heat maps: fragments and coplanar ones
// of a scene; importance, k and loss of techniques with a budget.
#pragma once

#include <string>
#include <vector>

#include "pellucid/metric.h"
#include "pellucid/render.h"

namespace pellucid {

struct NamedMap {
  std::string name;     // "importance", "k", "loss", "fragments", "coplanar"
  std::string caption;  // what the darkest colour stands for
  Image image;
  std::string words, unit;  // "fragments lost to the tail", "fragments"
  double most = 0;          // what the darkest colour stands for
};
// Of a picture drawn with RenderOptions::maps. White where nothing is; darker for more, in the colours of
// overdraw (overdraw_report.h), the darkest for the most of the picture. Of several samples of a pixel the
// first.
std::vector<NamedMap> budget_pictures(const RenderResult& result, std::uint32_t samples);

// Of a picture drawn with RenderOptions::keep_fragments, in the same colours: fragments of every pixel, and
// those of them that share their depth with another (the first sample's). Empty without fragments.
std::vector<NamedMap> fragment_pictures(const RenderResult& result, std::uint32_t samples);

}  // namespace pellucid
