// One self-contained page: headline, pictures, methods, error over the sphere and over distance. See
// pellucid/report.h.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "html_charts.h"
#include "pellucid/report.h"

namespace pellucid {
namespace {

// Restrained: one column, one accent, system fonts; follows the reader's light or dark scheme.
constexpr std::string_view kStyle = R"css(
:root{color-scheme:light dark;--ink:#1c2430;--soft:#5b6675;--line:#dfe4ea;--ground:#fff;--tile:#f5f7f9;--accent:#1f6fb2;--bar:#7fb0d8}
@media(prefers-color-scheme:dark){:root{--ink:#e4e9ef;--soft:#98a4b3;--line:#2d3642;--ground:#12161c;--tile:#1a2028;--accent:#6db3ec;--bar:#3f78a8}}
*{box-sizing:border-box}
body{margin:0;background:var(--ground);color:var(--ink);font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif}
main{max-width:1120px;margin:0 auto;padding:40px 24px 64px}
h1{font-size:clamp(24px,4vw,34px);line-height:1.2;font-weight:650;letter-spacing:-.015em;margin:0 0 8px;overflow-wrap:anywhere}
h2{font-size:20px;font-weight:620;margin:52px 0 4px}
h3{font-size:15px;font-weight:600;margin:0 0 8px}
p{margin:0 0 14px;max-width:72ch}
.soft,figcaption,.note{color:var(--soft)}
.note{font-size:14px}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(150px,1fr));gap:12px;margin:26px 0 0}
.tiles div{background:var(--tile);border-radius:10px;padding:14px 16px}
.tiles b{display:block;font-size:25px;font-weight:620;letter-spacing:-.01em;font-variant-numeric:tabular-nums}
.tiles span{font-size:13px;color:var(--soft)}
.row{margin:22px 0 0}
.pictures{display:grid;grid-template-columns:repeat(4,minmax(0,1fr));gap:10px}
figure{margin:0}
figure img{display:block;width:100%;height:auto;border-radius:8px;background:#fff;border:1px solid var(--line)}
figcaption{font-size:13px;margin-top:5px}
.scroll{overflow-x:auto;margin-top:14px}
table{border-collapse:collapse;width:100%;font-size:14.5px;font-variant-numeric:tabular-nums;white-space:nowrap}
th,td{text-align:right;padding:8px 0 8px 18px;border-bottom:1px solid var(--line)}
th:first-child,td:first-child{text-align:left;padding-left:0}
thead th{color:var(--soft);font-weight:500;font-size:13px;vertical-align:bottom}
tr.ours td{font-weight:620}
.pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(420px,100%),1fr));gap:34px;margin-top:18px}
svg.sphere,svg.plot{width:100%;height:auto;display:block}
svg text{font-size:11px;fill:var(--soft)}
.rim{fill:none;stroke:var(--line);stroke-width:1}
.view{fill:#1c2430;fill-opacity:.35;stroke:none}
.grid{stroke:var(--line);stroke-width:1}
.dot{fill:var(--accent);fill-opacity:.38}
.line{fill:none;stroke:var(--ink);stroke-width:1.8}
.bar{fill:var(--bar)}
.keys{list-style:none;padding:0;margin:10px 0 0;display:flex;flex-wrap:wrap;gap:4px 18px;font-size:13px;color:var(--soft)}
.keys i{display:inline-block;width:11px;height:11px;border-radius:3px;margin-right:6px;vertical-align:-1px}
.legend{display:flex;align-items:center;gap:8px;font-size:13px;color:var(--soft);margin-top:10px}
.legend svg{width:180px;height:8px}
dl{display:grid;grid-template-columns:max-content 1fr;gap:4px 20px;font-size:14.5px;margin:14px 0 0}
dt{color:var(--soft)}dd{margin:0;overflow-wrap:anywhere}
code{font:13px/1.5 ui-monospace,"SF Mono",Menlo,"DejaVu Sans Mono",monospace;background:var(--tile);border-radius:6px;padding:2px 6px}
@media(max-width:720px){main{padding:26px 16px 48px}.pictures{grid-template-columns:repeat(2,minmax(0,1fr))}h2{margin-top:40px}}
)css";

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8U | (k < have ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= have ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

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

std::string tile(const std::string& value, const std::string& label) {
  return fmt::format("<div><b>{}</b><span>{}</span></div>", escape_html(value), escape_html(label));
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

std::string pictures(std::span<const PictureRow> rows) {
  if (rows.empty()) return {};
  std::string text =
      "<h2>What it looks like</h2><p class=\"note\">From left to right: the truth, what the chosen index "
      "buffer draws, "
      "what a viewer draws without it, and in red every pixel that the buffer gets wrong.</p>";
  for (const PictureRow& row : rows) {
    text += fmt::format("<div class=\"row\"><h3>{}</h3><div class=\"pictures\">", escape_html(row.title));
    for (const ReportPicture& picture : row.pictures) {
      const std::string caption = escape_html(picture.caption);
      text += fmt::format(
          "<figure><img alt=\"{}\" src=\"data:image/png;base64,{}\"/><figcaption>{}</figcaption></figure>",
          caption, base64(picture.png), caption);
    }
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
  add("picture", fmt::format("{} by {} pixels, no multisampling, opacity {}", settings.size, settings.size,
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

std::string escape_html(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string html_report(const HtmlReportInput& input) {
  const PrimitiveMeasureReport& primitive = input.measured->primitives[input.primitive];
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\"/><title>";
  page += escape_html(input.title) + ": visibility orders</title><style>";
  page += kStyle;
  page += "</style></head><body><main>\n";
  page += headline(input, primitive) + "\n";
  page += pictures(input.rows) + "\n";
  page += methods_section(input) + "\n";
  page += error_section(input, primitive) + "\n";
  page += settings_section(input) + "\n";
  return page + "</main></body></html>\n";
}

}  // namespace pellucid
