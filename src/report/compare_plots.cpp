// Time, memory and error of a scene's techniques as plots: see compare_parts.h.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/compare_parts.h"
#include "report/html_page.h"
#include "report/technique_charts.h"

namespace pellucid {
namespace {

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

// "0.5", "12.3", "2,000"
std::string amount(double value) {
  return value < 1000 ? fmt::format("{:.3g}", value)
                      : format_count(static_cast<std::uint64_t>(std::llround(value)));
}

using Cost = std::function<double(const ComparedTechnique&)>;

// Techniques whose cost is nothing have no place on a logarithmic axis: blending takes no memory.
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
      "<p class=\"note\">Upwards: PSNR of what differs from the exact picture; on the line above, what does "
      "not by more than 1/255. Dotted: the best for its cost.</p>";
  return text + scrolled(bar_chart_svg(bars_of(techniques, scene))) + "</div>";
}

}  // namespace pellucid
