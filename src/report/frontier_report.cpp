// Writes the Pareto front of error and number of buffers as a table, JSON and an SVG plot. In: a frontier
// report (pellucid/report.h). Out: text, JSON (docs/json.md) and SVG.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellucid/report.h"
#include "report/json.h"

namespace pellucid {
namespace {

// ------------------------------------------------------------------------------------------- JSON and text

Json json_of(const FrontierPoint& point) {
  return {{"limit", point.limit},
          {"request", point.request},
          {"buffers", point.buffers},
          {"ipr", point.ipr},
          {"psnr", point.psnr},
          {"repaired", point.repaired},
          {"frame_time", point.frame_time},
          {"violated_weight", point.violated_weight},
          {"memory_bytes", point.memory_bytes},
          {"meets_target", point.meets_target}};
}

Json json_of(const PrimitiveFrontier& primitive) {
  const OrderFrontier& frontier = primitive.frontier;
  Json points = Json::array();
  for (const FrontierPoint& point : frontier.points) points.push_back(json_of(point));
  return {
      {"primitive", primitive.primitive}, {"name", primitive.name},
      {"triangles", primitive.triangles}, {"vertices", primitive.vertices},
      {"chosen", frontier.chosen},        {"knee", frontier.knee > 0 ? Json(frontier.knee) : Json(nullptr)},
      {"points", std::move(points)}};
}

std::string remark_on(const FrontierPoint& point, const OrderFrontier& frontier) {
  std::string text;
  const auto add = [&](const std::string& word) { text += (text.empty() ? "" : ", ") + word; };
  if (point.limit == frontier.chosen)
    add(point.meets_target ? "meets the target" : "more hardly help; misses the target");
  if (point.limit == frontier.knee) add("knee");
  if (point.request != point.limit) add(fmt::format("{} came out no worse", point.request));
  return text;
}

// ---------------------------------------------------------------------------------------------------- plot

constexpr double kFrontierWidth = 680;
constexpr double kPanelHeight = 390;
constexpr double kFrontierLeft = 76;
constexpr double kFrontierRight = 604;
constexpr double kFrontierTop = 86;
constexpr double kFrontierBottom = 306;
constexpr double kLeastDecades = 2;
constexpr double kPsnrStep = 10;
// Errors that are too small for the logarithmic axis are drawn at its lower end.
constexpr double kLeastIpr = 1e-7;

// Blue and orange can be told apart with any kind of colour vision, and have contrast on light and on dark
// backgrounds.
constexpr const char* kFrontierStyle = R"(<style>
text{font:13px system-ui,-apple-system,"Segoe UI","DejaVu Sans",sans-serif;fill:#24292f}
.title{font-size:16px;font-weight:600}
.small{font-size:12px}
.ground{fill:#ffffff}
.mark{fill:#e8f0fa}
.grid{stroke:#d8dee4}
.line{fill:none;stroke-width:2.25;stroke-linejoin:round}
.target{stroke-width:1.5;stroke-dasharray:2 4}
.ipr{fill:#0b62c4}.ipr-line{stroke:#0b62c4}
.psnr{fill:#b35900}.psnr-line{stroke:#b35900}
@media (prefers-color-scheme:dark){
text{fill:#dde3ea}
.ground{fill:#12171d}
.mark{fill:#1d2b3d}
.grid{stroke:#39424d}
.ipr{fill:#6cb2ff}.ipr-line{stroke:#6cb2ff}
.psnr{fill:#f2a45c}.psnr-line{stroke:#f2a45c}
}
</style>)";

class Panel {
 public:
  Panel(const FrontierReport& report, const PrimitiveFrontier& primitive)
      : report_(report), primitive_(primitive), points_(primitive.frontier.points) {
    choose_ranges();
  }

  [[nodiscard]] std::string svg() const {
    return titles() + marks() + grid() + target() + curves() + labels();
  }

 private:
  void choose_ranges() {
    double least = report_.min_psnr ? 1.0 : std::max(report_.max_error, kLeastIpr);
    double most = kLeastIpr;
    double least_psnr = report_.min_psnr.value_or(kMostPsnr);
    double most_psnr = report_.min_psnr.value_or(0);
    for (const FrontierPoint& point : points_) {
      if (point.ipr > 0) least = std::min(least, point.ipr);
      most = std::max(most, point.ipr);
      least_psnr = std::min(least_psnr, point.psnr);
      most_psnr = std::max(most_psnr, point.psnr);
    }
    high_decade_ = std::ceil(std::log10(std::max(most, least)) - 1e-9);
    low_decade_ = std::min(std::floor(std::log10(least) + 1e-9), high_decade_ - kLeastDecades);
    low_psnr_ = kPsnrStep * std::floor(least_psnr / kPsnrStep);
    high_psnr_ = std::max(kPsnrStep * std::ceil(most_psnr / kPsnrStep), low_psnr_ + kPsnrStep);
  }

  [[nodiscard]] double x(std::uint32_t limit) const {
    const auto count = static_cast<double>(points_.size());
    return kFrontierLeft + (kFrontierRight - kFrontierLeft) * (limit - 0.5) / count;
  }
  [[nodiscard]] double y_ipr(double ipr) const {
    const double decades = std::log10(std::max(ipr, std::pow(10.0, low_decade_)));
    return kFrontierBottom -
           (kFrontierBottom - kFrontierTop) * (decades - low_decade_) / (high_decade_ - low_decade_);
  }
  [[nodiscard]] double y_psnr(double psnr) const {
    return kFrontierBottom - (kFrontierBottom - kFrontierTop) * (psnr - low_psnr_) / (high_psnr_ - low_psnr_);
  }

  static std::string text(double x, double y, const char* anchor, const std::string& style,
                          const std::string& content) {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" class=\"{}\">{}</text>\n", x, y,
                       anchor, style, content);
  }

  [[nodiscard]] std::string titles() const {
    return text(20, 26, "start", "title", escape_html(primitive_.name)) +
           text(20, 46, "start", "small",
                fmt::format("{} triangles, views {}: error against number of buffers",
                            format_count(primitive_.triangles), escape_html(report_.views)));
  }

  // Returns a rectangle behind the chosen number of buffers.
  [[nodiscard]] std::string marks() const {
    const double half = 0.5 * (kFrontierRight - kFrontierLeft) / static_cast<double>(points_.size());
    return fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
        "class=\"mark\"/>\n",
        x(primitive_.frontier.chosen) - half, kFrontierTop, 2 * half, kFrontierBottom - kFrontierTop);
  }

  [[nodiscard]] std::string grid() const {
    std::string svg;
    for (double decade = low_decade_; decade <= high_decade_ + 0.5; decade += 1) {
      const double ipr = std::pow(10.0, decade);
      const bool stands_for_none = decade == low_decade_ && has_zero();
      svg += fmt::format("<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" class=\"grid\"/>\n",
                         kFrontierLeft, kFrontierRight, y_ipr(ipr), y_ipr(ipr));
      svg += text(kFrontierLeft - 8, y_ipr(ipr) + 4, "end", "ipr",
                  stands_for_none ? "0" : fmt::format("{:.3g} %", 100 * ipr));
    }
    for (double psnr = low_psnr_; psnr <= high_psnr_ + 0.5; psnr += kPsnrStep)
      svg += text(kFrontierRight + 8, y_psnr(psnr) + 4, "start", "psnr", fmt::format("{:.0f} dB", psnr));
    svg += text(kFrontierLeft - 56, kFrontierTop - 10, "start", "ipr", "wrong pixels");
    return svg + text(kFrontierRight + 56, kFrontierTop - 10, "end", "psnr", "PSNR");
  }

  [[nodiscard]] bool has_zero() const {
    return std::any_of(points_.begin(), points_.end(),
                       [&](const FrontierPoint& p) { return p.ipr < std::pow(10.0, low_decade_); });
  }

  [[nodiscard]] std::string target() const {
    if (report_.least_frame_time) return "";
    const double y = report_.min_psnr ? y_psnr(*report_.min_psnr) : y_ipr(report_.max_error);
    const std::string color = report_.min_psnr ? "psnr" : "ipr";
    const std::string words = report_.min_psnr ? fmt::format("target {:g} dB", *report_.min_psnr)
                                               : "target " + format_percent(report_.max_error);
    const std::string line = fmt::format(
        "<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" class=\"target {}-line\"/>\n",
        kFrontierLeft, kFrontierRight, y, y, color);
    // The label is beside the axis of its measure.
    return line + (report_.min_psnr ? text(kFrontierRight - 6, y - 6, "end", "small " + color, words)
                                    : text(kFrontierLeft + 6, y - 6, "start", "small " + color, words));
  }

  [[nodiscard]] std::string curves() const {
    std::string ipr;
    std::string psnr;
    std::string dots;
    for (const FrontierPoint& point : points_) {
      const double at = x(point.limit);
      ipr += fmt::format("{:.1f},{:.1f} ", at, y_ipr(point.ipr));
      psnr += fmt::format("{:.1f},{:.1f} ", at, y_psnr(point.psnr));
      dots += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"7\" height=\"7\" class=\"psnr\"/>\n",
                          at - 3.5, y_psnr(point.psnr) - 3.5);
      dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.2\" class=\"ipr\"/>\n", at,
                          y_ipr(point.ipr));
    }
    return fmt::format(
               "<polyline points=\"{}\" class=\"line psnr-line\" "
               "stroke-dasharray=\"7 4\"/>\n<polyline points=\"{}\" class=\"line ipr-line\"/>\n",
               psnr, ipr) +
           dots;
  }

  [[nodiscard]] std::string labels() const {
    const OrderFrontier& frontier = primitive_.frontier;
    std::string svg;
    for (const FrontierPoint& point : points_) {
      svg += text(x(point.limit), kFrontierBottom + 18, "middle", "", std::to_string(point.limit));
      svg += text(x(point.limit), kFrontierBottom + 52, "middle", "small", format_bytes(point.memory_bytes));
    }
    const auto word = [&](std::uint32_t limit) -> std::string {
      if (limit == frontier.chosen) return limit == frontier.knee ? "chosen, knee" : "chosen";
      return limit == frontier.knee ? "knee" : "";
    };
    for (const FrontierPoint& point : points_)
      svg += text(x(point.limit), kFrontierBottom + 34, "middle", "small", word(point.limit));
    return svg + text((kFrontierLeft + kFrontierRight) / 2, kFrontierBottom + 72, "middle", "small",
                      "order buffers, and their index memory");
  }

  static constexpr double kMostPsnr = 100;

  const FrontierReport& report_;
  const PrimitiveFrontier& primitive_;
  const std::vector<FrontierPoint>& points_;
  double low_decade_ = -4, high_decade_ = 0, low_psnr_ = 0, high_psnr_ = 100;
};

}  // namespace

std::string to_json(const FrontierReport& report) {
  Json distances = Json::array();
  for (const double distance : report.distances) distances.push_back(json_distance(distance));
  Json primitives = Json::array();
  for (const PrimitiveFrontier& primitive : report.primitives) primitives.push_back(json_of(primitive));
  const Json json = {
      {"schema", kJsonSchema},
      {"version", library_version()},
      {"input", report.input},
      {"method", "budget"},
      {"views", report.views},
      {"distances", std::move(distances)},
      {"seed", report.seed},
      {"alpha", report.alpha > 0 ? Json(report.alpha) : Json(nullptr)},
      {"picture_alpha", report.image_alpha},
      {"max_error", report.min_psnr || report.least_frame_time ? Json(nullptr) : Json(report.max_error)},
      {"min_psnr", report.min_psnr ? Json(*report.min_psnr) : Json(nullptr)},
      {"primitives", std::move(primitives)}};
  return dump(json);
}

std::string to_text(const FrontierReport& report) {
  std::string text;
  for (const PrimitiveFrontier& primitive : report.primitives) {
    TextTable table({"buffers", "wrong pixels", "PSNR (dB)", "repaired pixels", "verified frame",
                     "violated weight", "memory", ""});
    for (const FrontierPoint& point : primitive.frontier.points) {
      table.add_row({std::to_string(point.limit), format_percent(point.ipr), format_fixed(point.psnr, 1),
                     format_percent(point.repaired), format_fixed(point.frame_time, 2),
                     format_percent(point.violated_weight), format_bytes(point.memory_bytes),
                     remark_on(point, primitive.frontier)});
    }
    text += fmt::format("{}: {} triangles, error against number of buffers\n{}", primitive.name,
                        format_count(primitive.triangles), table.to_string());
  }
  return text;
}

std::string frontier_svg(const FrontierReport& report) {
  const double height = kPanelHeight * static_cast<double>(report.primitives.size());
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" "
      "height=\"{:.0f}\" role=\"img\" aria-label=\"Error against number of buffers\">\n{}\n<rect "
      "width=\"100%\" height=\"100%\" class=\"ground\"/>\n",
      kFrontierWidth, height, kFrontierWidth, height, kFrontierStyle);
  for (std::size_t i = 0; i < report.primitives.size(); ++i) {
    svg += fmt::format("<g transform=\"translate(0 {:.0f})\">\n{}</g>\n",
                       kPanelHeight * static_cast<double>(i), Panel(report, report.primitives[i]).svg());
  }
  return svg + "</svg>\n";
}

}  // namespace pellucid
