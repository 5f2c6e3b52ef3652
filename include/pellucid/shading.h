// pellucid/shading.h - module `metric`, second header: what a pixel's fragments look like and blend to, and
// how far a frame in a wrong order is off.
//
// The two shaders of In-Depth Buffers, section 7 and figure 4: a translucent surface lit per pixel, and depth
// turned into colour. Orders may be steered by these pictures (OrderOptions::min_psnr), and the module
// `metric` judges by them: the same code, the same figures. Colours are linear until a pixel is finished.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/raster.h"
#include "pellucid/sequencing.h"

namespace pellucid {

// How a fragment looks: per-pixel lighting of a translucent surface, or the smoother depth-to-colour ramp in
// which order errors show best.
enum class Shading { lit, depth };

// Linear RGB, and the opacity of a sheet seen head-on.
struct SurfaceLook {
  Vec3f color{0.09F, 0.34F, 0.68F};
  double alpha = 0.5;
};

struct ShadingOptions {
  Shading shading = Shading::lit;
  double alpha = 0.5;
  Vec3f color{0.09F, 0.34F, 0.68F};  // linear RGB of the surface
  Vec3f background{1, 1, 1};
  // Surfaces that differ, with Shading::lit: the look of every triangle, an index into `looks`. Empty: all
  // have the colour and alpha above.
  std::vector<SurfaceLook> looks{};
  std::vector<std::uint32_t> triangle_looks{};
};

// A fragment with its linear colour and opacity, not premultiplied.
struct ShadedFragment {
  Vec3d color;
  double alpha;
  NodeId node;
};

class FragmentShader {
 public:
  // Keeps references to the mesh; computes vertex normals where it has none.
  FragmentShader(const Mesh& mesh, const Camera& camera, const ShadingOptions& options);

  // Replace `shaded` by a pixel's fragments, in their order.
  void shade(std::uint64_t pixel, std::span<const Fragment> fragments,
             std::vector<ShadedFragment>& shaded) const;
  // The same, lit, with looks that differ from place to place: one for each fragment.
  void shade(std::uint64_t pixel, std::span<const Fragment> fragments, std::span<const SurfaceLook> looks,
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
  [[nodiscard]] ShadedFragment shade_lit(const Ray& ray, NodeId node, const Vec3f& color,
                                         double log2_transmittance) const;
  [[nodiscard]] ShadedFragment shade_depth(const Fragment& fragment) const;
  // Interpolated where the ray meets the triangle, unit length, on the side that the node shows.
  [[nodiscard]] Vec3d normal_at(const Ray& ray, NodeId node) const;

  const Mesh& mesh_;
  Camera camera_;
  ShadingOptions options_;
  std::vector<Vec3f> computed_normals_;
  std::span<const Vec3f> normals_;
  Vec3d fill_light_;
  std::vector<double> log2_transmittances_;  // of every look, seen head-on
  std::array<Vec3d, 5> ramp_;
};

double srgb_from_linear(double linear);
double linear_from_srgb(double encoded);

// Put a pixel's fragments in drawing order; those without a rank are taken out.
void put_in_drawn_order(std::vector<ShadedFragment>& fragments, std::span<const std::uint32_t> ranks);

// Is the drawing order of one pixel's fragments (sorted by depth) right? Wrong: a fragment's node has no
// rank, or a nearer fragment comes later. Fragments whose depths differ by no more than kDepthTie count as
// coincident: they may come in either order.
constexpr float kDepthTie = 1e-6F;  // of the 0..1 depth range
bool pixel_in_order(std::span<const Fragment> fragments, std::span<const std::uint32_t> ranks);

// Does verified blending (render.h) leave it as it is? Each fragment has to be drawn after all that are
// nearer, and none may lie at the depth of another one.
bool pixel_is_verified(std::span<const Fragment> fragments, std::span<const std::uint32_t> ranks);

struct PixelCount {
  std::uint64_t foreground = 0;  // pixels with at least one fragment
  std::uint64_t incorrect = 0;   // of these, pixels that are not in order: IPR = incorrect / foreground
  std::uint64_t repaired = 0;    // of these, pixels that are not verified
};
PixelCount count_incorrect_pixels(const FragmentBuffer& fragments, std::span<const std::uint32_t> ranks);

constexpr double kPerfectPsnr = 100;  // dB, for frames without any error

struct FrameError {
  std::uint64_t foreground = 0;  // pixels with at least one fragment
  std::uint64_t incorrect = 0;  // pixels whose drawing order contradicts depth order, or that miss a fragment
  std::uint64_t repaired = 0;   // pixels that verified blending would repair: pixel_is_verified()
  double squared_error = 0;     // summed over foreground pixels and the three channels, in [0,1] sRGB units
  [[nodiscard]] double ipr() const {
    return foreground == 0 ? 0 : static_cast<double>(incorrect) / static_cast<double>(foreground);
  }
  [[nodiscard]] double psnr() const;  // dB over foreground pixels, at most kPerfectPsnr
};
// Fragments of equal depth (within a few units in the last place of the fragment depth) may come in either
// order.
FrameError frame_error(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
                       std::span<const std::uint32_t> ranks, const ShadingOptions& shading);

}  // namespace pellucid
