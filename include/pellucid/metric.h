// pellucid/metric.h - module `metric`: how good an order is, by numbers and pictures.
//
// Vertex cache: ACMR, ATVR. Overdraw: OVR. Transparency: IPR and PSNR of an order set against exact depth
// order (In-Depth Buffers, section 7), over random viewpoints. Truth comes from the module `raster`.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/mesh.h"
#include "pellucid/raster.h"
#include "pellucid/sequencing.h"
#include "pellucid/shading.h"
#include "pellucid/view.h"

namespace pellucid {

// --------------------------------------------------------------------------------------------- overdraw

struct OverdrawStatistics {
  std::uint64_t covered = 0;  // pixels
  std::uint64_t shaded = 0;   // fragments that pass a strict (less) depth test in drawing order
  double overdraw = 0;        // shaded / covered, >= 1; 0 for nothing covered
};
// Front faces only, counted over all `viewpoints` (pooled), each drawn in the sequence that `choose` names.
OverdrawStatistics measure_overdraw(const Mesh& mesh, std::span<const Viewpoint> viewpoints,
                                    std::uint32_t size,
                                    const std::function<std::span<const NodeId>(const Viewpoint&)>& choose);

// ------------------------------------------------------------------------- pictures of a translucent mesh

// How fragments are put in order before blending.
//   exact   by depth
//   ranks   by position in a sequence (fragments of nodes without a rank are missing)
// Returns the picture of the fragments of one frame.
Image shade_exact(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
                  const ShadingOptions& options);
Image shade_ordered(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
                    std::span<const std::uint32_t> ranks, const ShadingOptions& options);
// The picture of the order errors (figures 3 and 6 of the paper): wrong pixels red over a pale silhouette.
Image error_image(const FragmentBuffer& fragments, std::span<const std::uint32_t> ranks);

// ----------------------------------------------------------------------------------- order correctness

// One way of drawing the mesh, to be measured: ranks of all nodes for a viewpoint.
struct DrawingMethod {
  std::string name;  // "budget", "acyclic", "original", "centroid_sort", "cache_optimized", ...
  // Ranks (see ranks_of) for this viewpoint; called from several threads.
  std::function<std::vector<std::uint32_t>(const Viewpoint&)> ranks;
};

struct DistanceError {
  double distance = 0;  // upper end of the bin, bounding radii
  double ipr = 0;
  double psnr = 0;
};

struct MethodQuality {
  std::string name;
  double ipr_mean = 0, ipr_max = 0;    // mean and worst over the viewpoints
  double psnr_mean = 0, psnr_min = 0;  // dB over foreground pixels, frames without error count as 100 dB
  std::vector<DistanceError> by_distance;
  std::vector<FrameError> frames;  // one per viewpoint, in their order
};

struct MeasureOptions {
  std::uint32_t viewpoints = 900;
  double min_distance = 2, max_distance = 5;  // bounding radii
  std::uint32_t size = 1024;                  // pixels per side
  std::uint64_t seed = 20180501;              // held out: never the seed of anything that trains
  Facing facing = Facing::duplicated;
  ShadingOptions shading;
  Progress* progress = nullptr;
};
// All methods over the same frames: every frame is rasterised once. O(viewpoints * (raster + methods)).
std::vector<MethodQuality> measure_order_quality(const Mesh& mesh, std::span<const DrawingMethod> methods,
                                                 const MeasureOptions& options);

// ------------------------------------------------------------------------- overdraw of animated meshes

struct OverdrawSubject {
  std::vector<Triangle> triangles;
  // Draw calls: the triangles of a part are drawn one after the other, with nothing of another part between
  // them. The first triangle of every part, ascending from 0.
  std::vector<std::uint32_t> parts{0};
  // By triangle: its back is drawn, too. Empty: back faces are culled.
  std::vector<std::uint8_t> double_sided;
  // Vertex positions of every pose, all of one size. A static mesh has one.
  std::vector<std::vector<Vec3f>> frames;
};

// Of every frame, round the vertices that triangles use.
std::vector<BoundingSphere> pose_spheres(const OverdrawSubject& subject);

// Misses per triangle when each of the orders is drawn by itself, mean.
double acmr_of(const OverdrawSubject& subject, const std::vector<std::vector<std::uint32_t>>& sequences,
               std::uint32_t cache_size);

// One way of drawing the subject: where every triangle stands in the sequence that draws a pose from a
// viewpoint. Called from several threads at once.
struct OverdrawContender {
  std::string name;
  std::function<std::span<const std::uint32_t>(std::uint32_t frame, const Viewpoint& viewpoint)> ranks;
};

struct OverdrawQuality {
  std::string name;
  double mean = 0, max = 0;      // over the pictures that anything was seen in
  std::vector<double> by_frame;  // mean over its pictures; 0 where nothing was seen
};

struct OverdrawMeasurement {
  // Held out: never the seed of anything that trains. Viewpoints within three radii, as in the paper.
  std::uint32_t viewpoints = 300;
  double min_distance = 1.5, max_distance = 3;
  std::uint64_t seed = 20170928;
  std::uint32_t size = 256;
  // Pictures in all: where frames x viewpoints are more, every frame is seen from some of the viewpoints, and
  // every viewpoint sees some of the frames. 0: all.
  std::uint64_t most_pictures = 0;
  Progress* progress = nullptr;
};
// All contenders on the same pictures, fragment by fragment: it knows nothing of patches, and so checks what
// order_overdraw() counts.
std::vector<OverdrawQuality> measure_posed_overdraw(const OverdrawSubject& subject,
                                                    std::span<const OverdrawContender> contenders,
                                                    const OverdrawMeasurement& options);

// Fragments of one pixel, sorted by depth, that pass a strict depth test when drawn by rank_of(fragment): of
// those at one depth only the first drawn can. Fragments of the greatest rank are not drawn.
template <class RankOf>
std::uint32_t count_shaded(std::span<const Fragment> fragments, const RankOf& rank_of) {
  constexpr std::uint32_t kNotDrawn = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t shaded = 0;
  std::uint32_t first = kNotDrawn;  // least rank of everything nearer
  for (std::size_t i = 0; i < fragments.size();) {
    const float depth = fragments[i].depth;
    std::uint32_t rank = kNotDrawn;
    for (; i < fragments.size() && fragments[i].depth == depth; ++i)
      rank = std::min(rank, rank_of(fragments[i]));
    if (rank >= first) continue;
    first = rank;
    ++shaded;
  }
  return shaded;
}

// Fragments shaded at every pixel of one picture, size x size, upper row first.
std::vector<std::uint32_t> shaded_fragments(const OverdrawSubject& subject, std::uint32_t frame,
                                            const Viewpoint& viewpoint, std::uint32_t size,
                                            std::span<const std::uint32_t> ranks);

// ranks[triangle] = its place in the sequence.
std::vector<std::uint32_t> triangle_ranks(std::span<const std::uint32_t> sequence);

// ------------------------------------------------------------------------------- differences of two images

// Of sRGB colours, 0..1, without rounding to 8 bits.
struct ImageError {
  double psnr = 100;            // dB over covered pixels; 100 at most
  double largest = 0;           // difference of a channel
  std::uint64_t differing = 0;  // pixels that differ by more than 1/255 in a channel
};
// Linear colours of two pictures of the same size. Pixels that nothing covers are background in both.
ImageError image_error(std::span<const Vec3f> exact, std::span<const Vec3f> drawn,
                       std::uint64_t covered_pixels);

// What the eye notices, over covered pixels: both are sums over the picture by their number.
struct PerceivedError {
  // Mean structural similarity (Wang, Bovik, Sheikh, Simoncelli, IEEE TIP 2004) of sRGB luma, window of
  // Gaussian weights, sigma 1.5, 11 x 11 pixels; 1: equal.
  double ssim = 1;
  // The colour part of FLIP (Andersson et al., HPG 2020) in its simplest form: mean HyAB distance in CIELAB,
  // the sum of the difference in lightness and the Euclidean one in hue and chroma, after a Gaussian, sigma 1
  // pixel, in linear light in place of its filters; no edges. 0: equal; 100: black and white.
  double hyab = 0;
};
PerceivedError perceived_error(std::span<const Vec3f> exact, std::span<const Vec3f> drawn,
                               std::uint32_t width, std::uint32_t height, std::uint64_t covered_pixels);

// How much more a sequence of pictures changes than the exact one: the change of the error from picture to
// picture, |(A' - A) - (E' - E)|, mean over covered pixels, channels and steps; in 1/255 of a channel, sRGB.
class Flicker {
 public:
  // The next picture, and what it would be; linear colours. `covered_pixels` of the exact one.
  void add(std::span<const Vec3f> exact, std::span<const Vec3f> drawn, std::uint64_t covered_pixels);
  [[nodiscard]] std::optional<double> mean() const;  // none: fewer than two pictures

 private:
  std::vector<float> error_;  // of the last picture
  double sum_ = 0;
  std::uint64_t steps_ = 0;
};

// White where two pictures agree, from pale to dark red where they do not.
Image difference_image(const Image& exact, const Image& drawn);

}  // namespace pellucid
