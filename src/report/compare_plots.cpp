// Makes the plots of a comparison: time, memory and error of the techniques of a scene, and charts of sweeps.
// In: a compared scene or sweep (pellucid/compare_report.h). Out: HTML with inline SVG.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "report/charts.h"
#include "report/compare_parts.h"
#include "report/html_page.h"
#include "report/technique_charts.h"

namespace pellucid {
namespace {

// ----------------------------------------------------------------------------------- techniques of a scene

std::vector<const ComparedTechnique*> fastest_first(const ComparedScene& scene) {
  std::vector<const ComparedTechnique*> drawn;
  for (const ComparedTechnique& technique : scene.techniques)
    if (technique.drawn() && technique.error) drawn.push_back(&technique);
  std::stable_sort(drawn.begin(), drawn.end(), [](const ComparedTechnique* a, const ComparedTechnique* b) {
    return a->stats.milliseconds < b->stats.milliseconds;
  });
  return drawn;
}

double bytes_per_pixel(const ComparedTechnique& technique, const ComparedScene& scene) {
  return static_cast<double>(technique.stats.bytes) / (static_cast<double>(scene.width) * scene.height);
}

std::string error_text(const ComparedTechnique& technique) {
  return technique.equals_exact() ? "equal" : format_fixed(technique.error->psnr, 1) + " dB";
}

// Returns "0.5", "12.3" or "2,000".
std::string amount(double value) {
  return value < 1000 ? fmt::format("{:.3g}", value)
                      : format_count(static_cast<std::uint64_t>(std::llround(value)));
}

using Cost = std::function<double(const ComparedTechnique&)>;

// Returns the points of a chart. Techniques without cost have no place on a logarithmic axis; for example,
// blending takes no memory.
CostChart cost_chart(const std::vector<const ComparedTechnique*>& techniques, const Cost& cost) {
  CostChart chart;
  for (const ComparedTechnique* technique : techniques) {
    if (!(cost(*technique) > 0)) continue;
    chart.points.push_back({technique->name, "", technique->exact, technique->equals_exact(),
                            cost(*technique), technique->error->psnr});
  }
  return chart;
}

std::string scrolled(const std::string& svg) {
  return "<div class=\"scroll\">" + svg + "</div>\n";
}

std::string error_over(const std::vector<const ComparedTechnique*>& techniques, const std::string& title,
                       const std::string& x_title, const Cost& cost,
                       const std::function<std::string(double)>& text) {
  CostChart chart = cost_chart(techniques, cost);
  if (chart.points.empty()) return {};
  chart.title = title;
  chart.x_title = x_title;
  chart.x_text = text;
  for (TechniquePoint& point : chart.points) {
    point.tooltip = fmt::format("{}: {}, {}", point.name, text(point.cost),
                                point.equal ? "equal" : format_fixed(point.psnr, 1) + " dB");
  }
  return scrolled(cost_chart_svg(chart));
}

BarChart bars_of(const std::vector<const ComparedTechnique*>& techniques, const ComparedScene& scene) {
  BarChart chart{"Time, memory and error: less is better", {}, {}, {}};
  BarColumn time{"milliseconds, and ratio", {}, {}};
  BarColumn memory{"bytes a pixel", {}, {}};
  BarColumn error{"HyAB, and PSNR", {}, {}};
  for (const ComparedTechnique* technique : techniques) {
    chart.names.push_back(technique->name);
    chart.exact.push_back(technique->exact);
    const std::optional<double> ratio = scene.time_ratio(*technique);
    time.values.push_back(technique->stats.milliseconds);
    time.labels.push_back(format_fixed(technique->stats.milliseconds, 1) +
                          (ratio ? fmt::format(", {:.2f}", *ratio) : ""));
    memory.values.push_back(bytes_per_pixel(*technique, scene));
    memory.labels.push_back(format_fixed(memory.values.back(), 1));
    error.values.push_back(technique->equals_exact() ? NAN : technique->perceived.hyab);
    error.labels.push_back(technique->equals_exact()
                               ? "equal"
                               : format_fixed(technique->perceived.hyab, 2) + ", " + error_text(*technique));
  }
  chart.columns = {time, memory, error};
  return chart;
}

// -------------------------------------------------------------------------------------------------- sweeps

struct Measure {
  std::string title;
  double (*value)(const CaptureStats&);
  std::string (*text)(double);
  bool is_share = false;
};

const Measure kTime{"Milliseconds", [](const CaptureStats& stats) { return stats.milliseconds; },
                    [](double v) { return fmt::format("{:g} ms", v); }};
const Measure kMemory{"Memory", [](const CaptureStats& stats) { return static_cast<double>(stats.bytes); },
                      [](double v) { return format_bytes(static_cast<std::uint64_t>(v)); }};
const Measure kCaptured{"R_h, captured fragments of all",
                        [](const CaptureStats& stats) { return stats.captured_share(); },
                        [](double v) { return fmt::format("{:g}", v); }, true};

struct SweepWords {
  std::string title, words;
  std::vector<const Measure*> measures;
};

SweepWords words_of(SweepKind kind) {
  switch (kind) {
    case SweepKind::resolution:
      return {"Over the size of the image", "As figure 7 of the paper, and memory.", {&kTime, &kMemory}};
    case SweepKind::coplanarity:
      return {"Over coplanarity",
              "The scene is drawn several times in one place, so that every fragment meets as many others at "
              "its depth. As figure 8 of the paper, and what is captured.",
              {&kTime, &kCaptured}};
    case SweepKind::depth:
      return {"Over depth complexity",
              "The scene is drawn several times along the lines of sight: the image stays the same, and "
              "every pixel has "
              "as many times the fragments. As figure 9 of the paper, and memory.",
              {&kTime, &kMemory}};
    case SweepKind::memory:
      break;
  }
  return {
      "Over the size of the pool",
      "Techniques that store all fragments in a pool lose what finds no place in it; those with a memory "
      "budget "
      "get the bytes that sb takes for that pool; the others are not affected. As figure 11 of the paper.",
      {&kCaptured, &kMemory}};
}

double x_of(const ComparedSweep& sweep, const SweepPoint& point) {
  return sweep.kind == SweepKind::resolution ? static_cast<double>(point.width) * point.height : point.value;
}

std::string chart_of(const ComparedSweep& sweep, const Measure& measure) {
  CurveChart chart;
  chart.title = measure.title;
  chart.x_title = compare_sweeps()[static_cast<std::size_t>(sweep.kind)].parameter;
  chart.y_text = measure.text;
  chart.is_share = measure.is_share;
  for (const SweepPoint& point : sweep.points) chart.x_values.push_back(x_of(sweep, point));
  chart.x_text = [&](double x) {
    for (const SweepPoint& point : sweep.points) {
      if (sweep.kind == SweepKind::resolution && x_of(sweep, point) == x)
        return fmt::format("{}\u00d7{}", point.width, point.height);
    }
    return fmt::format("{:g}", x);
  };
  for (std::size_t t = 0; t < sweep.techniques.size(); ++t) {
    Curve curve{sweep.techniques[t], {}};
    for (const SweepPoint& point : sweep.points)
      curve.points.push_back({x_of(sweep, point), point.runs[t] ? measure.value(*point.runs[t]) : NAN});
    chart.curves.push_back(std::move(curve));
  }
  return "<div class=\"scroll\">" + curve_chart_svg(chart) + "</div>\n";
}

}  // namespace

std::string technique_plots(const ComparedScene& scene) {
  const std::vector<const ComparedTechnique*> techniques = fastest_first(scene);
  if (techniques.size() < 2) return {};
  std::string text = "<div class=\"row\"><h3>Plots</h3>";
  text += error_over(
      techniques, "Error over time", "milliseconds",
      [](const ComparedTechnique& t) { return t.stats.milliseconds; },
      [](double v) { return amount(v) + " ms"; });
  text += error_over(
      techniques, "Error over memory", "bytes a pixel",
      [&](const ComparedTechnique& t) { return bytes_per_pixel(t, scene); },
      [](double v) { return amount(v) + " B"; });
  text +=
      "<p class=\"note\">Upwards: PSNR of the techniques that differ from the exact image; on the line "
      "above, "
      "those that do not differ by more than 1/255. Dotted: the best for their cost.</p>";
  return text + scrolled(bar_chart_svg(bars_of(techniques, scene))) + "</div>";
}

std::string sweep_section(const ComparedSweep& sweep, std::size_t number) {
  const SweepWords words = words_of(sweep.kind);
  std::string text =
      fmt::format("<section id=\"{}\"><h2>{}</h2><p class=\"note\">{}: {}</p>", sweep_anchor(number),
                  words.title, escape_html(name_of(sweep.input)), words.words);
  for (const Measure* measure : words.measures) text += chart_of(sweep, *measure);
  return text + "</section>\n";
}

}  // namespace pellucid
