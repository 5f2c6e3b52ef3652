// charts.h
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace pellucid {

// A <style> for <svg class="chart">, for light and dark ground.
extern const char* const kChartStyle;

// `text` is escaped; `style`: classes of kChartStyle.
std::string text_svg(double x, double y, const char* anchor, const char* style, const std::string& text);
std::string line_svg(double x0, double y0, double x1, double y1, const char* style);
// What belongs to curve `index`, in its colour and dashes; its whole name is the tooltip.
std::string group_svg(std::size_t index, bool strong, const std::string& name, const std::string& content);

// At most `length` characters of UTF-8: its continuation bytes stay with the byte they follow.
std::string abbreviated(const std::string& name, std::size_t length);

// Marks of a logarithmic axis that runs from `least` to `most`, above 0: 1, 2 and 5 times powers of ten, or
// powers alone where there are many. The first is not above `least`, the last not below `most`.
std::vector<double> log_marks(double least, double most);

// Heights for names beside the ends of their curves, in the same order, from `top` to `bottom` but not over
// each other.
std::vector<double> spread_labels(const std::vector<double>& ends, double top, double bottom);

// -------------------------------------------------------------------------------------------------- curves

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
