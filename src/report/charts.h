// Draws charts with named curves, and the parts that charts share: text, lines, colours, axes and places for
// names. In: points, names and axes. Out: SVG.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace pellucid {

// A <style> element for <svg class="chart">, with colours for light and dark backgrounds.
extern const char* const kChartStyle;

// Return text, which is escaped, or a line. `style` names classes of kChartStyle.
std::string text_svg(double x, double y, const char* anchor, const char* style, const std::string& text);
std::string line_svg(double x0, double y0, double x1, double y1, const char* style);
// Returns `content` in the colour and dashes of curve `index`, with the whole name of the curve as the
// tooltip.
std::string group_svg(std::size_t index, bool strong, const std::string& name, const std::string& content);

// Returns the name, cut to `length` characters of UTF-8 if it is longer.
std::string abbreviated(const std::string& name, std::size_t length);

// Returns the marks of a logarithmic axis from `least` to `most`, both above 0: 1, 2 and 5 times powers of
// ten, or powers of ten alone where there are many. The first mark is at or below `least`, the last at or
// above `most`.
std::vector<double> log_marks(double least, double most);

// Returns heights for names beside the ends of their curves, in the order of `ends`, between `top` and
// `bottom`, so that no name covers another.
std::vector<double> spread_labels(const std::vector<double>& ends, double top, double bottom);

// -------------------------------------------------------------------------------------------------- curves

// Curves over a parameter, as in figures 7 to 9 and 11 of Vasilakis, Fudos (TVCG 2014): with logarithmic
// axes, and the name of a curve beside its end.
struct ChartPoint {
  double x = 0, y = 0;
};
struct Curve {
  std::string name;
  std::vector<ChartPoint> points;  // by increasing x; the curve is interrupted where y is not finite
};
struct CurveChart {
  std::string title, x_title;
  std::vector<double> x_values;  // above 0; each gets a mark on the axis
  std::function<std::string(double)> x_text, y_text;
  bool is_share = false;  // y runs from 0 to 1; otherwise its axis is logarithmic
  std::vector<Curve> curves;
};
std::string curve_chart_svg(const CurveChart& chart);

}  // namespace pellucid
