// One frame's wrong pixels and how far their colours are off: see pellucid/shading.h.
#include <algorithm>
#include <cmath>

#include "pellucid/shading.h"

namespace pellucid {

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
