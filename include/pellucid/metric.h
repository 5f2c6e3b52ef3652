// pellucid/metric.h - module `metric`: measures how good an order is, in numbers and in images.
//
// In: a mesh, viewpoints, and for each viewpoint the ranks of an order. Out: image errors (IPR, PSNR) against
// the exact depth order, overdraw (OVR), differences of images, and images that show them. The exact order
// comes from the module `raster`. Vertex cache statistics (ACMR, ATVR) are in pellucid/sequencing.h. Based
// on: Han, Chen, Nehab, Sander, "In-Depth Buffers", PACMCGIT 1(1), 2018, section 7.
//
// IPR is the share of incorrect pixels: of the covered pixels, those whose fragments are drawn in a wrong
// order. OVR is the number of fragments that pass the depth test, divided by the number of covered pixels.
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

// ------------------------------------------------------------------------------------- order correctness

// A way of drawing a mesh that is to be measured.
struct DrawingMethod {
  std::string name;  // "budget", "acyclic", "original", "centroid_sort", "cache_optimized", ...
  // Returns the ranks of all nodes (see ranks_of) for a viewpoint. Called from several threads.
  std::function<std::vector<std::uint32_t>(const Viewpoint&)> ranks;
};

// Mean errors over the viewpoints in one range of distances.
struct DistanceError {
  double distance = 0;  // upper end of the range, bounding radii
  double ipr = 0;
  double psnr = 0;  // dB
};

// The errors of one method.
struct MethodQuality {
  std::string name;
  double ipr_mean = 0, ipr_max = 0;    // mean and worst over the viewpoints
  double psnr_mean = 0, psnr_min = 0;  // dB over covered pixels; frames without an error count as 100 dB
  std::vector<DistanceError> by_distance;
  std::vector<FrameError> frames;  // one per viewpoint, in their order
};

// The random viewpoints that orders are measured on, and the size of their images.
struct MeasuredViews {
  std::uint32_t viewpoints = 900;
  double min_distance = 2, max_distance = 5;  // bounding radii
  std::uint32_t size = 1024;                  // pixels per side
  std::uint64_t seed = 20180501;              // must differ from the seeds that orders are made with
};

// What measure_order_quality() measures, and how.
struct MeasureOptions : MeasuredViews {
  Facing facing = Facing::duplicated;
  ShadingOptions shading;
  Progress* progress = nullptr;  // may be null
};
// Measures all methods on the same frames; every frame is rasterised once. Takes O(viewpoints * (raster +
// methods)). Throws Error{bad_argument} for distances that random_viewpoints() refuses.
std::vector<MethodQuality> measure_order_quality(const Mesh& mesh, std::span<const DrawingMethod> methods,
                                                 const MeasureOptions& options);

// -------------------------------------------------------------------------- images of a translucent mesh

// Returns the image of a frame whose fragments are blended by depth.
Image shade_exact(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
                  const ShadingOptions& options);
// Returns the image of a frame whose fragments are blended by rank. Fragments of nodes without a rank are
// left out.
Image shade_ordered(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
                    std::span<const std::uint32_t> ranks, const ShadingOptions& options);
// Returns an image that shows where the order is wrong: these pixels are red, over a pale silhouette of the
// mesh (as in figures 3 and 6 of the paper).
Image error_image(const FragmentBuffer& fragments, std::span<const std::uint32_t> ranks);

// ----------------------------------------------------------------------------- overdraw of static meshes

struct OverdrawStatistics {
  std::uint64_t covered = 0;  // pixels
  std::uint64_t shaded = 0;   // fragments that pass a strict ("less") depth test in draw order
  double overdraw = 0;        // shaded / covered, >= 1; 0 if no pixel is covered
};
// Counts the fragments of front faces, summed over all `viewpoints`, in images of size x size pixels.
// `choose` returns the order that is drawn from a viewpoint.
OverdrawStatistics measure_overdraw(const Mesh& mesh, std::span<const Viewpoint> viewpoints,
                                    std::uint32_t size,
                                    const std::function<std::span<const NodeId>(const Viewpoint&)>& choose);

// --------------------------------------------------------------------------- overdraw of animated meshes

// An opaque mesh in one or more poses.
struct OverdrawSubject {
  std::vector<Triangle> triangles;
  // The first triangle of every part, ascending from 0. A part is a draw call: its triangles are drawn one
  // after another, with no triangle of another part between them.
  std::vector<std::uint32_t> parts{0};
  // By triangle: 1 if its back face is drawn, too. Empty: back faces are culled.
  std::vector<std::uint8_t> double_sided;
  // The vertex positions of every pose; all poses have the same vertices. A static mesh has one pose.
  std::vector<std::vector<Vec3f>> frames;
};

// Returns the bounding sphere of every pose, around the vertices that triangles use.
std::vector<BoundingSphere> pose_spheres(const OverdrawSubject& subject);

// Returns the mean number of cache misses per triangle over the orders, each drawn by itself.
double acmr_of(const OverdrawSubject& subject, const std::vector<std::vector<std::uint32_t>>& orders,
               std::uint32_t cache_size);

// A way of drawing the poses of a subject that is to be measured.
struct PosedDrawingMethod {
  std::string name;
  // Returns the rank of every triangle in the order that draws a pose from a viewpoint. Called from several
  // threads. The ranks must stay valid until the measurement is over.
  std::function<std::span<const std::uint32_t>(std::uint32_t frame, const Viewpoint& viewpoint)> ranks;
};

// The overdraw of one method.
struct OverdrawQuality {
  std::string name;
  double mean = 0, max = 0;      // over the images that have covered pixels
  std::vector<double> by_frame;  // mean over the images of a pose; 0 if none has covered pixels
};

struct PosedOverdrawOptions {
  std::uint32_t viewpoints = 300;
  double min_distance = 1.5, max_distance = 3;  // bounding radii; at most 3, as in the paper
  std::uint64_t seed = 20170928;                // must differ from the seeds that orders are made with
  std::uint32_t size = 256;                     // pixels per side
  // The largest number of images. If poses x viewpoints is more, every pose is seen from some of the
  // viewpoints, and every viewpoint sees some of the poses. 0: no limit.
  std::uint64_t most_images = 0;
  Progress* progress = nullptr;
};
// Measures all methods on the same images, fragment by fragment. It does not use patches, so it is an
// independent check of the counts of order_overdraw().
std::vector<OverdrawQuality> measure_posed_overdraw(const OverdrawSubject& subject,
                                                    std::span<const PosedDrawingMethod> methods,
                                                    const PosedOverdrawOptions& options);

// Counts the fragments of one pixel that pass a strict depth test when they are drawn in the order of
// rank_of(fragment). `fragments` are sorted by depth. Of fragments at the same depth only the first drawn one
// can pass. Fragments of the greatest rank are not drawn.
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

// Returns the number of fragments that pass the depth test at every pixel of one image: size x size, upper
// row first.
std::vector<std::uint32_t> shaded_fragments(const OverdrawSubject& subject, std::uint32_t frame,
                                            const Viewpoint& viewpoint, std::uint32_t size,
                                            std::span<const std::uint32_t> ranks);

// Returns ranks[triangle], the position of each triangle in `order`.
std::vector<std::uint32_t> triangle_ranks(std::span<const std::uint32_t> order);

// ------------------------------------------------------------------------------- differences of two images

// Measured on sRGB colours, 0..1, that are not rounded to 8 bits.
struct ImageError {
  double psnr = 100;            // dB over covered pixels; at most 100
  double largest = 0;           // difference of a channel
  std::uint64_t differing = 0;  // pixels that differ by more than 1/255 in a channel
};
// Compares the linear colours of two images of the same size. Pixels that nothing covers are background in
// both.
ImageError image_error(std::span<const Vec3f> exact, std::span<const Vec3f> drawn,
                       std::uint64_t covered_pixels);

// The error as the eye perceives it. Both members are sums over the image, divided by the number of covered
// pixels.
struct PerceivedError {
  // Mean structural similarity (Wang, Bovik, Sheikh, Simoncelli, IEEE TIP 2004) of sRGB luma, with a Gaussian
  // window of sigma 1.5 and 11 x 11 pixels. 1: equal.
  double ssim = 1;
  // The colour part of FLIP (Andersson et al., HPG 2020) in its simplest form: the mean HyAB distance in
  // CIELAB, which is the sum of the difference in lightness and the Euclidean one in hue and chroma. A
  // Gaussian of sigma 1 pixel in linear light replaces FLIP's filters; edges are not measured. 0: equal; 100:
  // black and white.
  double hyab = 0;
};
// Compares the linear colours of two images of the same size.
PerceivedError perceived_error(std::span<const Vec3f> exact, std::span<const Vec3f> drawn,
                               std::uint32_t width, std::uint32_t height, std::uint64_t covered_pixels);

// Measures how much the error changes from one image of a series to the next: |(A' - A) - (E' - E)|, mean
// over covered pixels, channels and steps, in 1/255 of an sRGB channel.
class Flicker {
 public:
  // Adds the next image and its exact version, in linear colours. `covered_pixels`: of the exact one.
  void add(std::span<const Vec3f> exact, std::span<const Vec3f> drawn, std::uint64_t covered_pixels);
  [[nodiscard]] std::optional<double> mean() const;  // none for fewer than two images

 private:
  std::vector<float> error_;  // of the last image
  double sum_ = 0;
  std::uint64_t steps_ = 0;
};

// Returns an image that is white where two images agree, and pale to dark red where they differ.
Image difference_image(const Image& exact, const Image& drawn);

}  // namespace pellucid
