// Draws charts of techniques: error over cost as points, and measured values as bars. Techniques that promise
// to capture everything have one colour, the others another. In: measured values of techniques. Out: SVG.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace pellucid {

struct TechniquePoint {
  std::string name, tooltip;
  bool exact = false;  // the technique promises to capture every fragment
  bool equal = false;  // no visible error: the point is on the line of the exact image
  double cost = 0;     // above 0
  double psnr = 0;     // not used where `equal` is set
};
struct CostChart {
  std::string title, x_title;
  std::function<std::string(double)> x_text;
  std::vector<TechniquePoint> points;
};
// Returns a chart with cost along a logarithmic axis and PSNR upwards. A line above it holds all techniques
// that equal the exact image. Steps join the Pareto front: the techniques that no other technique beats in
// both.
std::string cost_chart_svg(const CostChart& chart);

struct BarColumn {
  std::string title;
  std::vector<double> values;       // one per row: 0 or more; a row without a finite value has no bar
  std::vector<std::string> labels;  // beside the bars
};
struct BarChart {
  std::string title;
  std::vector<std::string> names;  // of the rows
  std::vector<bool> exact;
  std::vector<BarColumn> columns;
};
// Returns a row of bars for every technique. Bars that would make all others too short are cut.
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

struct PlacedLabel {
  LabelBox box;
  bool far = false;  // a line leads from the point to its name
};
// Returns a box for the name of every point, as near to the point as possible within `area`, so that names
// cover neither each other nor points. If there is no free place, the name is to the right of its point.
std::vector<PlacedLabel> place_labels(const std::vector<LabelPoint>& points, const LabelBox& area);

}  // namespace pellucid
