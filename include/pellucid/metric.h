// pellucid/metric.h - module `metric`: how good an order is, by numbers and pictures.
//
// Vertex cache: ACMR, ATVR. Overdraw: OVR. Transparency: IPR and PSNR of an order set against exact depth
// order (In-Depth Buffers, section 7), over random viewpoints. Truth comes from the module `raster`.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/mesh.h"
#include "pellucid/order.h"
#include "pellucid/raster.h"
#include "pellucid/shading.h"
#include "pellucid/view.h"

namespace pellucid {

// ----------------------------------------------------------------------------------------- vertex cache

enum class CacheModel { fifo, lru };

struct CacheStatistics {
  std::uint64_t misses = 0;
  double acmr = 0;  // misses per triangle: best about 0.5 for single-sided lists (0.25 with twins), worst 3
  double atvr = 0;  // misses per distinct vertex used: best 1
};
// `indices`: three per triangle. cache_size >= 3.
CacheStatistics simulate_vertex_cache(std::span<const std::uint32_t> indices, std::uint32_t vertex_count,
                                      CacheModel model, std::uint32_t cache_size);

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

struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // 3 bytes a pixel, sRGB, upper row first
};

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

// Write an 8-bit RGB PNG through a temporary file. Throws Error{cannot_write}.
void write_png(const Image& image, const std::string& path);
// The same bytes in memory.
std::vector<std::uint8_t> encode_png(const Image& image);

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

}  // namespace pellucid
