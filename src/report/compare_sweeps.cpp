// What techniques do over a parameter, as plots: see compare_parts.h.
#include <fmt/format.h>

#include <cmath>

#include "report/compare_parts.h"
#include "report/curve_chart.h"
#include "report/html_page.h"

namespace pellucid {
namespace {

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
      return {"Over the size of the picture", "As figure 7 of the paper, and memory.", {&kTime, &kMemory}};
    case SweepKind::coplanarity:
      return {"Over coplanarity",
              "The scene is drawn several times in one place, so that every fragment meets as many others at "
              "its depth. As figure 8 of the paper, and what is captured.",
              {&kTime, &kCaptured}};
    case SweepKind::depth:
      return {"Over depth complexity",
              "The scene is drawn several times along the lines of sight: the same picture, so many times as "
              "deep. As figure 9 of the paper, and memory.",
              {&kTime, &kMemory}};
    case SweepKind::memory:
      break;
  }
  return {"Over the size of the pool",
          "Techniques that store all fragments in a pool lose what finds no place in it; those with a budget "
          "get the bytes that sb takes for that pool; the others do not mind. As figure 11 of the paper.",
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

std::string sweep_section(const ComparedSweep& sweep, std::size_t number) {
  const SweepWords words = words_of(sweep.kind);
  std::string text =
      fmt::format("<section id=\"{}\"><h2>{}</h2><p class=\"note\">{}: {}</p>", sweep_anchor(number),
                  words.title, escape_html(name_of(sweep.input)), words.words);
  for (const Measure* measure : words.measures) text += chart_of(sweep, *measure);
  return text + "</section>\n";
}

}  // namespace pellucid
