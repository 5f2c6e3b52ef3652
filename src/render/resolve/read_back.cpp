// Implements read_back.h: copies colours and fragments from the device into a RenderResult.
#include "render/resolve/read_back.h"

#include <array>
#include <bit>

namespace pellucid::render {
namespace {

// Unpacks a colour that shaders/frame.glsl packed.
std::array<float, 4> unpack_color(std::uint32_t packed) {
  const auto channel = [&](unsigned shift) { return static_cast<float>((packed >> shift) & 255U) / 255.0F; };
  const auto linear = [&](unsigned shift) { return 2 * channel(shift) * channel(shift); };
  return {linear(0), linear(8), linear(16), channel(24)};
}

}  // namespace

void read_colors(const Buffer& final_colors, const Frame& frame, RenderResult& result) {
  std::vector<std::array<float, 4>> values(frame.pixels());
  final_colors.download(frame.context, std::as_writable_bytes(std::span(values)));
  const std::uint32_t samples = frame.options.samples;
  for (std::size_t p = 0; p < values.size() / samples; ++p) {
    Vec3f sum{0, 0, 0};
    for (std::uint32_t s = 0; s < samples; ++s) {
      const std::array<float, 4>& value = values[frame.sample_at(p, s)];
      sum = sum + Vec3f{value[0], value[1], value[2]};
    }
    result.pixels.push_back(sum * (1.0F / static_cast<float>(samples)));
  }
}

void read_fragments(const Buffer& dump, const Frame& frame, const std::vector<std::uint32_t>& offsets,
                    bool colored, RenderResult& result) {
  std::vector<std::array<std::uint32_t, kDumpWords>> values(frame.fragments);
  dump.download(frame.context, std::as_writable_bytes(std::span(values)), 4 * offsets.size());
  CapturedFragments& out = result.fragments;
  if (out.offsets.empty()) out.offsets.push_back(0);
  const std::uint32_t samples = frame.options.samples;
  for (std::size_t n = 0; n + 1 < offsets.size(); ++n) {
    const std::uint64_t p = frame.sample_at(n / samples, static_cast<std::uint32_t>(n % samples));
    for (std::uint32_t i = offsets[p]; i < offsets[p + 1]; ++i) {
      // Entries that the technique left empty have the id 0.
      if (values[i][1] == 0) continue;
      out.fragments.push_back({std::bit_cast<float>(values[i][0]), values[i][1] - 2});
      if (colored) out.colors.push_back(unpack_color(values[i][2]));
    }
    out.offsets.push_back(out.fragments.size());
  }
}

}  // namespace pellucid::render
