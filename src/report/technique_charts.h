// Techniques as points, error over what they cost, and as bars: those that promise everything in one colour,
// the others in another.
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

}  // namespace pellucid
