// All techniques over all scenes, and links to what follows: see compare_parts.h.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/compare_parts.h"
#include "report/html_page.h"

namespace pellucid {
namespace {

// Times the fastest exact technique from which on a cell has all its colour.
constexpr double kSlow = 16;
// PSNR, dB, from where on it has none, and where it has all of it.
constexpr double kGoodPsnr = 50;
constexpr double kBadPsnr = 10;
// Cells' colours lie over the page's ground, light or dark, and under its ink.
constexpr double kMostOpacity = 0.55;

struct CellColor {
  int red, green, blue;
};
constexpr CellColor kSlower{214, 96, 44};
constexpr CellColor kFaster{31, 140, 110};

std::string cell(const std::string& text, const CellColor& color, double share, const std::string& title) {
  const double opacity = kMostOpacity * std::clamp(share, 0.0, 1.0);
  return fmt::format("<td class=\"cell\" title=\"{}\" style=\"background:rgb({} {} {}/{:.2f})\">{}</td>",
                     escape_html(title), color.red, color.green, color.blue, opacity, escape_html(text));
}

const ComparedTechnique* technique_of(const ComparedScene& scene, const std::string& name) {
  const auto found = std::find_if(scene.techniques.begin(), scene.techniques.end(),
                                  [&](const ComparedTechnique& t) { return t.name == name; });
  return found == scene.techniques.end() ? nullptr : &*found;
}

// ---------------------------------------------------------------------------------------- what a cell tells

std::string time_cell(const ComparedTechnique& technique, const ComparedScene& scene) {
  const std::optional<double> ratio = scene.time_ratio(technique);
  const std::string title = format_fixed(technique.stats.milliseconds, 1) + " ms";
  if (!ratio) return cell(kNoValue, kSlower, 0, title);
  const double share = std::log(std::max(*ratio, 1e-6)) / std::log(kSlow);
  return cell(format_fixed(*ratio, 2), share < 0 ? kFaster : kSlower, std::abs(share), title);
}

std::string psnr_cell(const ComparedTechnique& technique, const ComparedScene&) {
  if (!technique.error) return cell(kNoValue, kSlower, 0, "");
  const std::string title = fmt::format("{} pixels differ, HyAB {}", format_count(technique.error->differing),
                                        format_fixed(technique.perceived.hyab, 3));
  if (technique.equals_exact()) return cell("=", kSlower, 0, title);
  const double share = (kGoodPsnr - technique.error->psnr) / (kGoodPsnr - kBadPsnr);
  return cell(format_fixed(technique.error->psnr, 1), kSlower, share, title);
}

// More than the exact technique that takes the fewest, by powers of two.
std::string bytes_cell(const ComparedTechnique& technique, const ComparedScene& scene) {
  double least = INFINITY;
  for (const ComparedTechnique& other : scene.techniques) {
    if (other.drawn() && other.exact && other.stats.bytes > 0)
      least = std::min(least, static_cast<double>(other.stats.bytes));
  }
  const auto bytes = static_cast<double>(technique.stats.bytes);
  const double pixels = static_cast<double>(scene.width) * scene.height;
  const double share = bytes > 0 && std::isfinite(least) ? std::log(bytes / least) / std::log(kSlow) : 0;
  return cell(format_fixed(bytes / pixels, 1), share < 0 ? kFaster : kSlower, std::abs(share),
              format_bytes(technique.stats.bytes));
}

struct OverviewMeasure {
  const char *name, *words;
  std::string (*cell)(const ComparedTechnique&, const ComparedScene&);
};
constexpr OverviewMeasure kOverviewMeasures[] = {
    {"time", "Time, as a multiple of the fastest technique that captured everything; the mean is geometric.",
     time_cell},
    {"error", "PSNR against the exact picture, dB; =: no pixel differs by more than 1/255.", psnr_cell},
    {"memory", "Bytes a pixel; coloured beside the exact technique that takes the fewest.", bytes_cell}};

// ------------------------------------------------------------------------------------------------- the table

std::string counts_of(const TechniqueSummary& summary) {
  return fmt::format("<td>{}/{}</td><td>{}</td>", summary.equal, summary.scenes,
                     summary.drawn < summary.scenes ? fmt::format("{}", summary.scenes - summary.drawn) : "");
}

std::string matrix_row(const CompareReport& report, const TechniqueSummary& summary,
                       const OverviewMeasure& measure) {
  std::string text = fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td>{}",
                                 escape_html(summary.name), summary.exact ? "yes" : "no",
                                 summary.time_ratio ? format_fixed(*summary.time_ratio, 2) : kNoValue,
                                 !summary.worst_psnr               ? kNoValue
                                 : summary.equal == summary.scenes ? "="
                                                                   : format_fixed(*summary.worst_psnr, 1),
                                 counts_of(summary));
  for (const ComparedScene& scene : report.scenes) {
    const ComparedTechnique* technique = technique_of(scene, summary.name);
    if (technique == nullptr) {
      text += "<td class=\"cell\"></td>";
    } else if (technique->drawn()) {
      text += measure.cell(*technique, scene);
    } else {
      text += "<td class=\"cell failed\" title=\"" + escape_html(technique->failure) + "\">failed</td>";
    }
  }
  return text + "</tr>\n";
}

std::string matrix(const CompareReport& report, const OverviewMeasure& measure) {
  std::string text = fmt::format(
      "<p class=\"note\">{}</p><div class=\"scroll\"><table><thead><tr><th>technique</th><th>exact</th>"
      "<th>mean<br/>ratio</th><th>worst<br/>PSNR</th><th>equal<br/>pictures</th><th>failed</th>",
      measure.words);
  for (std::size_t s = 0; s < report.scenes.size(); ++s) {
    text += fmt::format("<th class=\"cell\"><a href=\"#{}\">{}</a></th>", scene_anchor(s),
                        escape_html(name_of(report.scenes[s].input)));
  }
  text += "</tr></thead><tbody>\n";
  for (const TechniqueSummary& summary : summarize(report)) text += matrix_row(report, summary, measure);
  return text + "</tbody></table></div>";
}

std::string contents(const CompareReport& report) {
  std::string text = "<ul class=\"contents\">";
  const auto add = [&](const std::string& anchor, const std::string& words) {
    text += fmt::format("<li><a href=\"#{}\">{}</a></li>", anchor, escape_html(words));
  };
  for (std::size_t s = 0; s < report.scenes.size(); ++s)
    add(scene_anchor(s), name_of(report.scenes[s].input));
  for (std::size_t s = 0; s < report.sweeps.size(); ++s) {
    const auto kind = static_cast<std::size_t>(report.sweeps[s].kind);
    add(sweep_anchor(s), "over " + compare_sweeps()[kind].name);
  }
  add("settings", "made with");
  return text + "</ul>";
}

}  // namespace

std::string compare_overview(const CompareReport& report) {
  std::string text = contents(report);
  if (report.scenes.size() < 2) return text;
  Choices choices("overview", "sheets");
  for (const OverviewMeasure& measure : kOverviewMeasures) choices.add(measure.name, matrix(report, measure));
  return text + "<h2 id=\"overview\">All scenes</h2>" + choices.html();
}

}  // namespace pellucid
