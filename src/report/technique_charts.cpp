// Implements technique_charts.h: techniques as points and bars, and places for the names of points.
#include "report/technique_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellucid/report.h"
#include "report/charts.h"

namespace pellucid {
namespace {

// ---------------------------------------------------------------------------------------- places for names

constexpr double kCharacterWidth = 7;  // at 12 pixels; most characters are narrower
constexpr double kTextHeight = 14;
constexpr double kPointRadius = 5;  // including the free space around it
constexpr double kNear = 8;
constexpr double kRing = 14;  // distance from one ring of places to the next
constexpr int kRings = 12;
constexpr int kDirections = 16;

// Returns the box of a name whose nearest edge is `distance` from its point, in a direction given by the
// angle from the right.
LabelBox box_towards(const LabelPoint& point, double angle, double distance) {
  const double width = kCharacterWidth * static_cast<double>(point.name.size());
  const double x = std::cos(angle);
  const double y = std::sin(angle);
  const double middle_x = point.x + x * (distance + width / 2);
  const double middle_y = point.y + y * (distance + kTextHeight / 2);
  return {middle_x - width / 2, middle_y - kTextHeight / 2, middle_x + width / 2, middle_y + kTextHeight / 2};
}

std::vector<PlacedLabel> places_of(const LabelPoint& point) {
  std::vector<PlacedLabel> places;
  // First right, left, above and below.
  for (const double angle : {0.0, std::numbers::pi, -std::numbers::pi / 2, std::numbers::pi / 2})
    places.push_back({box_towards(point, angle, kNear), false});
  for (int ring = 1; ring <= kRings; ++ring) {
    for (int d = 0; d < kDirections; ++d) {
      const double angle = 2 * std::numbers::pi * d / kDirections;
      places.push_back({box_towards(point, angle, kNear + kRing * ring), true});
    }
  }
  return places;
}

// -------------------------------------------------------------------------------------------------- charts

// Colours of charts.h.
constexpr std::size_t kExactColor = 0;
constexpr std::size_t kOtherColor = 1;
constexpr double kTechniqueWidth = 960;
constexpr std::size_t kShortName = 16;

std::size_t color_of(bool exact) {
  return exact ? kExactColor : kOtherColor;
}

std::string svg_of(double height, const std::string& title, const std::string& content) {
  return fmt::format(
      "<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\" class=\"chart\">\n{}\n<rect "
      "width=\"100%\" height=\"100%\" class=\"ground\"/>\n{}</svg>\n",
      kTechniqueWidth, height, escape_html(title), kChartStyle, content);
}

// Returns the title and, at the other end of its line, the legend of the colours.
std::string head_svg(const std::string& title) {
  constexpr double kLine = 24;
  const auto key = [](bool exact, double x, const std::string& words) {
    return group_svg(color_of(exact), false, words,
                     fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"4.5\"/>", x, kLine - 4) +
                         text_svg(x + 9, kLine, "start", "small", words));
  };
  return text_svg(20, kLine, "start", "", title) + key(true, 660, "promises every fragment") +
         key(false, 830, "approximates");
}

// ------------------------------------------------------------------------------------ points: error and cost

constexpr double kCostLeft = 70;
constexpr double kCostRight = 920;
constexpr double kLineAt = 136;    // y of the line of the exact image; names are above it
constexpr double kErrorTop = 166;  // the highest PSNR below the line
constexpr double kErrorHeight = 230;
constexpr double kMarkStep = 10;    // dB, between marks
constexpr double kNameAngle = -52;  // degrees, of names above the line
constexpr double kNameRise = 16;
constexpr double kPointSize = 4.5;

class CostPlot {
 public:
  explicit CostPlot(const CostChart& chart) : chart_(chart) {
    choose_x();
    choose_y();
  }

  [[nodiscard]] double height() const { return bottom_ + 52; }
  [[nodiscard]] std::string svg() const {
    return head_svg(chart_.title) + grid() + pareto_steps() + equal_points() + other_points();
  }

 private:
  void choose_x() {
    double least = INFINITY;
    double most = 0;
    for (const TechniquePoint& point : chart_.points) {
      least = std::min(least, point.cost);
      most = std::max(most, point.cost);
    }
    marks_ = most > 0 ? log_marks(least, most) : std::vector<double>{1, 10};
    if (marks_.size() == 1) marks_.push_back(2 * marks_.front());
  }

  void choose_y() {
    double least = INFINITY;
    double most = -INFINITY;
    for (const TechniquePoint& point : chart_.points) {
      if (point.equal) continue;
      least = std::min(least, point.psnr);
      most = std::max(most, point.psnr);
    }
    if (!std::isfinite(least)) return;  // all points are on the line
    y0_ = kMarkStep * std::floor(least / kMarkStep);
    y1_ = std::max(kMarkStep * std::ceil(most / kMarkStep), y0_ + kMarkStep);
    bottom_ = kErrorTop + kErrorHeight;
  }

  [[nodiscard]] double x(double cost) const {
    return kCostLeft + (kCostRight - kCostLeft) * std::log(cost / marks_.front()) /
                           std::log(marks_.back() / marks_.front());
  }
  [[nodiscard]] double y(const TechniquePoint& point) const {
    return point.equal ? kLineAt : y_of(point.psnr);
  }
  [[nodiscard]] double y_of(double psnr) const {
    return bottom_ - (bottom_ - kErrorTop) * (psnr - y0_) / (y1_ - y0_);
  }

  [[nodiscard]] std::string grid() const {
    std::string svg = line_svg(kCostLeft, kLineAt, kCostRight, kLineAt, "axis") +
                      text_svg(kCostLeft - 8, kLineAt + 4, "end", "small", "equal");
    if (bottom_ > kErrorTop) {
      for (double mark = y0_; mark <= y1_; mark += kMarkStep) {
        svg += line_svg(kCostLeft, y_of(mark), kCostRight, y_of(mark), mark == y0_ ? "axis" : "grid");
        svg += text_svg(kCostLeft - 8, y_of(mark) + 4, "end", "small soft", fmt::format("{:.0f} dB", mark));
      }
    }
    for (const double mark : marks_) {
      svg += line_svg(x(mark), bottom_, x(mark), bottom_ + 5, "axis");
      svg += text_svg(x(mark), bottom_ + 20, "middle", "small soft", chart_.x_text(mark));
    }
    return svg + text_svg((kCostLeft + kCostRight) / 2, bottom_ + 42, "middle", "small soft", chart_.x_title);
  }

  // Returns the steps that join the techniques of the Pareto front.
  [[nodiscard]] std::string pareto_steps() const {
    std::vector<const TechniquePoint*> cheapest_first;
    for (const TechniquePoint& point : chart_.points) cheapest_first.push_back(&point);
    std::stable_sort(cheapest_first.begin(), cheapest_first.end(),
                     [](const TechniquePoint* a, const TechniquePoint* b) { return a->cost < b->cost; });
    std::string svg;
    const TechniquePoint* best = nullptr;
    for (const TechniquePoint* point : cheapest_first) {
      if (best != nullptr && y(*point) >= y(*best)) continue;
      if (best != nullptr) {
        svg += line_svg(x(best->cost), y(*best), x(point->cost), y(*best), "clip");
        svg += line_svg(x(point->cost), y(*best), x(point->cost), y(*point), "clip");
      }
      best = point;
    }
    return svg;
  }

  [[nodiscard]] std::string dot(const TechniquePoint& point) const {
    return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"/>\n", x(point.cost), y(point),
                       kPointSize);
  }

  // Returns the points on the line. Their names are tilted, so that many fit.
  [[nodiscard]] std::string equal_points() const {
    std::vector<const TechniquePoint*> points;
    std::vector<double> places;
    for (const TechniquePoint& point : chart_.points) {
      if (!point.equal) continue;
      points.push_back(&point);
      places.push_back(x(point.cost));
    }
    // The last name also needs space on its right.
    constexpr double kLean = 50;
    const std::vector<double> names = spread_labels(places, kCostLeft, kCostRight - kLean);
    std::string svg;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const TechniquePoint& point = *points[i];
      const double base = kLineAt - kNameRise;
      const std::string name = fmt::format(
          "<text class=\"small\" transform=\"translate({:.1f} {:.1f}) rotate({:.0f})\">{}</text>\n",
          names[i] + 4, base - 3, kNameAngle, escape_html(abbreviated(point.name, kShortName)));
      svg +=
          group_svg(color_of(point.exact), false, point.tooltip,
                    dot(point) + line_svg(places[i], kLineAt - kPointSize, names[i], base, "leader") + name);
    }
    return svg;
  }

  [[nodiscard]] std::string other_points() const {
    std::vector<const TechniquePoint*> points;
    std::vector<LabelPoint> labelled;
    for (const TechniquePoint& point : chart_.points) {
      if (point.equal) continue;
      points.push_back(&point);
      labelled.push_back({x(point.cost), y(point), abbreviated(point.name, kShortName)});
    }
    const std::vector<PlacedLabel> places =
        place_labels(labelled, {kCostLeft + 2, kLineAt + 8, kCostRight, bottom_ - 2});
    std::string svg;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const LabelBox& box = places[i].box;
      const double middle = (box.left + box.right) / 2;
      std::string content = dot(*points[i]);
      if (places[i].far) {
        const double end_x = std::clamp(labelled[i].x, box.left, box.right);
        const double end_y = std::clamp(labelled[i].y, box.top, box.bottom);
        content += line_svg(labelled[i].x, labelled[i].y, end_x, end_y, "leader");
      }
      content += text_svg(middle, box.bottom - 3, "middle", "small", labelled[i].name);
      svg += group_svg(color_of(points[i]->exact), false, points[i]->tooltip, content);
    }
    return svg;
  }

  const CostChart& chart_;
  std::vector<double> marks_;
  double y0_ = 0, y1_ = 0;
  double bottom_ = kLineAt + 14;
};

// ---------------------------------------------------------------------------------------------------- bars

constexpr double kBarsTop = 58;
constexpr double kRowHeight = 19;
constexpr double kBarThickness = 11;
constexpr double kNamesWidth = 124;
constexpr double kLabelWidth = 108;  // beside the longest bar
constexpr double kCutAt = 6;         // longest bar, as a multiple of the median
constexpr double kLeastBar = 1.5;    // pixels, so that the colour of a short bar shows

// Returns the value of the longest bar: the largest value, or less if that would make all other bars too
// short. Longer bars are cut.
double bar_end(const std::vector<double>& values) {
  std::vector<double> sorted;
  for (const double value : values)
    if (std::isfinite(value) && value > 0) sorted.push_back(value);
  if (sorted.empty()) return 1;
  std::sort(sorted.begin(), sorted.end());
  return std::min(sorted.back(), kCutAt * sorted[sorted.size() / 2]);
}

std::string column_svg(const BarChart& chart, const BarColumn& column, double left, double width) {
  const double end = bar_end(column.values);
  const double longest = width - kLabelWidth;
  std::string svg = text_svg(left, kBarsTop - 10, "start", "small soft", column.title);
  for (std::size_t i = 0; i < chart.names.size(); ++i) {
    const double value = column.values[i];
    const double top = kBarsTop + kRowHeight * static_cast<double>(i);
    double length = 0;
    std::string content;
    if (std::isfinite(value)) {
      length = std::max(kLeastBar, longest * std::min(1.0, value / end));
      content += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{}\" rx=\"1\"/>",
                             left, top + (kRowHeight - kBarThickness) / 2, length, kBarThickness);
    }
    svg += group_svg(color_of(chart.exact[i]), false, chart.names[i] + ": " + column.labels[i], content);
    if (std::isfinite(value) && value > end * (1 + 1e-9)) {
      // A gap shows that the bar is cut.
      svg += fmt::format("<path d=\"M{:.1f},{:.1f}l6,-15h5l-6,15z\" class=\"ground\"/>", left + longest - 24,
                         top + kRowHeight - 2);
    }
    svg += text_svg(left + length + 6, top + kRowHeight - 5, "start", "small soft", column.labels[i]);
  }
  return svg;
}

}  // namespace

std::vector<PlacedLabel> place_labels(const std::vector<LabelPoint>& points, const LabelBox& area) {
  std::vector<LabelBox> taken;
  taken.reserve(2 * points.size());
  for (const LabelPoint& p : points)
    taken.push_back({p.x - kPointRadius, p.y - kPointRadius, p.x + kPointRadius, p.y + kPointRadius});
  const auto is_free = [&](const PlacedLabel& place) {
    return area.holds(place.box) && std::none_of(taken.begin(), taken.end(), [&](const LabelBox& other) {
             return place.box.meets(other);
           });
  };
  std::vector<PlacedLabel> labels;
  for (const LabelPoint& point : points) {
    const std::vector<PlacedLabel> places = places_of(point);
    const auto found = std::find_if(places.begin(), places.end(), is_free);
    labels.push_back(found == places.end() ? places.front() : *found);
    taken.push_back(labels.back().box);
  }
  return labels;
}

std::string cost_chart_svg(const CostChart& chart) {
  const CostPlot plot(chart);
  return svg_of(plot.height(), chart.title, plot.svg());
}

std::string bar_chart_svg(const BarChart& chart) {
  std::string content = head_svg(chart.title);
  for (std::size_t i = 0; i < chart.names.size(); ++i) {
    const double line = kBarsTop + kRowHeight * static_cast<double>(i + 1) - 5;
    content += text_svg(kNamesWidth - 8, line, "end", "small", abbreviated(chart.names[i], kShortName));
  }
  const double width =
      (kTechniqueWidth - kNamesWidth) / static_cast<double>(std::max<std::size_t>(1, chart.columns.size()));
  for (std::size_t c = 0; c < chart.columns.size(); ++c)
    content += column_svg(chart, chart.columns[c], kNamesWidth + width * static_cast<double>(c), width);
  return svg_of(kBarsTop + kRowHeight * static_cast<double>(chart.names.size()) + 12, chart.title, content);
}

}  // namespace pellucid
