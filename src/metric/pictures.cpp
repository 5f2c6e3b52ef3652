// pictures.cpp - frames drawn in exact order, in a given order, and where the two differ in order.

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "pellucid/metric.h"

namespace pellucid {
namespace {

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

void put(Image& image, std::size_t pixel, const Vec3d& srgb) {
  image.rgb[3 * pixel] = to_byte(srgb.x);
  image.rgb[3 * pixel + 1] = to_byte(srgb.y);
  image.rgb[3 * pixel + 2] = to_byte(srgb.z);
}

Image blank(const FragmentBuffer& fragments) {
  return {fragments.width, fragments.height,
          std::vector<std::uint8_t>(3UL * fragments.width * fragments.height)};
}

// `arrange` gives a pixel's fragments in the sequence in which they are blended; called row by row in
// parallel.
template <class Arrange>
Image shade(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
            const ShadingOptions& options, const Arrange& arrange) {
  const FragmentShader shader(mesh, camera, options);
  const Vec3d background = shader.background();
  Image image = blank(fragments);
  parallel_loop(std::uint32_t{0}, fragments.height, [&](std::uint32_t y) {
    std::vector<ShadedFragment> shaded;
    for (std::uint32_t x = 0; x < fragments.width; ++x) {
      const std::size_t p = std::size_t{y} * fragments.width + x;
      const std::span<const Fragment> list = fragments.pixel(p);
      if (list.empty()) {
        put(image, p, background);
        continue;
      }
      shader.shade(p, list, shaded);
      arrange(shaded);
      put(image, p, shader.blend(shaded));
    }
  });
  return image;
}

constexpr double kNoDepth = std::numeric_limits<double>::infinity();

// Depth of a pixel's nearest fragment.
double front_depth(const FragmentBuffer& fragments, std::uint32_t x, std::uint32_t y) {
  const std::span<const Fragment> list = fragments.pixel(std::size_t{y} * fragments.width + x);
  return list.empty() ? kNoDepth : double{list.front().depth};
}

// Where the outermost surface jumps in depth by more than this share of the depth range, a line is drawn.
constexpr double kOutlineJump = 0.02;

}  // namespace

Image shade_exact(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
                  const ShadingOptions& options) {
  return shade(mesh, camera, fragments, options, [](const std::vector<ShadedFragment>&) {});
}

Image shade_ordered(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
                    std::span<const std::uint32_t> ranks, const ShadingOptions& options) {
  return shade(mesh, camera, fragments, options,
               [ranks](std::vector<ShadedFragment>& list) { put_in_drawn_order(list, ranks); });
}

Image error_image(const FragmentBuffer& fragments, std::span<const std::uint32_t> ranks) {
  double nearest = kNoDepth;
  double farthest = 0;
  for (std::uint32_t y = 0; y < fragments.height; ++y) {
    for (std::uint32_t x = 0; x < fragments.width; ++x) {
      const double depth = front_depth(fragments, x, y);
      nearest = std::min(nearest, depth);
      if (depth < kNoDepth) farthest = std::max(farthest, depth);
    }
  }
  const double range = std::max(farthest - nearest, 1e-6);

  Image image = blank(fragments);
  for (std::uint32_t y = 0; y < fragments.height; ++y) {
    for (std::uint32_t x = 0; x < fragments.width; ++x) {
      const std::size_t p = std::size_t{y} * fragments.width + x;
      const double depth = front_depth(fragments, x, y);
      if (depth == kNoDepth) {
        put(image, p, {1, 1, 1});
      } else if (!pixel_in_order(fragments.pixel(p), ranks)) {
        put(image, p, {0.9, 0.05, 0.05});
      } else {
        // Paler with distance, an outline where depth jumps.
        const double left = x > 0 ? front_depth(fragments, x - 1, y) : kNoDepth;
        const double above = y > 0 ? front_depth(fragments, x, y - 1) : kNoDepth;
        const bool outline = std::max(std::abs(left - depth), std::abs(above - depth)) > kOutlineJump * range;
        const double grey = 0.80 + 0.14 * (depth - nearest) / range - (outline ? 0.12 : 0.0);
        put(image, p, {grey, grey, grey});
      }
    }
  }
  return image;
}

}  // namespace pellucid
