// Makes the page of overdraw orders: the orders and the baselines, the chart, and heat maps. In: an overdraw
// report and heat maps (pellucid/overdraw_report.h). Out: one self-contained HTML page.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "pellucid/overdraw_report.h"
#include "pellucid/report.h"
#include "report/heat_maps.h"
#include "report/html_page.h"

namespace pellucid {
namespace {

double excess_of(const OverdrawRow& row) {
  return row.key_frames.mean - 1;
}

// Returns the row that excess overdraw is compared with: the method of the paper, or else that of
// meshoptimizer. Null if neither was measured.
const OverdrawRow* reference_row(const OverdrawReport& report) {
  for (const char* name : {"paper", "meshopt"}) {
    for (const OverdrawRow& row : report.rows)
      if (row.name == name) return &row;
  }
  return nullptr;
}

std::string overdraw_text(double overdraw) {
  return overdraw > 0 ? format_fixed(overdraw, 3) : kNoValue;
}

std::string share_text(const OverdrawRow& row, const OverdrawRow& reference) {
  const bool is_defined = row.key_frames.mean > 0 && excess_of(reference) > 0;
  return is_defined ? fmt::format("{:.0f} %", 100 * excess_of(row) / excess_of(reference)) : kNoValue;
}

std::string title_of(const OverdrawReport& report) {
  return report.input.empty() ? "overdraw" : std::filesystem::path(report.input).filename().string();
}

std::string headline(const OverdrawReport& report) {
  std::string text = "<h1>" + escape_html(title_of(report));
  if (!report.rows.empty() && report.rows.front().key_frames.mean > 0) {
    const OverdrawRow& ours = report.rows.front();
    text += fmt::format(": {}, {} fragments shaded per pixel", plural(ours.buffers, "index buffer"),
                        overdraw_text(ours.key_frames.mean));
  }
  text += fmt::format("</h1><p class=\"soft\">{} in {}, ", plural(report.triangles, "triangle"),
                      plural(report.parts, "draw call"));
  text += report.clips.empty()
              ? "one pose: every direction of view has"
              : fmt::format("{} of {}: every pose and direction of view has",
                            plural(report.frames.size(), "key frame"), plural(report.clips.size(), "clip"));
  text +=
      " the index buffer that it is drawn with, so that what is in front is drawn first and the depth test "
      "rejects what it hides.";
  if (report.measured_viewpoints > 0) {
    text += fmt::format(" Measured from {} that the orders were not made from, in {}.",
                        plural(report.measured_viewpoints, "random viewpoint"),
                        plural(report.measured_images, "image"));
  }
  return text + "</p>";
}

std::string tiles(const OverdrawReport& report) {
  if (report.rows.empty()) return {};
  const OverdrawRow& ours = report.rows.front();
  const OverdrawRow* reference = reference_row(report);
  std::string text = "<div class=\"tiles\">";
  text += tile(overdraw_text(ours.key_frames.mean), "mean overdraw; 1 is the least");
  if (reference != nullptr && reference != &ours) {
    text += tile(share_text(ours, *reference), fmt::format("of the excess of {}, {}", reference->name,
                                                           overdraw_text(reference->key_frames.mean)));
  }
  text += tile(overdraw_text(ours.key_frames.max), "overdraw of the worst image");
  text += tile(format_fixed(ours.acmr, 3),
               fmt::format("vertices transformed per triangle (ACMR), FIFO {}", report.cache_size));
  if (report.memory_bytes > 0) {
    text += tile(format_bytes(report.memory_bytes), "index data of " + plural(ours.buffers, "buffer"));
  }
  if (report.seconds.total > 0) text += tile(format_seconds(report.seconds.total), "to make the orders");
  return text + "</div>";
}

// Returns the table of methods. Columns without any value are left out.
std::string table(const OverdrawReport& report) {
  const OverdrawRow* reference = reference_row(report);
  const bool has_between = std::any_of(report.rows.begin(), report.rows.end(),
                                       [](const OverdrawRow& row) { return row.between.has_value(); });
  std::string text =
      "<div class=\"scroll\"><table><thead><tr><th>method</th><th>buffers</th><th>ACMR</th><th>mean "
      "overdraw</th><th>excess</th>";
  if (reference != nullptr) text += "<th>of the excess<br/>of " + escape_html(reference->name) + "</th>";
  text += "<th>worst image</th>";
  if (has_between) text += "<th>between<br/>key frames</th><th>worst there</th>";
  text += "</tr></thead><tbody>";
  for (std::size_t i = 0; i < report.rows.size(); ++i) {
    const OverdrawRow& row = report.rows[i];
    const bool is_seen = row.key_frames.mean > 0;
    text += fmt::format("<tr{}><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>",
                        i == 0 ? " class=\"ours\"" : "", escape_html(row.name), format_count(row.buffers),
                        format_fixed(row.acmr, 3), overdraw_text(row.key_frames.mean),
                        is_seen ? format_fixed(excess_of(row), 3) : kNoValue);
    if (reference != nullptr) text += "<td>" + share_text(row, *reference) + "</td>";
    text += "<td>" + overdraw_text(row.key_frames.max) + "</td>";
    if (has_between) {
      text += fmt::format("<td>{}</td><td>{}</td>", row.between ? overdraw_text(row.between->mean) : kNoValue,
                          row.between ? overdraw_text(row.between->max) : kNoValue);
    }
    text += "</tr>\n";
  }
  return text + "</tbody></table></div>";
}

// Returns an explanation of the methods that the library has, and null for other names.
const char* explanation_of(const std::string& name) {
  if (name == "refined") return "patches of triangles by measured overdraw, cut where it pays";
  if (name == "paper") return "patches of triangles by summed distance (Han and Sander 2017)";
  if (name == "single") return "one order for all views and key frames";
  if (name == "per-frame") return "an order for every key frame, whatever the view (Sander et al. 2007)";
  if (name == "meshopt") return "meshoptimizer's vertex cache and overdraw order of the rest pose";
  if (name == "original") return "one order for the vertex cache alone";
  if (name == "input") return "the triangles as the file has them";
  return nullptr;
}

std::string methods_section(const OverdrawReport& report) {
  if (report.rows.empty()) return "<p>Nothing was measured.</p>";
  std::string text =
      "<h2>Methods side by side</h2><p class=\"note\">Overdraw: fragments shaded per pixel covered, with a "
      "depth "
      "test. Excess is what lies above 1, the wasted fragments. ACMR: vertices transformed per "
      "triangle "
      "drawn, mean over the buffers. Less is better everywhere.</p>";
  text += table(report) + "<dl>";
  for (const OverdrawRow& row : report.rows) {
    if (const char* words = explanation_of(row.name))
      text += fmt::format("<dt>{}</dt><dd>{}</dd>", escape_html(row.name), words);
  }
  return text + "</dl>";
}

std::string chart_section(const OverdrawReport& report) {
  if (report.rows.empty()) return {};
  const std::string words =
      report.charted_frames() > 1
          ? "<h2>Over the animation</h2><p class=\"note\">Every point is the mean of a key frame over all "
            "viewpoints; the number beside a name is the mean of all. Where a curve is broken, nothing was "
            "in "
            "view.</p>"
          : "<h2>In one chart</h2><p class=\"note\">Bars start at 1: their length is the excess.</p>";
  return words + "<div class=\"scroll\">" + overdraw_chart(report, ChartPlace::page) + "</div>";
}

std::string heat_legend() {
  std::string text = "<ul class=\"keys\"><li>wasted fragments:</li>";
  for (std::uint32_t wasted = 0; wasted < kHeatSteps; ++wasted) {
    const Rgb color = heat_color(wasted + 1);
    text += fmt::format("<li><i style=\"background:#{:02x}{:02x}{:02x}\"></i>{}{}</li>", color[0], color[1],
                        color[2], wasted, wasted + 1 == kHeatSteps ? "+" : "");
  }
  return text + "</ul>";
}

// Returns one row of heat maps per method. All rows have as many columns as the longest one, so that frames
// are aligned. With a single pose there is one image per method, and these are side by side.
std::string sheet_section(const std::vector<std::vector<HeatMap>>& sheet) {
  std::size_t columns = 0;
  for (const std::vector<HeatMap>& row : sheet) columns = std::max(columns, row.size());
  if (columns == 0) return {};
  std::string text = "<h2>Where fragments are wasted</h2><p class=\"note\">";
  text += columns == 1 ? "An image per method, all from the same viewpoint."
                       : "A row per method, a column per key frame, all of a column from the same viewpoint.";
  text +=
      " Pale: shaded once, as it has to be. Darker: shaded again, each time by something nearer. Below each "
      "image stands its overdraw.</p>";
  text += heat_legend();
  text +=
      fmt::format("<div class=\"sheet\" style=\"grid-template-columns:repeat({},minmax(112px,260px))\">\n",
                  columns == 1 ? 4 : columns);
  for (const std::vector<HeatMap>& row : sheet) {
    for (std::size_t i = 0; i < columns; ++i) {
      const bool is_there = i < row.size() && row[i].size > 0;
      text += is_there ? figure(row[i].label, encode_png(heat_image(row[i]))) : "<div></div>";
      text += "\n";
    }
  }
  return text + "</div>";
}

std::string settings_section(const OverdrawReport& report) {
  std::string text = "<h2>Made with</h2><dl>";
  const auto add = [&](const std::string& key, const std::string& value) {
    if (!value.empty()) text += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escape_html(key), escape_html(value));
  };
  add("file", report.input);
  add("written", report.output);
  add("method", fmt::format("{}, \u03bb {:g}, cache of {} (FIFO), seed {}", report.method, report.lambda,
                            report.cache_size, report.seed));
  add("mesh", plural(report.triangles, "triangle") + ", " + format_count(report.vertices) + " vertices, " +
                  plural(report.parts, "draw call"));
  add("patches", report.patches > 0 ? format_count(report.patches) : "");
  std::string clips;
  for (const OverdrawReport::Clip& clip : report.clips) {
    clips += fmt::format("{}{} ({})", clips.empty() ? "" : ", ", clip.name, format_count(clip.key_frames));
  }
  if (!report.clips.empty()) clips += report.joint ? "; orders for all of them" : "; orders for each";
  add("clips (key frames)", clips);
  add("views", fmt::format("{}: {} of {}, {} pixels a side; {} trained on, {}", format_count(report.views),
                           plural(std::max<std::uint64_t>(report.frames.size(), 1), "key frame"),
                           plural(report.viewpoints, "viewpoint"), report.size,
                           format_count(report.training_views), plural(report.iterations, "iteration")));
  add("measured",
      plural(report.measured_viewpoints, "viewpoint") + ", " + plural(report.measured_images, "image"));
  const OverdrawSeconds& seconds = report.seconds;
  add("orders made in",
      fmt::format("{}: patches {}, images {}, clusters {}, assignment {}", format_seconds(seconds.total),
                  format_seconds(seconds.patches), format_seconds(seconds.raster),
                  format_seconds(seconds.cluster), format_seconds(seconds.assign)));
  add("time in all",
      fmt::format("{}: read {}, baselines {}, measure {}, write {}", format_seconds(report.seconds_total),
                  format_seconds(report.seconds_read), format_seconds(report.seconds_baselines),
                  format_seconds(report.seconds_measure), format_seconds(report.seconds_write)));
  add("memory", report.peak_rss_bytes > 0 ? format_bytes(report.peak_rss_bytes) + " at most" : "");
  add("index data",
      fmt::format("{} drawn, {} stored", format_bytes(report.memory_bytes), format_bytes(report.disk_bytes)));
  add("version", "pellucid " + std::string(library_version()));
  text += "</dl>";
  for (const std::string& note : report.notes) text += "<p class=\"note\">" + escape_html(note) + "</p>";
  return text;
}

}  // namespace

std::string overdraw_html(const OverdrawReport& report, const std::vector<std::vector<HeatMap>>& sheet) {
  return html_page(title_of(report) + ": overdraw orders",
                   headline(report) + "\n" + tiles(report) + "\n" + methods_section(report) + "\n" +
                       chart_section(report) + "\n" + sheet_section(sheet) + "\n" + settings_section(report) +
                       "\n");
}

}  // namespace pellucid
