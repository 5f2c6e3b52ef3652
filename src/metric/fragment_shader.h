// fragment_shader.h - colour and opacity of single fragments, and what a pixel's fragments blend to.
//
// The two shaders of In-Depth Buffers, section 7 and figure 4: a translucent surface lit per pixel, and depth
// turned into colour. Colours are linear until a pixel is finished.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pellucid/metric.h"

namespace pellucid::metric {

// Linear colour and opacity, not premultiplied.
struct Shaded {
  Vec3d color;
  double alpha;
};

class FragmentShader {
 public:
  // Keeps references to the mesh; computes vertex normals where it has none.
  FragmentShader(const Mesh& mesh, const Camera& camera, const ShadingOptions& options);

  // The fragments' colours put "over" each other and the background, the first one in front; sRGB, 0..1.
  [[nodiscard]] Vec3d blend(std::uint64_t pixel, std::span<const Fragment> front_to_back) const;
  // sRGB colour of a pixel without fragments.
  [[nodiscard]] Vec3d background() const;

 private:
  struct Ray {
    Vec3d origin, direction;
  };
  [[nodiscard]] Ray ray_through(std::uint64_t pixel) const;
  [[nodiscard]] Shaded shade_lit(const Ray& ray, std::uint32_t node) const;
  [[nodiscard]] Shaded shade_depth(float depth) const;
  // Interpolated where the ray meets the triangle, unit length, on the side that the node shows.
  [[nodiscard]] Vec3d normal_at(const Ray& ray, std::uint32_t node) const;

  const Mesh& mesh_;
  Camera camera_;
  ShadingOptions options_;
  std::vector<Vec3f> computed_normals_;
  std::span<const Vec3f> normals_;
  Vec3d fill_light_;
  std::array<Vec3d, 5> ramp_;
};

double srgb_from_linear(double linear);
double linear_from_srgb(double encoded);

// The drawn fragments of a pixel in drawing order (front-to-back buffers); those without a rank are left out.
std::span<const Fragment> drawn_order(std::span<const Fragment> by_depth,
                                      std::span<const std::uint32_t> ranks, std::vector<Fragment>& memory);

}  // namespace pellucid::metric
