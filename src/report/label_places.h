// Places for names beside points of a chart, so that they cover neither each other nor the points.
#pragma once

#include <string>
#include <vector>

namespace pellucid {

struct LabelBox {
  double left = 0, top = 0, right = 0, bottom = 0;
  [[nodiscard]] bool meets(const LabelBox& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
  [[nodiscard]] bool holds(const LabelBox& other) const {
    return left <= other.left && other.right <= right && top <= other.top && other.bottom <= bottom;
  }
};

struct LabelPoint {
  double x = 0, y = 0;
  std::string name;
};

// The box of every name, as near to its point as there is room within `area`, and `far`, where a line has to
// lead to it. Where there is no room left at all, to the right of its point, over what is there.
struct PlacedLabel {
  LabelBox box;
  bool far = false;
};
std::vector<PlacedLabel> place_labels(const std::vector<LabelPoint>& points, const LabelBox& area);

}  // namespace pellucid
