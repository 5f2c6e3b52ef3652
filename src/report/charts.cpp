// Implements charts.h: charts with named curves, and the parts that charts share.
#include "report/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pellucid/report.h"

namespace pellucid {
namespace {

constexpr std::size_t kColors = 7;
constexpr double kLabelGap = 17;
constexpr double kMostDecades = 2.4;  // up to this range there are marks between powers of ten

// Returns the class of the dashes of a curve. Curves with the same colour have different dashes.
const char* dashes(std::size_t index) {
  if (index < kColors) return "";
  return index < 2 * kColors ? " again" : " third";
}

// -------------------------------------------------------------------------------------------------- curves

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
      for (const ChartPoint& point : curve.points) {
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

  [[nodiscard]] bool is_shown(const ChartPoint& point) const {
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
    for (const ChartPoint& point : curve.points) {
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
      const std::vector<ChartPoint>& points = chart_.curves[c].points;
      const auto last = std::find_if(points.rbegin(), points.rend(),
                                     [&](const ChartPoint& point) { return is_shown(point); });
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

// -------------------------------------------------------------------------------------------- shared parts

// All selectors begin with .chart, because within a page this style applies to the whole page. The colours
// follow Okabe and Ito, with enough contrast for lines and text on light and dark backgrounds.
const char* const kChartStyle = R"(<style>
.chart text{font:13px system-ui,-apple-system,"Segoe UI","DejaVu Sans",sans-serif;fill:#24292f}
.chart .small{font-size:12px}
.chart .soft{fill:#5b6675}
.chart .ground{fill:#ffffff}
.chart .grid{stroke:#dfe4ea}
.chart .axis{stroke:#8b95a1}
.chart .clip{stroke:#b9c1ca;stroke-dasharray:2 3}
.chart .curve polyline{fill:none;stroke:var(--c);stroke-width:1.8;stroke-linejoin:round;stroke-linecap:round}
.chart .strong polyline{stroke-width:3}
.chart .again polyline{stroke-dasharray:7 4}
.chart .third polyline{stroke-dasharray:2 4}
.chart .curve circle{fill:var(--c)}
.chart .curve text{fill:var(--c)}
.chart .strong text{font-weight:600}
.chart .curve line{stroke:var(--c);stroke-opacity:.6}
.chart .curve rect{fill:var(--c)}
.chart .c0{--c:#0b62c4}.chart .c1{--c:#b35900}.chart .c2{--c:#00795a}
.chart .c3{--c:#b03a80}.chart .c4{--c:#8a6d00}.chart .c5{--c:#1f8cab}
.chart .c6{--c:#5f6873}
@media (prefers-color-scheme:dark){
.chart text{fill:#dde3ea}
.chart .soft{fill:#98a4b3}
.chart .ground{fill:#12161c}
.chart .grid{stroke:#2d3642}
.chart .axis{stroke:#6a7684}
.chart .clip{stroke:#4a5563}
.chart .c0{--c:#6cb2ff}.chart .c1{--c:#f2a45c}.chart .c2{--c:#4cc9a0}
.chart .c3{--c:#ee8fc4}.chart .c4{--c:#d9c04a}.chart .c5{--c:#7fd3ea}
.chart .c6{--c:#a5afba}
}
</style>)";

std::string abbreviated(const std::string& name, std::size_t length) {
  std::size_t characters = 0;
  std::size_t cut = name.size();
  for (std::size_t i = 0; i < name.size(); ++i) {
    if ((static_cast<unsigned char>(name[i]) & 0xC0U) == 0x80U) continue;
    if (++characters == length) cut = i;
  }
  return characters <= length ? name : name.substr(0, cut) + "\u2026";
}

std::string text_svg(double x, double y, const char* anchor, const char* style, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" class=\"{}\">{}</text>\n", x, y,
                     anchor, style, escape_html(text));
}

std::string line_svg(double x0, double y0, double x1, double y1, const char* style) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"{}\"/>\n", x0, y0,
                     x1, y1, style);
}

std::string group_svg(std::size_t index, bool strong, const std::string& name, const std::string& content) {
  return fmt::format("<g class=\"curve c{}{}{}\"><title>{}</title>\n{}</g>\n", index % kColors,
                     strong ? " strong" : "", dashes(index), escape_html(name), content);
}

std::vector<double> log_marks(double least, double most) {
  const bool is_wide = std::log10(most / least) > kMostDecades;
  const std::vector<double> factors = is_wide ? std::vector<double>{1} : std::vector<double>{1, 2, 5};
  std::vector<double> marks;
  for (double power = std::pow(10.0, std::floor(std::log10(least))); marks.empty() || marks.back() < most;
       power *= 10) {
    for (const double factor : factors) {
      if (!marks.empty() && marks.back() >= most) break;
      // The axis begins at the last mark below all values.
      if (factor * power <= least) marks.clear();
      marks.push_back(factor * power);
    }
  }
  return marks;
}

std::vector<double> spread_labels(const std::vector<double>& ends, double top, double bottom) {
  std::vector<std::size_t> upper_first(ends.size());
  std::iota(upper_first.begin(), upper_first.end(), std::size_t{0});
  std::stable_sort(upper_first.begin(), upper_first.end(),
                   [&](std::size_t a, std::size_t b) { return ends[a] < ends[b]; });
  const double gap =
      std::min(kLabelGap, (bottom - top) / std::max(1.0, static_cast<double>(ends.size()) - 1));
  // Names that are too near to each other form a group. The group is placed at the mean of the places that
  // its names would have. Groups that meet are merged.
  struct Group {
    double sum = 0;  // sum over the names of where each would put the first name
    std::size_t count = 0;
    [[nodiscard]] double first() const { return sum / static_cast<double>(count); }
  };
  std::vector<Group> groups;
  for (const std::size_t i : upper_first) {
    groups.push_back({ends[i], 1});
    while (groups.size() > 1) {
      const Group last = groups.back();
      Group& before = groups[groups.size() - 2];
      const double offset = gap * static_cast<double>(before.count);
      if (before.first() + offset <= last.first()) break;
      before = {before.sum + last.sum - offset * static_cast<double>(last.count), before.count + last.count};
      groups.pop_back();
    }
  }
  std::vector<double> sorted;
  for (const Group& group : groups)
    for (std::size_t n = 0; n < group.count; ++n)
      sorted.push_back(group.first() + gap * static_cast<double>(n));
  // Move all names between `top` and `bottom`.
  double least = top;
  for (double& height : sorted) {
    height = std::max(height, least);
    least = height + gap;
  }
  double most = bottom;
  for (std::size_t i = sorted.size(); i-- > 0;) {
    sorted[i] = std::min(sorted[i], most);
    most = sorted[i] - gap;
  }
  std::vector<double> heights(ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i) heights[upper_first[i]] = sorted[i];
  return heights;
}

// -------------------------------------------------------------------------------------------------- curves

std::string curve_chart_svg(const CurveChart& chart) {
  const Plot plot(chart);
  return fmt::format(
      "<svg viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\" role=\"img\" aria-label=\"{}\" "
      "class=\"chart\">\n{}\n<rect width=\"100%\" height=\"100%\" class=\"ground\"/>\n{}</svg>\n",
      kWidth, plot.height(), kWidth, plot.height(), escape_html(chart.title), kChartStyle, plot.svg());
}

}  // namespace pellucid
