// Makes the page of a measurement: headline, images, methods, and error over the sphere and over distance.
// In: a measure report, an order set and images (pellucid/report.h). Out: one self-contained HTML page.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellucid/report.h"
#include "report/html_page.h"
#include "report/measure_charts.h"

namespace pellucid {
namespace {

const MethodReport* find_method(const PrimitiveMeasureReport& primitive, std::string_view name) {
  for (const MethodReport& method : primitive.methods) {
    if (method.quality.name == name) return &method;
  }
  return nullptr;
}

std::string readable_name(const MethodReport& method) {
  const std::string& name = method.quality.name;
  if (name == "original") return "original order";
  if (name == "base") return "best single order";
  if (name == "cache_optimized") return "vertex cache order";
  if (name == "cache_optimized_twins") return "the buffers in vertex cache order";
  if (name == "centroid_sort") return "centroid sort, every frame";
  if (name == "bsp") return "BSP walk, every frame";
  if (name == "dptl") return "presorted lists, plane tests";
  return name;
}

std::string headline(const HtmlReportInput& input, const PrimitiveMeasureReport& primitive) {
  const MethodReport& ours = primitive.methods.front();
  const MethodReport* original = find_method(primitive, "original");
  std::string text =
      fmt::format("<h1>{}: {} index buffer{}, {} wrong pixels</h1>", escape_html(input.title), ours.buffers,
                  ours.buffers == 1 ? "" : "s", format_percent(ours.quality.ipr_mean));
  text += fmt::format(
      "<p class=\"soft\">{} triangles of <b>{}</b>, drawn in depth order from any side by choosing one of {} "
      "index "
      "buffers per frame: no sorting, no extra passes. Measured from {} random viewpoints at {}\u2013{} "
      "bounding radii, "
      "against the exact order of every fragment.</p>",
      format_count(primitive.triangles), escape_html(primitive.name), ours.buffers,
      input.measured->settings.viewpoints, input.measured->settings.min_distance,
      input.measured->settings.max_distance);
  text += "<div class=\"tiles\">";
  text +=
      tile(format_percent(ours.quality.ipr_mean),
           original != nullptr ? "wrong pixels; original order " + format_percent(original->quality.ipr_mean)
                               : "wrong pixels on average");
  text += tile(format_fixed(ours.quality.psnr_mean, 1) + " dB", "PSNR over the covered pixels");
  text += tile(std::to_string(ours.buffers),
               "index buffers for " + to_string(input.orders->partition) + " view cells");
  text += tile(format_bytes(ours.memory_bytes), "index data");
  text += tile(format_fixed(ours.fifo.acmr, 2), "vertices transformed per triangle (ACMR), FIFO " +
                                                    std::to_string(input.measured->settings.cache_size));
  return text + "</div>";
}

std::string images(std::span<const ImageRow> rows) {
  if (rows.empty()) return {};
  std::string text =
      "<h2>What it looks like</h2><p class=\"note\">From left to right: the truth, what the chosen index "
      "buffer draws, "
      "what a viewer draws without it, and in red every pixel that the buffer gets wrong.</p>";
  for (const ImageRow& row : rows) {
    text += fmt::format("<div class=\"row\"><h3>{}</h3><div class=\"pictures\">", escape_html(row.title));
    for (const ReportImage& image : row.images) text += figure(image.caption, image.png);
    text += "</div></div>";
  }
  return text;
}

std::string methods_table(const PrimitiveMeasureReport& primitive) {
  std::string text =
      "<div class=\"scroll\"><table><thead><tr><th>method</th><th>buffers</th><th>wrong pixels</th><th>worst "
      "view</th>"
      "<th>PSNR dB</th><th>worst dB</th><th>ACMR</th><th>per "
      "drawn<br/>triangle</th><th>ATVR</th><th>overdraw</th>"
      "<th>index data</th><th>other data</th><th>built in</th><th>triangles<br/>submitted</th>"
      "<th>plane tests</th><th>CPU per frame</th></tr></thead><tbody>";
  for (const MethodReport& method : primitive.methods) {
    const MethodQuality& quality = method.quality;
    text += fmt::format(
        "<tr{}><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</"
        "td><td>{}</td>"
        "<td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
        method.kind == MethodKind::orders ? " class=\"ours\"" : "", escape_html(readable_name(method)),
        method.buffers, format_percent(quality.ipr_mean), format_percent(quality.ipr_max),
        format_fixed(quality.psnr_mean, 1), format_fixed(quality.psnr_min, 1),
        format_fixed(method.fifo.acmr, 3), format_fixed(method.fifo.acmr_drawn, 3),
        format_fixed(method.atvr, 2), method.overdraw > 0 ? format_fixed(method.overdraw, 3) : "\u2013",
        format_bytes(method.memory_bytes), format_bytes(method.auxiliary_bytes),
        method.build_seconds < 0 ? "\u2013" : format_seconds(method.build_seconds),
        format_count(static_cast<std::uint64_t>(std::lround(method.triangles_submitted))),
        format_count(static_cast<std::uint64_t>(std::lround(method.plane_tests))),
        format_nanoseconds(method.nanoseconds_per_frame));
  }
  text += "</tbody></table></div>";
  for (const std::string& note : primitive.notes) text += "<p class=\"note\">" + escape_html(note) + "</p>";
  return text;
}

std::string caches_table(const PrimitiveMeasureReport& primitive) {
  std::string text = "<div class=\"scroll\"><table><thead><tr><th>ACMR by cache</th>";
  for (const ReportedCache& cache : kReportedCaches) {
    text += fmt::format("<th>{} {}</th>", cache.model == CacheModel::fifo ? "FIFO" : "LRU", cache.size);
  }
  text += "</tr></thead><tbody>";
  for (const MethodReport& method : primitive.methods) {
    text += fmt::format("<tr{}><td>{}</td>", method.kind == MethodKind::orders ? " class=\"ours\"" : "",
                        escape_html(readable_name(method)));
    for (const double acmr : method.acmr_by_cache) text += fmt::format("<td>{}</td>", format_fixed(acmr, 3));
    text += "</tr>";
  }
  return text + "</tbody></table></div>";
}

std::string methods_section(const HtmlReportInput& input) {
  std::string text =
      "<h2>Methods side by side</h2><p class=\"note\">A pixel is wrong when its fragments are not blended in "
      "depth "
      "order. ACMR counts both facings of a triangle; per drawn triangle, the facing that is culled counts "
      "as "
      "overhead. CPU per frame is the work before the frame can be drawn; triangles submitted count both "
      "facings.</p>";
  for (const PrimitiveMeasureReport& primitive : input.measured->primitives) {
    if (input.measured->primitives.size() > 1) {
      text += fmt::format("<h3 style=\"margin-top:24px\">{}, {} triangles</h3>", escape_html(primitive.name),
                          format_count(primitive.triangles));
    }
    text += methods_table(primitive) + caches_table(primitive);
  }
  return text;
}

std::string error_section(const HtmlReportInput& input, const PrimitiveMeasureReport& primitive) {
  const MeasureSettings& settings = input.measured->settings;
  const MethodQuality& quality = primitive.methods.front().quality;
  const std::vector<Viewpoint> viewpoints =
      random_viewpoints(settings.viewpoints, settings.min_distance, settings.max_distance, settings.seed);
  return "<h2>Where the camera may be</h2><div class=\"pair\"><div><h3>Which order each view cell uses</h3>" +
         order_sphere_svg(*input.orders) + "</div><div><h3>Wrong pixels by view direction</h3>" +
         error_sphere_svg(viewpoints, quality.frames) +
         "<p class=\"note\">Smoothed between the measured viewpoints (dots).</p></div></div>"
         "<div class=\"pair\"><div><h3>Wrong pixels by distance</h3>" +
         distance_plot_svg(viewpoints, quality.frames, quality.by_distance, settings.min_distance,
                           settings.max_distance) +
         "<p class=\"note\">One dot per viewpoint; the line is the mean of each bin.</p></div><div><h3>How "
         "many "
         "viewpoints have how many</h3>" +
         histogram_svg(quality.frames) + "</div></div>";
}

std::string settings_section(const HtmlReportInput& input) {
  const MeasureSettings& settings = input.measured->settings;
  const OrderSet& orders = *input.orders;
  std::string text = "<h2>Made with</h2><dl>";
  const auto add = [&](const std::string& key, const std::string& value) {
    text += fmt::format("<dt>{}</dt><dd>{}</dd>", escape_html(key), escape_html(value));
  };
  std::string files;
  for (const std::string& file : input.measured->inputs) files += (files.empty() ? "" : ", ") + file;
  add("files", files);
  add("view cells", fmt::format("{}, {} cells", to_string(orders.partition), orders.cell_orders.size()));
  add("valid", fmt::format("from {} to {} bounding radii", format_fixed(orders.valid_from, 2),
                           std::isinf(orders.valid_to) ? "infinity" : format_fixed(orders.valid_to, 2)));
  add("facing", orders.facing == Facing::single ? "front faces" : "both faces of every triangle");
  add("viewpoints", fmt::format("{}, distance {} to {}, seed {}", settings.viewpoints, settings.min_distance,
                                settings.max_distance, settings.seed));
  add("image", fmt::format("{} by {} pixels, no multisampling, opacity {}", settings.size, settings.size,
                           settings.alpha));
  add("overdraw",
      fmt::format("front faces, depth test, first {} viewpoints", input.measured->overdraw_viewpoints));
  add("time", format_seconds(input.measured->seconds_total));
  add("version", "pellucid " + std::string(library_version()));
  text += "</dl>";
  if (!input.command.empty()) {
    text += fmt::format("<p style=\"margin-top:16px\"><code>{}</code></p>", escape_html(input.command));
  }
  return text;
}

}  // namespace

std::string html_report(const HtmlReportInput& input) {
  const PrimitiveMeasureReport& primitive = input.measured->primitives[input.primitive];
  return html_page(input.title + ": visibility orders",
                   headline(input, primitive) + "\n" + images(input.rows) + "\n" + methods_section(input) +
                       "\n" + error_section(input, primitive) + "\n" + settings_section(input) + "\n");
}

}  // namespace pellucid
