// One frame's wrong pixels and how far their colours are off: see pellucid/shading.h.
#include <algorithm>
#include <cmath>

#include "pellucid/shading.h"

namespace pellucid {

bool pixel_in_order(std::span<const Fragment> fragments, std::span<const std::uint32_t> ranks) {
  // Every fragment must come after all that are nearer by more than a tie.
  std::size_t nearer = 0;            // of these, the count seen so far
  std::uint32_t highest_nearer = 0;  // and their highest rank, plus one
  for (const Fragment& fragment : fragments) {
    const std::uint32_t rank = ranks[fragment.node];
    if (rank == kNoRank) return false;
    for (; fragment.depth - fragments[nearer].depth > kDepthTie; ++nearer) {
      highest_nearer = std::max(highest_nearer, ranks[fragments[nearer].node] + 1);
    }
    if (rank + 1 < highest_nearer) return false;
  }
  return true;
}

bool pixel_is_verified(std::span<const Fragment> fragments, std::span<const std::uint32_t> ranks) {
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const std::uint32_t rank = ranks[fragments[i].node];
    if (rank == kNoRank) return false;
    if (i == 0) continue;
    if (fragments[i].depth <= fragments[i - 1].depth || rank < ranks[fragments[i - 1].node]) return false;
  }
  return true;
}

PixelCount count_incorrect_pixels(const FragmentBuffer& fragments, std::span<const std::uint32_t> ranks) {
  PixelCount count;
  const std::uint64_t pixels = std::uint64_t{fragments.width} * fragments.height;
  for (std::uint64_t p = 0; p < pixels; ++p) {
    const std::span<const Fragment> pixel = fragments.pixel(p);
    if (pixel.empty()) continue;
    ++count.foreground;
    if (pixel_is_verified(pixel, ranks)) continue;
    ++count.repaired;
    if (!pixel_in_order(pixel, ranks)) ++count.incorrect;
  }
  return count;
}

double FrameError::psnr() const {
  if (squared_error <= 0) return kPerfectPsnr;
  const double mean = squared_error / (3 * static_cast<double>(foreground));
  return std::min(kPerfectPsnr, -10 * std::log10(mean));
}

FrameError frame_error(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
                       std::span<const std::uint32_t> ranks, const ShadingOptions& shading) {
  const FragmentShader shader(mesh, camera, shading);
  FrameError error;
  std::vector<ShadedFragment> shaded;
  const std::size_t pixels = std::size_t{fragments.width} * fragments.height;
  for (std::size_t p = 0; p < pixels; ++p) {
    const std::span<const Fragment> list = fragments.pixel(p);
    if (list.empty()) continue;
    ++error.foreground;
    if (pixel_is_verified(list, ranks)) continue;
    ++error.repaired;
    // A pixel in order blends to the same colour by construction.
    if (pixel_in_order(list, ranks)) continue;
    ++error.incorrect;
    shader.shade(p, list, shaded);
    const Vec3d exact = shader.blend(shaded);
    put_in_drawn_order(shaded, ranks);
    const Vec3d difference = exact - shader.blend(shaded);
    error.squared_error += dot(difference, difference);
  }
  return error;
}

}  // namespace pellucid
