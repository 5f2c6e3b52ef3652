// pellucid/budget_maps.h - room `report`: importance, k and loss of every pixel as heat maps.
#pragma once

#include <string>
#include <vector>

#include "pellucid/metric.h"
#include "pellucid/render.h"

namespace pellucid {

struct NamedMap {
  std::string name;     // "importance", "k", "loss"
  std::string caption;  // what the darkest colour stands for
  Image image;
};
// Of a picture drawn with RenderOptions::maps. White where nothing is; darker for more, in the colours of
// overdraw (overdraw_report.h), the darkest for the most of the picture. Of several samples of a pixel the
// first.
std::vector<NamedMap> budget_pictures(const RenderResult& result, std::uint32_t samples);

}  // namespace pellucid
