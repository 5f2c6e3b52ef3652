// frame_error.cpp - one frame's wrong pixels and how far their colours are off.
#include "fragment_shader.h"

namespace pellucid {

FrameError frame_error(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
                       std::span<const std::uint32_t> ranks, const ShadingOptions& shading) {
  const metric::FragmentShader shader(mesh, camera, shading);
  FrameError error;
  std::vector<metric::ShadedFragment> shaded;
  const std::size_t pixels = std::size_t{fragments.width} * fragments.height;
  for (std::size_t p = 0; p < pixels; ++p) {
    const std::span<const Fragment> list = fragments.pixel(p);
    if (list.empty()) continue;
    ++error.foreground;
    // A pixel in order blends to the same colour by construction.
    if (pixel_in_order(list, ranks)) continue;
    ++error.incorrect;
    shader.shade(p, list, shaded);
    const Vec3d exact = shader.blend(shaded);
    metric::put_in_drawn_order(shaded, ranks);
    const Vec3d difference = exact - shader.blend(shaded);
    error.squared_error += dot(difference, difference);
  }
  return error;
}

}  // namespace pellucid
