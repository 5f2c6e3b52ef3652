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

// A fragment with its linear colour and opacity, not premultiplied.
struct ShadedFragment {
  Vec3d color;
  double alpha;
  std::uint32_t node;
};

class FragmentShader {
 public:
  // Keeps references to the mesh; computes vertex normals where it has none.
  FragmentShader(const Mesh& mesh, const Camera& camera, const ShadingOptions& options);

  // Replace `shaded` by a pixel's fragments, in their order.
  void shade(std::uint64_t pixel, std::span<const Fragment> fragments,
             std::vector<ShadedFragment>& shaded) const;
  // Colours put "over" each other and the background, the first one in front; sRGB, 0..1.
  [[nodiscard]] Vec3d blend(std::span<const ShadedFragment> front_to_back) const;
  // sRGB colour of a pixel without fragments.
  [[nodiscard]] Vec3d background() const;

 private:
  struct Ray {
    Vec3d origin, direction;
  };
  [[nodiscard]] Ray ray_through(std::uint64_t pixel) const;
  [[nodiscard]] ShadedFragment shade_lit(const Ray& ray, std::uint32_t node) const;
  [[nodiscard]] ShadedFragment shade_depth(const Fragment& fragment) const;
  // Interpolated where the ray meets the triangle, unit length, on the side that the node shows.
  [[nodiscard]] Vec3d normal_at(const Ray& ray, std::uint32_t node) const;

  const Mesh& mesh_;
  Camera camera_;
  ShadingOptions options_;
  std::vector<Vec3f> computed_normals_;
  std::span<const Vec3f> normals_;
  Vec3d fill_light_;
  double log2_transmittance_;  // of a sheet seen head-on
  std::array<Vec3d, 5> ramp_;
};

double srgb_from_linear(double linear);
double linear_from_srgb(double encoded);

// Put a pixel's fragments in drawing order; those without a rank are taken out.
void put_in_drawn_order(std::vector<ShadedFragment>& fragments, std::span<const std::uint32_t> ranks);

}  // namespace pellucid::metric
