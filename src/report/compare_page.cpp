// Makes the page of a comparison: all scenes as a table, then each scene, then the sweeps. In: a comparison
// (pellucid/compare_report.h). Out: one self-contained HTML page.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "report/compare_parts.h"
#include "report/html_page.h"
#include "report/measure_charts.h"

namespace pellucid {
namespace {

// ---------------------------------------------------------------------------------------------- all scenes

// The ratio to the fastest exact technique at which a cell has its full colour.
constexpr double kSlow = 16;
// The PSNR in dB at which a cell has no colour, and the one at which it has its full colour.
constexpr double kGoodPsnr = 50;
constexpr double kBadPsnr = 10;
// Colours of cells are translucent, because the background of the page may be light or dark.
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

// The colour depends on the logarithm of the ratio to the exact technique that takes the fewest bytes.
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
    {"error", "PSNR against the exact image, dB; =: no pixel differs by more than 1/255.", psnr_cell},
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
      "<th>mean<br/>ratio</th><th>worst<br/>PSNR</th><th>equal<br/>images</th><th>failed</th>",
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

// Returns links to all sections and, for two or more scenes, a table of all techniques over all scenes.
std::string compare_overview(const CompareReport& report) {
  std::string text = contents(report);
  if (report.scenes.size() < 2) return text;
  Choices choices("overview", "sheets");
  for (const OverviewMeasure& measure : kOverviewMeasures) choices.add(measure.name, matrix(report, measure));
  return text + "<h2 id=\"overview\">All scenes</h2>" + choices.html();
}

// ----------------------------------------------------------------------------------------------- one scene

std::string title_of(const CompareReport& report) {
  if (report.scenes.size() == 1) return name_of(report.scenes.front().input);
  if (report.scenes.size() > 1) return plural(report.scenes.size(), "scene");
  return report.sweeps.empty() ? "nothing" : name_of(report.sweeps.front().input);
}

std::string headline(const CompareReport& report) {
  std::string text = fmt::format(
      "<h1>{}: capture techniques</h1><p class=\"soft\">Every technique gathers the fragments of each pixel "
      "and "
      "hands them in depth order to the same effect, {}. Drawn on {} ({}); times are medians of {}, all "
      "techniques taking turns.</p>",
      escape_html(title_of(report)), escape_html(report.effect), escape_html(report.device.name),
      escape_html(report.device.driver), plural(report.frames > 1 ? report.frames - 1 : 1, "frame"));
  if (report.device.cpu) {
    text +=
        "<p><b>This driver runs on the CPU.</b> Compare the ratios of times, not the times; a GPU may rank "
        "techniques in another order.</p>";
  }
  return text;
}

std::string tiles(const ComparedScene& scene) {
  const CaptureStats& exact = scene.exact;
  std::string text = "<div class=\"tiles\">";
  text += tile(format_count(exact.fragments),
               fmt::format("fragments of {} on {}", plural(scene.triangles, "triangle"),
                           plural(exact.covered_pixels, "pixel")));
  text += tile(format_fixed(scene.mean_depth(), 2), "fragments of a covered pixel on average");
  text += tile(format_count(exact.deepest_pixel), "fragments of the deepest pixel");
  text += tile(format_fixed(scene.coplanar_share(), 3),
               "C_p, the share of covered pixels with fragments at one depth");
  if (const ComparedTechnique* fastest = scene.fastest_exact()) {
    text += tile(fastest->name,
                 fmt::format("fastest exact technique, {} ms", format_fixed(fastest->stats.milliseconds, 1)));
  }
  return text + "</div>";
}

std::string row_of(const ComparedTechnique& technique, const ComparedScene& scene) {
  std::string text =
      fmt::format("<tr{}><td title=\"{}\">{}</td><td>{}</td>",
                  &technique == scene.fastest_exact() ? " class=\"ours\"" : "", escape_html(technique.title),
                  escape_html(technique.name), technique.exact ? "yes" : "no");
  if (!technique.failure.empty())
    return text + "<td colspan=\"16\">" + escape_html(technique.failure) + "</td></tr>\n";
  const CaptureStats& stats = technique.stats;
  const std::optional<double> ratio = scene.time_ratio(technique);
  const auto cell = [&](const std::string& value) { text += "<td>" + value + "</td>"; };
  cell(format_fixed(stats.milliseconds, 1));
  cell(ratio ? format_fixed(*ratio, 2) : kNoValue);
  cell(std::to_string(stats.geometry_passes));
  cell(stats.rounds > 0 ? std::to_string(stats.rounds) : kNoValue);
  cell(format_bytes(stats.bytes));
  cell(format_fixed(static_cast<double>(stats.bytes) / (static_cast<double>(scene.width) * scene.height), 1));
  cell(format_count(stats.captured));
  cell(format_fixed(stats.captured_share(), 4));
  cell(stats.k_least ? format_k_range(stats) : kNoValue);
  cell(format_count(stats.overflowed));
  cell(format_count(stats.coplanar));
  cell(technique.error ? format_fixed(technique.error->psnr, 1) : kNoValue);
  cell(technique.error ? format_fixed(technique.error->largest, 4) : kNoValue);
  cell(technique.error ? format_fixed(technique.perceived.ssim, 4) : kNoValue);
  cell(technique.error ? format_fixed(technique.perceived.hyab, 3) : kNoValue);
  cell(technique.flicker ? format_fixed(*technique.flicker, 3) : kNoValue);
  return text + "</tr>\n";
}

std::string table(const ComparedScene& scene) {
  std::string text =
      "<div class=\"scroll\"><table><thead><tr><th>technique</th><th>exact</th><th>ms</th><th>ratio</th>"
      "<th>geometry<br/>passes</th><th>rounds</th><th>memory</th><th>bytes<br/>a "
      "pixel</th><th>captured</th><th>R_h</th><th>k</th><th>overflowed</th><th>coplanar</th><th>PSNR dB</th>"
      "<th>largest<br/>error</th><th>SSIM</th><th>HyAB</th><th>flicker</th></tr></thead><tbody>";
  for (const ComparedTechnique& technique : scene.techniques) text += row_of(technique, scene);
  return text +
         "</tbody></table></div><p class=\"note\">Exact: promises to capture every fragment, coplanar ones "
         "too. Ratio: to the fastest exact technique. R_h: captured fragments of all. PSNR over covered "
         "pixels, and the largest error of a channel (0 to 1), against the exact image. SSIM: mean "
         "structural "
         "similarity of luma; HyAB: mean colour difference in CIELAB after a blur of one pixel. k: slots for "
         "fragments of a covered pixel, least and most, of techniques with a memory budget. Flicker: how "
         "much more "
         "the "
         "image changes than the exact one from frame to frame, in 1/255.</p>";
}

std::string fragments_histogram(const ComparedScene& scene) {
  if (scene.pixels_by_depth.empty()) return {};
  return "<div class=\"row half\"><h3>How many pixels have how many fragments</h3>" +
         depth_histogram_svg(scene.pixels_by_depth) + "</div>";
}

std::string scene_section(const ComparedScene& scene, std::size_t number) {
  std::string text =
      fmt::format("<section id=\"{}\"><h2>{}</h2>", scene_anchor(number), escape_html(name_of(scene.input)));
  text += tiles(scene) + image_viewer(scene, number) + table(scene);
  for (const std::string& note : scene.notes) text += "<p class=\"note\">" + escape_html(note) + "</p>";
  text += technique_plots(scene) + heat_map_section(scene) + fragments_histogram(scene);
  return text + "</section>\n";
}

std::string settings_section(const CompareReport& report) {
  std::string text = "<h2 id=\"settings\">Made with</h2><dl>";
  const auto add = [&](const std::string& key, const std::string& value) {
    if (!value.empty()) text += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escape_html(key), escape_html(value));
  };
  for (const ComparedScene& scene : report.scenes) {
    add("scene", fmt::format("{}: {}, {}, {}x{}, camera {}; exact image by {}", scene.input,
                             plural(scene.triangles, "triangle"), plural(scene.objects, "object"),
                             scene.width, scene.height, scene.camera, scene.reference));
  }
  add("drawn", fmt::format("{}, surfaces {}, k = {}", report.effect, report.surfaces, report.k));
  add("memory budget", report.memory > 0 ? format_bytes(report.memory) : "");
  add("device", fmt::format("{} ({})", report.device.name, report.device.driver));
  add("time in all", format_seconds(report.seconds_total));
  add("memory", report.peak_rss_bytes > 0 ? format_bytes(report.peak_rss_bytes) + " at most" : "");
  add("version", "pellucid " + std::string(library_version()));
  return text + "</dl>";
}

}  // namespace

std::string name_of(const std::string& input) {
  return std::filesystem::path(input).filename().string();
}

std::string scene_anchor(std::size_t number) {
  return fmt::format("scene-{}", number);
}

std::string sweep_anchor(std::size_t number) {
  return fmt::format("sweep-{}", number);
}

std::string compare_html(const CompareReport& report) {
  std::string content = fmt::format("<style>{}</style>\n", kCompareStyle);
  content += headline(report) + "\n" + compare_overview(report) + "\n";
  for (std::size_t s = 0; s < report.scenes.size(); ++s) content += scene_section(report.scenes[s], s);
  for (std::size_t s = 0; s < report.sweeps.size(); ++s) content += sweep_section(report.sweeps[s], s);
  content += settings_section(report) + "\n";
  // Each script is an element of its own, so that a failure of one does not stop the other.
  for (const char* script : {kCompareViewer, kCompareTables})
    content += fmt::format("<script>\n{}</script>\n", script);
  return html_page(title_of(report) + ": capture techniques", content);
}

}  // namespace pellucid
