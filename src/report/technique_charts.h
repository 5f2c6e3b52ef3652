// technique_charts.h
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace pellucid {

struct TechniquePoint {
  std::string name, tooltip;
  bool exact = false;  // by promise
  bool equal = false;  // nothing can be seen of its error: it stands on the line of the exact picture
  double cost = 0;     // above 0
  double psnr = 0;     // of those that are not equal
};
struct CostChart {
  std::string title, x_title;
  std::function<std::string(double)> x_text;
  std::vector<TechniquePoint> points;
};
// Cost along a logarithmic axis, PSNR upwards, and above it a line for all that equal the exact picture.
// Steps join those that nothing beats in both.
std::string cost_chart_svg(const CostChart& chart);

struct BarColumn {
  std::string title;
  std::vector<double> values;       // of every row; 0 or more, or not finite: no bar
  std::vector<std::string> labels;  // beside the bars
};
struct BarChart {
  std::string title;
  std::vector<std::string> names;  // of the rows
  std::vector<bool> exact;
  std::vector<BarColumn> columns;
};
// A row of bars for every technique. Bars that would make all others too short are cut.
std::string bar_chart_svg(const BarChart& chart);

// ---------------------------------------------------------------------------------------- places for names

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
