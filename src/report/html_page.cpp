// Implements html_page.h: the frame and the parts of report pages.
#include "report/html_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "pellucid/report.h"

namespace pellucid {
namespace {

// One column, one accent colour and system fonts; follows the reader's light or dark scheme.
constexpr std::string_view kPageStyle = R"css(
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
.flip{display:flex;flex-wrap:wrap;gap:6px;margin-top:16px}
.flip>input{position:absolute;opacity:0;pointer-events:none}
.flip>label{font-size:14px;padding:3px 11px;border:1px solid var(--line);border-radius:7px;cursor:pointer}
.flip>input:checked+label{background:var(--accent);border-color:var(--accent);color:var(--ground)}
.flip>input:focus-visible+label{outline:2px solid var(--ink);outline-offset:1px}
.flip>.views{order:1;flex-basis:100%;display:none;gap:12px;grid-template-columns:1fr 1fr}
.flip>input:checked+label+.views{display:grid}
.scroll+.note{margin-top:12px}
.half{max-width:560px}
.flip+.note{margin-top:12px}
.scroll>svg{display:block;width:100%;min-width:680px;height:auto}
.sheet{display:grid;gap:12px 10px;overflow-x:auto;margin-top:16px}
dl{display:grid;grid-template-columns:max-content 1fr;gap:4px 20px;font-size:14.5px;margin:14px 0 0}
dt{color:var(--soft)}dd{margin:0;overflow-wrap:anywhere}
code{font:13px/1.5 ui-monospace,"SF Mono",Menlo,"DejaVu Sans Mono",monospace;background:var(--tile);border-radius:6px;padding:2px 6px}
@media(max-width:720px){main{padding:26px 16px 48px}.pictures{grid-template-columns:repeat(2,minmax(0,1fr))}.flip>.views{grid-template-columns:1fr}h2{margin-top:40px}}
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

std::string plural(std::uint64_t count, const std::string& word) {
  return format_count(count) + " " + word + (count == 1 ? "" : "s");
}

std::string tile(const std::string& value, const std::string& label) {
  return fmt::format("<div><b>{}</b><span>{}</span></div>", escape_html(value), escape_html(label));
}

std::string figure(const std::string& caption, std::span<const std::uint8_t> png,
                   const std::string& attributes, const std::string& below) {
  const std::string safe = escape_html(caption);
  return fmt::format(
      "<figure><img alt=\"{}\"{}{} src=\"data:image/png;base64,{}\"/><figcaption>{}</figcaption>{}</figure>",
      safe, attributes.empty() ? "" : " ", attributes, base64(png), safe, below);
}

std::string html_page(const std::string& title, const std::string& content) {
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\"/><title>";
  page += escape_html(title) + "</title><style>";
  page += kPageStyle;
  page += "</style></head><body><main>\n";
  page += content;
  return page + "</main></body></html>\n";
}

}  // namespace pellucid
