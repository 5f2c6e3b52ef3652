// Capture techniques side by side as one self-contained page: see pellucid/compare_report.h.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "curve_chart.h"
#include "html_charts.h"
#include "html_page.h"
#include "pellucid/compare_report.h"

namespace pellucid {
namespace {

// The exact picture in the place of another as long as that one is held.
constexpr const char* kHoldScript = R"(<script>
for (const flip of document.querySelectorAll('.flip')) {
  const exact = flip.querySelector('img');
  for (const image of flip.querySelectorAll('.views img.held')) {
    const own = image.src;
    image.style.touchAction = 'none';
    image.draggable = false;
    image.addEventListener('pointerdown', () => { image.src = exact.src; });
    for (const name of ['pointerup', 'pointerleave', 'pointercancel']) {
      image.addEventListener(name, () => { image.src = own; });
    }
  }
}
</script>
)";

std::string name_of(const std::string& input) {
  return std::filesystem::path(input).filename().string();
}

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
  const ComparedTechnique* fastest = scene.fastest_exact();
  std::string text =
      fmt::format("<tr{}><td title=\"{}\">{}</td><td>{}</td>", &technique == fastest ? " class=\"ours\"" : "",
                  escape_html(technique.title), escape_html(technique.name), technique.exact ? "yes" : "no");
  if (!technique.failure.empty())
    return text + "<td colspan=\"16\">" + escape_html(technique.failure) + "</td></tr>\n";
  const CaptureStats& stats = technique.stats;
  const double ratio = fastest == nullptr ? NAN : stats.milliseconds / fastest->stats.milliseconds;
  const auto cell = [&](const std::string& value) { text += "<td>" + value + "</td>"; };
  cell(format_fixed(stats.milliseconds, 1));
  cell(std::isfinite(ratio) ? format_fixed(ratio, 2) : kNoValue);
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
         "pixels, and the largest error of a channel (0 to 1), against the exact picture. SSIM: mean "
         "structural "
         "similarity of luma; HyAB: mean colour difference in CIELAB after a blur of one pixel. k: slots for "
         "fragments of a covered pixel, least and most, of techniques with a budget. Flicker: how much more "
         "the "
         "picture changes than the exact one from frame to frame, in 1/255.</p>";
}

std::string held_figure(const ReportPicture& picture) {
  std::string text = figure(picture.caption, picture.png);
  return text.replace(text.find("<img "), 5, "<img class=\"held\" ");
}

// One choice of the viewer: radio buttons need no script, and the arrow keys go through them.
std::string choice(const std::string& id, std::size_t number, const std::string& name,
                   const std::string& figures) {
  return fmt::format(
      "<input type=\"radio\" name=\"{0}\" id=\"{0}-{1}\"{2}/><label for=\"{0}-{1}\">{3}</label><div "
      "class=\"views\">{4}</div>\n",
      id, number, number == 0 ? " checked=\"checked\"" : "", escape_html(name), figures);
}

std::string viewer(const ComparedScene& scene, std::size_t number) {
  if (scene.picture.png.empty()) return {};
  const std::string id = fmt::format("scene{}", number);
  std::string choices = choice(id, 0, "exact", figure(scene.picture.caption, scene.picture.png));
  std::string same;
  std::size_t count = 0;
  for (const ComparedTechnique& technique : scene.techniques) {
    if (!technique.failure.empty()) continue;
    if (technique.pictures.empty()) {
      same += (same.empty() ? "" : ", ") + technique.name;
      continue;
    }
    std::string figures;
    for (const ReportPicture& picture : technique.pictures)
      figures +=
          &picture == technique.pictures.data() ? held_figure(picture) : figure(picture.caption, picture.png);
    choices += choice(id, ++count, technique.name, figures);
  }
  std::string text = "<h3>Pictures</h3>";
  if (count > 0) {
    text +=
        "<p class=\"note\">Choose a technique, also with the arrow keys. Hold its picture to see the exact "
        "one "
        "in its place. Beside it the difference: white for none, dark red for 64 steps of 255 or more.</p>";
  }
  text += "<div class=\"flip\">\n" + choices + "</div>";
  if (!same.empty()) {
    text +=
        "<p class=\"note\">No pixel differs by more than 1/255 from the exact picture: " + escape_html(same) +
        ".</p>";
  }
  return text;
}

std::string scene_section(const ComparedScene& scene, std::size_t number) {
  std::string text = fmt::format("<h2>{}</h2>", escape_html(name_of(scene.input)));
  text += tiles(scene) + table(scene);
  for (const std::string& note : scene.notes) text += "<p class=\"note\">" + escape_html(note) + "</p>";
  if (!scene.pixels_by_depth.empty()) {
    text += "<div class=\"row half\"><h3>How many pixels have how many fragments</h3>" +
            depth_histogram_svg(scene.pixels_by_depth) + "</div>";
  }
  text += "<div class=\"row\">" + viewer(scene, number) + "</div>";
  return text + "\n";
}

// ------------------------------------------------------------------------------------------------- sweeps

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

std::string sweep_section(const ComparedSweep& sweep) {
  const SweepWords words = words_of(sweep.kind);
  std::string text = fmt::format("<h2>{}</h2><p class=\"note\">{}: {}</p>", words.title,
                                 escape_html(name_of(sweep.input)), words.words);
  for (const Measure* measure : words.measures) text += chart_of(sweep, *measure);
  return text;
}

std::string settings_section(const CompareReport& report) {
  std::string text = "<h2>Made with</h2><dl>";
  const auto add = [&](const std::string& key, const std::string& value) {
    if (!value.empty()) text += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escape_html(key), escape_html(value));
  };
  for (const ComparedScene& scene : report.scenes) {
    add("scene", fmt::format("{}: {}, {}, {}x{}, camera {}; exact picture by {}", scene.input,
                             plural(scene.triangles, "triangle"), plural(scene.objects, "object"),
                             scene.width, scene.height, scene.camera, scene.reference));
  }
  add("drawn", fmt::format("{}, surfaces {}, k = {}", report.effect, report.surfaces, report.k));
  add("budget", report.memory > 0 ? format_bytes(report.memory) : "");
  add("device", fmt::format("{} ({})", report.device.name, report.device.driver));
  add("time in all", format_seconds(report.seconds_total));
  add("memory", report.peak_rss_bytes > 0 ? format_bytes(report.peak_rss_bytes) + " at most" : "");
  add("version", "pellucid " + std::string(library_version()));
  return text + "</dl>";
}

}  // namespace

std::string compare_html(const CompareReport& report) {
  std::string content = headline(report) + "\n";
  for (std::size_t s = 0; s < report.scenes.size(); ++s) content += scene_section(report.scenes[s], s);
  for (const ComparedSweep& sweep : report.sweeps) content += sweep_section(sweep);
  return html_page(title_of(report) + ": capture techniques",
                   content + settings_section(report) + "\n" + kHoldScript);
}

}  // namespace pellucid
