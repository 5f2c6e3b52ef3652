// Implements deep_pixels.h: all fragments of an image.
#include "deep_pixels.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "pellucid/report.h"

namespace pellucid::cli {
namespace {

struct Pixel {
  std::uint32_t x = 0, y = 0;
};

bool read_whole(std::string_view text, std::uint32_t& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

Pixel parse_pixel(const std::string& text, const CaptureJob& job) {
  Pixel pixel;
  const std::size_t comma = std::min(text.find(','), text.size());
  const bool read = read_whole(std::string_view(text).substr(0, comma), pixel.x) && comma < text.size() &&
                    read_whole(std::string_view(text).substr(comma + 1), pixel.y);
  if (!read || pixel.x >= job.width || pixel.y >= job.height) {
    throw Error(ErrorKind::bad_argument,
                fmt::format("--pixel: '{}' is not X,Y of a pixel of {}x{}, counted from the upper left", text,
                            job.width, job.height));
  }
  return pixel;
}

bool is_back(const DeepFragment& f) {
  return (f.node & 1U) != 0;
}

bool delivers_all(const std::string& technique) {
  if (technique == "cpu") return true;
  const auto infos = render_techniques();
  // Names that do not exist are reported elsewhere.
  return std::none_of(infos.begin(), infos.end(), [&](const TechniqueInfo& info) {
    return info.name == technique && (!info.exact || info.blends_only);
  });
}

}  // namespace

void check_deep(const CaptureJob& job) {
  if (!job.deep.empty() && !can_write_deep_exr()) {
    throw Error(ErrorKind::bad_argument,
                "--deep: this build of pellucid cannot write OpenEXR (PELLUCID_OPENEXR is off)");
  }
  if (!delivers_all(job.options.technique)) {
    throw Error(ErrorKind::bad_argument,
                fmt::format("--deep and --pixel need all fragments, which --technique {} does not deliver: "
                            "take cpu, sb or another exact one",
                            job.options.technique));
  }
  if (job.options.samples != 1)
    throw Error(ErrorKind::bad_argument, "--deep and --pixel: one sample a pixel");
  for (const std::string& pixel : job.pixels) parse_pixel(pixel, job);
}

RenderOptions deep_options(const RenderOptions& options) {
  RenderOptions deep = options;
  deep.effect = Effect::complexity;
  deep.keep_fragments = true;
  deep.pool.overflow = Overflow::exact;
  return deep;
}

std::string pixel_tables(const CaptureJob& job, const DeepImage& deep) {
  std::string text;
  for (const std::string& name : job.pixels) {
    const Pixel pixel = parse_pixel(name, job);
    const auto fragments = deep.at(pixel.x, pixel.y);
    text += fmt::format("pixel {},{}: {} fragments\n", pixel.x, pixel.y, format_count(fragments.size()));
    if (fragments.empty()) continue;
    text += "  distance    depth       object  triangle  side   colour (linear)      opacity\n";
    for (const DeepFragment& f : fragments) {
      text += fmt::format("  {:<10.5g}  {:<10.8f}  {:<6}  {:<8}  {:<5}  {:.3f} {:.3f} {:.3f}    {:.3f}\n",
                          f.distance, f.depth, f.object, triangle_of(f.node), is_back(f) ? "back" : "front",
                          f.color[0], f.color[1], f.color[2], f.color[3]);
    }
  }
  return text;
}

nlohmann::ordered_json pixels_json(const CaptureJob& job, const DeepImage& deep) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const std::string& name : job.pixels) {
    const Pixel pixel = parse_pixel(name, job);
    nlohmann::ordered_json fragments = nlohmann::ordered_json::array();
    for (const DeepFragment& f : deep.at(pixel.x, pixel.y)) {
      fragments.push_back({{"distance", f.distance},
                           {"depth", f.depth},
                           {"object", f.object},
                           {"triangle", triangle_of(f.node)},
                           {"back", is_back(f)},
                           {"color", f.color}});
    }
    list.push_back({{"x", pixel.x}, {"y", pixel.y}, {"fragments", std::move(fragments)}});
  }
  return list;
}

}  // namespace pellucid::cli
