// Curves over a parameter, as the paper's figures 7 to 9 and 11 have them: logarithmic axes, a name beside
// the end of every curve.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace pellucid {

struct CurvePoint {
  double x = 0, y = 0;
};
struct Curve {
  std::string name;
  std::vector<CurvePoint> points;  // by rising x; broken where y is not finite
};
struct CurveChart {
  std::string title, x_title;
  std::vector<double> x_values;  // above 0: they get marks
  std::function<std::string(double)> x_text, y_text;
  bool is_share = false;  // y runs from 0 to 1; else its axis is logarithmic
  std::vector<Curve> curves;
};
std::string curve_chart_svg(const CurveChart& chart);

}  // namespace pellucid
