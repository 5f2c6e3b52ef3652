// pellucid/shading.h - module `metric`: shades and blends the fragments of a pixel, and measures the error of
// a frame that is drawn in a wrong order.
//
// In: fragments of the module `raster`, and ranks. Out: colours, and counts of wrong pixels. There are two
// ways of shading (In-Depth Buffers, section 7 and figure 4): a translucent surface with lighting per pixel,
// and a ramp from depth to colour. Orders can be made for these images (OrderOptions::min_psnr), and the
// module `metric` measures with the same code. Colours are linear until a pixel is finished.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/raster.h"
#include "pellucid/sequencing.h"

namespace pellucid {

// How a fragment is shaded: with per-pixel lighting of a translucent surface, or with a smooth ramp from
// depth to colour, which shows order errors best.
enum class Shading { lit, depth };

// The look of a surface: linear RGB, and the opacity where it is seen head-on.
struct SurfaceLook {
  Vec3f color{0.09F, 0.34F, 0.68F};
  double alpha = 0.5;
  bool unlit = false;       // the colour is what is seen, and the opacity does not depend on the view
  Vec3f emissive{0, 0, 0};  // linear RGB that is added to what light makes
};

// How all fragments of an image are shaded.
struct ShadingOptions {
  Shading shading = Shading::lit;
  double alpha = 0.5;
  Vec3f color{0.09F, 0.34F, 0.68F};  // linear RGB of the surface
  Vec3f background{1, 1, 1};
  // With Shading::lit, surfaces can differ: `triangle_looks` holds an index into `looks` for every triangle.
  // Empty: all triangles have the colour and alpha above.
  std::vector<SurfaceLook> looks{};
  std::vector<std::uint32_t> triangle_looks{};
};

// A fragment with its linear colour and opacity, not premultiplied.
struct ShadedFragment {
  Vec3d color;
  double alpha;
  NodeId node;
};

// Computes the colours of fragments and blends them.
class FragmentShader {
 public:
  // Keeps a reference to the mesh. Computes vertex normals if the mesh has none.
  FragmentShader(const Mesh& mesh, const Camera& camera, const ShadingOptions& options);

  // Replaces `shaded` by the shaded fragments of a pixel, in the order of `fragments`.
  void shade(std::uint64_t pixel, std::span<const Fragment> fragments,
             std::vector<ShadedFragment>& shaded) const;
  // Does the same with Shading::lit and one look for each fragment.
  void shade(std::uint64_t pixel, std::span<const Fragment> fragments, std::span<const SurfaceLook> looks,
             std::vector<ShadedFragment>& shaded) const;
  // Blends the fragments and the background with the operator "over"; the first fragment is in front. Returns
  // sRGB, 0..1.
  [[nodiscard]] Vec3d blend(std::span<const ShadedFragment> front_to_back) const;
  // Returns the sRGB colour of a pixel without fragments.
  [[nodiscard]] Vec3d background() const;

 private:
  struct Ray {
    Vec3d origin, direction;
  };
  [[nodiscard]] Ray ray_through(std::uint64_t pixel) const;
  [[nodiscard]] ShadedFragment shade_lit(const Ray& ray, NodeId node, const SurfaceLook& look,
                                         double log2_transmittance) const;
  [[nodiscard]] ShadedFragment shade_depth(const Fragment& fragment) const;
  // Returns the unit normal, interpolated where the ray meets the triangle, on the side that the node shows.
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

// Convert between linear values and sRGB, both 0..1.
double srgb_from_linear(double linear);
double linear_from_srgb(double encoded);

// Sorts the fragments of a pixel by rank, and removes those without a rank.
void put_in_drawn_order(std::vector<ShadedFragment>& fragments, std::span<const std::uint32_t> ranks);

// Returns whether the fragments of one pixel (sorted by depth) are drawn in the right order. The order is
// wrong if the node of a fragment has no rank, or if a nearer fragment comes later. Fragments whose depths
// differ by at most kDepthTie count as coincident and may come in either order.
constexpr float kDepthTie = 1e-6F;  // of the 0..1 depth range
bool pixel_in_order(std::span<const Fragment> fragments, std::span<const std::uint32_t> ranks);

// Returns whether verified blending (render.h) leaves the pixel as it is: each fragment is drawn after all
// nearer ones, and no two fragments have the same depth.
bool pixel_is_verified(std::span<const Fragment> fragments, std::span<const std::uint32_t> ranks);

// The pixels of one frame.
struct PixelCount {
  std::uint64_t foreground = 0;  // pixels with at least one fragment
  std::uint64_t incorrect = 0;   // of these, pixels that are not in order: IPR = incorrect / foreground
  std::uint64_t repaired = 0;    // of these, pixels that are not verified
};
// Counts the pixels of a frame that is drawn in the order of `ranks`.
PixelCount count_incorrect_pixels(const FragmentBuffer& fragments, std::span<const std::uint32_t> ranks);

constexpr double kPerfectPsnr = 100;  // dB, for frames without any error

// The error of one frame.
struct FrameError {
  std::uint64_t foreground = 0;  // pixels with at least one fragment
  std::uint64_t incorrect = 0;   // pixels that are drawn in a wrong order, or that miss a fragment
  std::uint64_t repaired = 0;    // pixels that verified blending would repair: pixel_is_verified()
  double squared_error = 0;      // summed over foreground pixels and the three channels, in [0,1] sRGB units
  [[nodiscard]] double ipr() const {
    return foreground == 0 ? 0 : static_cast<double>(incorrect) / static_cast<double>(foreground);
  }
  [[nodiscard]] double psnr() const;  // dB over foreground pixels, at most kPerfectPsnr
};
// Measures the error of one frame: `fragments` drawn in the order of `ranks`, against the order by depth.
FrameError frame_error(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
                       std::span<const std::uint32_t> ranks, const ShadingOptions& shading);

}  // namespace pellucid
