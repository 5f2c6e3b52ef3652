// Implements measure_charts.h: spheres of view directions, plots and histograms as inline SVG.
#include "report/measure_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "pellucid/report.h"

namespace pellucid {
namespace {

constexpr double kRadius = 100;
constexpr double kGap = 24;
constexpr std::uint32_t kRoundLevel = 3;  // 1,280 faces, so that the rim looks round
constexpr std::uint32_t kHistogramBins = 24;
constexpr std::size_t kMostBars = 110;
constexpr double kPlotWidth = 520;
constexpr double kPlotHeight = 240;
constexpr double kPlotLeft = 56;
constexpr double kPlotBottom = 34;
constexpr double kPlotTop = 12;
constexpr int kSteps = 5;  // steps of an axis, which ends at 1, 2 or 5 times a power of ten

using Polygon = std::vector<Vec3d>;

// One hemisphere, seen from +Z (front) or -Z (back), with Y up.
struct Hemisphere {
  double sign;
  double center_x;

  [[nodiscard]] bool sees(const Vec3d& v) const { return sign * v.z > -1e-9; }
  [[nodiscard]] std::string point(const Vec3d& v) const {
    return fmt::format("{:.1f},{:.1f}", center_x + sign * kRadius * v.x, kRadius - kRadius * v.y + 2);
  }
};
constexpr Hemisphere kFront{1, kRadius + 2};
constexpr Hemisphere kBack{-1, 3 * kRadius + kGap + 2};

// Returns the part of a polygon on the visible side. Cells that cross the rim are cut there.
Polygon clipped(const Polygon& polygon, const Hemisphere& side) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d& a = polygon[i];
    const Vec3d& b = polygon[(i + 1) % polygon.size()];
    const double da = side.sign * a.z;
    const double db = side.sign * b.z;
    if (da >= 0) kept.push_back(a);
    if ((da < 0) != (db < 0)) kept.push_back(normalized(a + (b - a) * (da / (da - db))));
  }
  return kept;
}

std::string polygon_svg(const Polygon& polygon, const std::string& color) {
  std::string text;
  for (const Hemisphere& side : {kFront, kBack}) {
    const Polygon visible = clipped(polygon, side);
    if (visible.size() < 3) continue;
    std::string points;
    for (const Vec3d& v : visible) points += side.point(v) + ' ';
    // The stroke of the same colour closes hairlines between cells.
    text += fmt::format("<polygon points=\"{}\" fill=\"{}\" stroke=\"{}\"/>", points, color, color);
  }
  return text;
}

std::string sphere_svg(const std::string& label, const std::string& content) {
  const double width = 4 * kRadius + kGap + 4;
  std::string text = fmt::format(
      "<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\" class=\"sphere\"><g "
      "stroke-width=\"0.6\" "
      "stroke-linejoin=\"round\">{}</g>",
      width, 2 * kRadius + 26, label, content);
  for (const Hemisphere& side : {kFront, kBack}) {
    text += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" class=\"rim\"/><text x=\"{:.1f}\" y=\"{:.1f}\" "
        "text-anchor=\"middle\">camera at {}Z</text>",
        side.center_x, kRadius + 2, kRadius, side.center_x, 2 * kRadius + 20, side.sign > 0 ? "+" : "\u2212");
  }
  return text + "</svg>";
}

// Returns a colour that differs from those of the neighbouring numbers, on light and on dark backgrounds.
std::string order_color(std::size_t order, std::size_t count) {
  const double hue =
      360.0 * static_cast<double>(order) / static_cast<double>(std::max<std::size_t>(1, count)) + 220;
  return fmt::format("oklch({} 0.115 {:.0f})", order % 2 == 0 ? "0.70" : "0.80", std::fmod(hue, 360.0));
}

// A piece of a view cell. Pieces are so small that the rim of the sphere looks round.
struct CellPiece {
  std::uint32_t cell;
  Polygon polygon;
};

// Returns cells S[n] as faces of a finer icosphere: the parent of face f is f / 4.
std::vector<CellPiece> triangle_cells(std::uint32_t level) {
  const std::uint32_t fine = std::max(level, kRoundLevel);
  const Icosphere sphere = make_icosphere(fine);
  std::vector<CellPiece> pieces;
  for (std::size_t f = 0; f < sphere.triangles.size(); ++f) {
    const auto& t = sphere.triangles[f];
    pieces.push_back({static_cast<std::uint32_t>(f >> 2U * (fine - level)),
                      {sphere.vertices[t[0]], sphere.vertices[t[1]], sphere.vertices[t[2]]}});
  }
  return pieces;
}

// Returns cells P[n], each a polygon through the centres of the faces around a vertex.
std::vector<CellPiece> vertex_cells(std::uint32_t level) {
  const Icosphere sphere = make_icosphere(level);
  std::vector<CellPiece> cells(sphere.vertices.size());
  for (const auto& t : sphere.triangles) {
    const Vec3d middle = normalized(sphere.vertices[t[0]] + sphere.vertices[t[1]] + sphere.vertices[t[2]]);
    for (const std::uint32_t v : t) cells[v].polygon.push_back(middle);
  }
  for (std::uint32_t v = 0; v < cells.size(); ++v) {
    const Vec3d axis = sphere.vertices[v];
    const Vec3d x = normalized(cross(axis, std::abs(axis.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
    const Vec3d y = cross(axis, x);
    cells[v].cell = v;
    std::sort(cells[v].polygon.begin(), cells[v].polygon.end(), [&](const Vec3d& a, const Vec3d& b) {
      return std::atan2(dot(a, y), dot(a, x)) < std::atan2(dot(b, y), dot(b, x));
    });
  }
  return cells;
}

std::vector<CellPiece> cell_pieces(const PartitionSpec& spec) {
  return has_triangle_cells(spec) ? triangle_cells(spec.level) : vertex_cells(spec.level);
}

// Returns a colour from pale through amber to dark red, for a share from 0 to 1.
std::string error_color(double share) {
  struct Stop {
    double at, r, g, b;
  };
  static constexpr std::array<Stop, 5> kStops{{{0, 226, 234, 240},
                                               {0.25, 250, 219, 150},
                                               {0.5, 242, 154, 84},
                                               {0.75, 208, 68, 56},
                                               {1, 110, 14, 40}}};
  const double t = std::clamp(share, 0.0, 1.0);
  std::size_t i = 1;
  while (i + 1 < kStops.size() && t > kStops[i].at) ++i;
  const Stop& a = kStops[i - 1];
  const Stop& b = kStops[i];
  const double f = (t - a.at) / (b.at - a.at);
  const auto mix = [f](double p, double q) { return static_cast<int>(std::lround(p + f * (q - p))); };
  return fmt::format("#{:02x}{:02x}{:02x}", mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b));
}

std::string error_legend(double most) {
  std::string text =
      "<div class=\"legend\"><span>0</span><svg viewBox=\"0 0 100 8\" preserveAspectRatio=\"none\" "
      "aria-hidden=\"true\">";
  for (int i = 0; i < 50; ++i) {
    text += fmt::format("<rect x=\"{}\" width=\"2.2\" height=\"8\" fill=\"{}\"/>", 2 * i,
                        error_color((i + 0.5) / 50));
  }
  return text + "</svg><span>" + format_percent(most) + "</span></div>";
}

double worst_ipr(std::span<const FrameError> frames) {
  double worst = 0;
  for (const FrameError& frame : frames) worst = std::max(worst, frame.ipr());
  return worst;
}

// Returns the end of an axis: the value rounded up to 1, 2 or 5 times a power of ten.
double axis_end(double value) {
  if (!(value > 0)) return 0.001;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (value <= step * power * (1 + 1e-9)) return step * power;
  }
  return 10 * power;
}

struct Axes {
  double x0, x1, y1;
  int x_steps = kSteps;
  [[nodiscard]] double x(double v) const {
    return kPlotLeft + (v - x0) / (x1 - x0) * (kPlotWidth - kPlotLeft - 10);
  }
  [[nodiscard]] double y(double v) const {
    return kPlotHeight - kPlotBottom - v / y1 * (kPlotHeight - kPlotBottom - kPlotTop);
  }
};

std::string percent_tick(double ratio) {
  return fmt::format("{:.4g} %", 100 * ratio);
}

std::string axes_svg(const Axes& axes, const std::function<std::string(double)>& x_text,
                     const std::function<std::string(double)>& y_text, const std::string& x_title) {
  std::string text;
  for (int i = 0; i <= kSteps; ++i) {
    const double y = axes.y1 * i / kSteps;
    text += fmt::format(
        "<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" class=\"grid\"/><text x=\"{:.1f}\" "
        "y=\"{:.1f}\" text-anchor=\"end\">{}</text>",
        kPlotLeft, kPlotWidth - 10, axes.y(y), axes.y(y), kPlotLeft - 6, axes.y(y) + 4, y_text(y));
  }
  for (int i = 0; i <= axes.x_steps; ++i) {
    const double x = axes.x0 + (axes.x1 - axes.x0) * i / axes.x_steps;
    text += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>", axes.x(x),
                        kPlotHeight - kPlotBottom + 16, i == axes.x_steps ? "end" : "middle", x_text(x));
  }
  return text + fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" class=\"axis\">{}</text>",
                            (kPlotLeft + kPlotWidth - 10) / 2, kPlotHeight - 2, x_title);
}

// Returns a bar from x0 to x1, with a gap to the next bar.
std::string bar_svg(const Axes& axes, double x0, double x1, double y) {
  const double gap = std::min(1.0, 0.1 * (axes.x(x1) - axes.x(x0)));
  return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" class=\"bar\"/>",
                     axes.x(x0) + gap, axes.y(y), axes.x(x1) - axes.x(x0) - 2 * gap, axes.y(0) - axes.y(y));
}

std::string plot_svg(const std::string& label, const std::string& content) {
  return fmt::format(
      "<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\" class=\"plot\">{}</svg>", kPlotWidth,
      kPlotHeight + 4, label, content);
}

}  // namespace

std::string order_sphere_svg(const OrderSet& orders) {
  std::vector<std::size_t> uses(orders.orders.size(), 0);
  for (const std::uint32_t order : orders.cell_orders) ++uses[order];
  std::string content;
  for (const CellPiece& piece : cell_pieces(orders.partition)) {
    content += polygon_svg(piece.polygon, order_color(orders.cell_orders[piece.cell], orders.orders.size()));
  }
  std::string legend = "<ul class=\"keys\">";
  for (std::size_t k = 0; k < uses.size(); ++k) {
    legend += fmt::format("<li><i style=\"background:{}\"></i>order {}: {} cells, {} triangles</li>",
                          order_color(k, uses.size()), k, uses[k], format_count(orders.orders[k].size()));
  }
  return sphere_svg("View cells coloured by order", content) + legend + "</ul>";
}

std::string error_sphere_svg(std::span<const Viewpoint> viewpoints, std::span<const FrameError> frames) {
  const std::size_t count = std::min(viewpoints.size(), frames.size());
  const double most = axis_end(worst_ipr(frames));
  // The errors are smoothed by a Gaussian as wide as the mean spacing of the viewpoints.
  const double width =
      std::max(0.1, std::sqrt(4 * std::numbers::pi / static_cast<double>(std::max<std::size_t>(1, count))));
  const Icosphere sphere = make_icosphere(kRoundLevel);
  std::string content;
  for (const auto& t : sphere.triangles) {
    const Polygon face{sphere.vertices[t[0]], sphere.vertices[t[1]], sphere.vertices[t[2]]};
    const Vec3d middle = normalized(face[0] + face[1] + face[2]);
    double sum = 0;
    double weights = 1e-300;
    for (std::size_t i = 0; i < count; ++i) {
      const double weight = std::exp((dot(middle, viewpoints[i].direction) - 1) / (width * width));
      weights += weight;
      sum += weight * frames[i].ipr();
    }
    content += polygon_svg(face, error_color(sum / weights / most));
  }
  for (std::size_t i = 0; i < count; ++i) {
    for (const Hemisphere& side : {kFront, kBack}) {
      if (!side.sees(viewpoints[i].direction)) continue;
      const std::string at = side.point(viewpoints[i].direction);
      const std::size_t comma = at.find(',');
      content += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"1.1\" class=\"view\"/>", at.substr(0, comma),
                             at.substr(comma + 1));
    }
  }
  return sphere_svg("Wrong pixels by view direction", content) + error_legend(most);
}

std::string distance_plot_svg(std::span<const Viewpoint> viewpoints, std::span<const FrameError> frames,
                              std::span<const DistanceError> bins, double nearest, double farthest) {
  const std::size_t count = std::min(viewpoints.size(), frames.size());
  if (!(farthest > nearest)) {
    nearest -= 0.5;
    farthest += 0.5;
  }
  const double range = farthest - nearest;
  const bool halves = range <= 5 && std::abs(2 * range - std::round(2 * range)) < 1e-9;
  const Axes axes{nearest, farthest, axis_end(worst_ipr(frames)),
                  halves ? static_cast<int>(std::lround(2 * range)) : kSteps};
  std::string content = axes_svg(
      axes, [](double v) { return fmt::format("{:.1f}", v); }, percent_tick,
      "camera distance, bounding radii");
  for (std::size_t i = 0; i < count; ++i) {
    content += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\" class=\"dot\"/>",
                           axes.x(viewpoints[i].distance), axes.y(frames[i].ipr()));
  }
  std::string path;
  double from = nearest;
  for (const DistanceError& bin : bins) {
    const double to = std::clamp(bin.distance, nearest, farthest);
    path += fmt::format("{}{:.1f},{:.1f} L{:.1f},{:.1f} ", path.empty() ? "M" : "L", axes.x(from),
                        axes.y(bin.ipr), axes.x(to), axes.y(bin.ipr));
    from = to;
  }
  if (!path.empty()) content += "<path d=\"" + path + "\" class=\"line\"/>";
  return plot_svg("Wrong pixels by distance", content);
}

std::string histogram_svg(std::span<const FrameError> frames) {
  const double end = axis_end(worst_ipr(frames));
  std::array<std::uint32_t, kHistogramBins> counts{};
  for (const FrameError& frame : frames) {
    const auto bin = static_cast<std::size_t>(frame.ipr() / end * kHistogramBins);
    ++counts[std::min<std::size_t>(bin, kHistogramBins - 1)];
  }
  const double most = std::max(4.0, axis_end(*std::max_element(counts.begin(), counts.end())));
  const Axes axes{0, end, most};
  std::string content = axes_svg(
      axes, percent_tick, [](double v) { return fmt::format("{:.0f}", v); }, "wrong pixels of a viewpoint");
  for (std::size_t i = 0; i < counts.size(); ++i) {
    content += bar_svg(axes, end * static_cast<double>(i) / kHistogramBins,
                       end * static_cast<double>(i + 1) / kHistogramBins, counts[i]);
  }
  return plot_svg("Viewpoints by wrong pixels", content);
}

std::string depth_histogram_svg(std::span<const std::uint64_t> pixels_by_depth) {
  const std::size_t deepest = pixels_by_depth.empty() ? 0 : pixels_by_depth.size() - 1;
  // A bar stands for several depths where single ones would be too thin.
  const std::size_t width = deepest / kMostBars + 1;
  std::vector<std::uint64_t> counts;
  for (std::size_t n = 1; n <= deepest; n += width) {
    counts.push_back(0);
    for (std::size_t i = n; i < std::min(n + width, deepest + 1); ++i) counts.back() += pixels_by_depth[i];
  }
  const std::uint64_t most = counts.empty() ? 0 : *std::max_element(counts.begin(), counts.end());
  const double end = kSteps * std::ceil(static_cast<double>(deepest + width) / kSteps);
  const Axes axes{0, end, std::max(5.0, axis_end(static_cast<double>(most)))};
  std::string content = axes_svg(
      axes, [](double v) { return fmt::format("{:.0f}", v); },
      [](double v) { return format_count(static_cast<std::uint64_t>(std::llround(v))); },
      "fragments of a pixel");
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double first = static_cast<double>(1 + i * width) - 0.5;
    content += bar_svg(axes, first, first + static_cast<double>(width), static_cast<double>(counts[i]));
  }
  return plot_svg("Pixels by number of fragments", content);
}

}  // namespace pellucid
