// Curves over a parameter: see curve_chart.h.
#include "report/curve_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellucid/report.h"
#include "report/chart_parts.h"

namespace pellucid {
namespace {

constexpr double kWidth = 960;
constexpr double kLeft = 84;
constexpr double kRight = 800;  // names of the curves stand to the right
constexpr double kTop = 48;
constexpr double kLeastHeight = 240;  // of the plot
constexpr double kCurveHeight = 16;   // room for a name
constexpr double kBelow = 52;         // room for the axis
constexpr std::size_t kNameLength = 15;

class Plot {
 public:
  explicit Plot(const CurveChart& chart)
      : chart_(chart),
        bottom_(kTop + std::max(kLeastHeight, kCurveHeight * static_cast<double>(chart.curves.size()))) {
    choose_x();
    choose_y();
  }

  [[nodiscard]] double height() const { return bottom_ + kBelow; }
  [[nodiscard]] std::string svg() const {
    return text_svg(20, 24, "start", "", chart_.title) + grid() + curves();
  }

 private:
  void choose_x() {
    if (chart_.x_values.empty()) return;
    x0_ = std::log(chart_.x_values.front());
    x1_ = std::log(chart_.x_values.back());
    if (x1_ - x0_ < 1e-9) x1_ = x0_ + 1;
  }

  void choose_y() {
    if (chart_.is_share) {
      marks_ = {0, 0.2, 0.4, 0.6, 0.8, 1};
      y1_ = 1;
      return;
    }
    double least = INFINITY;
    double most = 0;
    for (const Curve& curve : chart_.curves) {
      for (const CurvePoint& point : curve.points) {
        if (!is_shown(point)) continue;
        least = std::min(least, point.y);
        most = std::max(most, point.y);
      }
    }
    if (most <= 0) least = most = 1;
    marks_ = log_marks(least, most);
    y0_ = std::log(marks_.front());
    y1_ = std::max(std::log(marks_.back()), y0_ + 1e-9);
  }

  [[nodiscard]] bool is_shown(const CurvePoint& point) const {
    return std::isfinite(point.y) && (chart_.is_share || point.y > 0);
  }
  [[nodiscard]] double x(double value) const {
    return kLeft + (kRight - kLeft) * (std::log(value) - x0_) / (x1_ - x0_);
  }
  [[nodiscard]] double y(double value) const {
    const double at = chart_.is_share ? value : std::log(value);
    return bottom_ - (bottom_ - kTop) * (at - y0_) / (y1_ - y0_);
  }

  [[nodiscard]] std::string grid() const {
    std::string svg;
    for (const double mark : marks_) {
      svg += line_svg(kLeft, y(mark), kRight, y(mark), mark == marks_.front() ? "axis" : "grid");
      svg += text_svg(kLeft - 8, y(mark) + 4, "end", "small soft", chart_.y_text(mark));
    }
    for (const double value : chart_.x_values) {
      svg += line_svg(x(value), bottom_, x(value), bottom_ + 5, "axis");
      svg += text_svg(x(value), bottom_ + 20, "middle", "small soft", chart_.x_text(value));
    }
    return svg + text_svg((kLeft + kRight) / 2, bottom_ + 42, "middle", "small soft", chart_.x_title);
  }

  [[nodiscard]] std::string line_of(const Curve& curve) const {
    std::string svg;
    std::string points;
    std::string dots;
    const auto close = [&] {
      if (!points.empty()) svg += "<polyline points=\"" + points + "\"/>\n";
      points.clear();
    };
    for (const CurvePoint& point : curve.points) {
      if (!is_shown(point)) {
        close();
        continue;
      }
      points += fmt::format("{}{:.1f},{:.1f}", points.empty() ? "" : " ", x(point.x), y(point.y));
      dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.6\"/>\n", x(point.x), y(point.y));
    }
    close();
    return svg + dots;
  }

  [[nodiscard]] std::string curves() const {
    std::vector<std::size_t> named;
    std::vector<double> ends;
    for (std::size_t c = 0; c < chart_.curves.size(); ++c) {
      const std::vector<CurvePoint>& points = chart_.curves[c].points;
      const auto last = std::find_if(points.rbegin(), points.rend(),
                                     [&](const CurvePoint& point) { return is_shown(point); });
      if (last == points.rend()) continue;
      named.push_back(c);
      ends.push_back(y(last->y));
    }
    const std::vector<double> heights = spread_labels(ends, kTop, bottom_);
    std::string svg;
    for (std::size_t i = 0; i < named.size(); ++i) {
      const Curve& curve = chart_.curves[named[i]];
      svg += group_svg(
          named[i], false, curve.name,
          line_of(curve) + line_svg(kRight + 4, ends[i], kRight + 18, heights[i], "leader") +
              text_svg(kRight + 22, heights[i] + 4, "start", "small", abbreviated(curve.name, kNameLength)));
    }
    return svg;
  }

  const CurveChart& chart_;
  double bottom_;
  double x0_ = 0, x1_ = 1, y0_ = 0, y1_ = 1;
  std::vector<double> marks_;
};

}  // namespace

std::string curve_chart_svg(const CurveChart& chart) {
  const Plot plot(chart);
  return fmt::format(
      "<svg viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\" role=\"img\" aria-label=\"{}\" "
      "class=\"chart\">\n{}\n<rect width=\"100%\" height=\"100%\" class=\"ground\"/>\n{}</svg>\n",
      kWidth, plot.height(), kWidth, plot.height(), escape_html(chart.title), kChartStyle, plot.svg());
}

}  // namespace pellucid
