// pellucid/overdraw.h - module `overdraw`: computes a few triangle orders that reduce overdraw, for all views
// and poses.
//
// In: an opaque mesh and its poses. Out: k orders of its patches, and a table that says which of them draws
// which key frame best from which direction. Every order draws the same image. Good orders draw visible
// triangles first, so that the depth test rejects the hidden fragments before they are shaded. A patch is a
// run of triangles that stay together.
//
// Based on: Han, Sander, "Triangle Reordering for Efficient Rendering in Complex Scenes", JCGT 6(3), 2017
// (OverdrawMethod::paper), and extends it (OverdrawMethod::refined, docs/overdraw.md).
//
// Overdraw (OVR) of an image is the number of shaded fragments divided by the number of covered pixels, with
// a strict depth test in draw order. 1 is the least. Excess overdraw is OVR - 1.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/mesh.h"
#include "pellucid/metric.h"
#include "pellucid/view.h"

namespace pellucid {

enum class OverdrawMethod {
  paper,    // Algorithm 1: patches by summed distance
  refined,  // patches by measured overdraw, cut where that reduces it
};

struct OverdrawOptions {
  OverdrawMethod method = OverdrawMethod::refined;
  std::uint32_t buffers = 5;  // orders, at most 256
  // Cuts the cache-friendly order into patches (section 3.1): a patch ends when its misses per triangle fall
  // below lambda. 3: every triangle is a patch.
  double lambda = 0.85;
  // refined: the largest number of misses per triangle of its orders. Unset: that of the paper's method with
  // this lambda.
  std::optional<double> acmr{};
  std::uint32_t cache_size = 16;  // FIFO entries
  std::uint32_t view_level = 2;   // viewpoints: the 10 * 4^n + 2 vertices of an icosphere, 162
  // The distances of these viewpoints are spread over this range, bounding radii.
  double min_distance = 1.5, max_distance = 3;
  std::uint32_t size = 256;  // pixels per side of the images that overdraw is counted in
  // The largest number of views that orders are made from. The other views get the order of the same
  // viewpoint in the key frames before and after if these agree, or else the cheapest order for them. 0: all
  // views.
  std::uint32_t most_training_views = 6000;
  // The largest number of layers that are stored for all training views together. If there are more, only a
  // random share of the pixels is stored. A layer takes at most 12 bytes.
  std::uint64_t most_layers = 6'000'000;
  // The largest number of views for which an order is chosen. If there are more, orders are chosen for some
  // of the key frames only, and every other key frame uses those of the nearest of these.
  std::uint64_t most_views = 30'000;
  std::uint64_t seed = 1;
  Progress* progress = nullptr;
};

// The wall time of the stages in seconds. `assign`: the choice of an order for the remaining views.
struct OverdrawSeconds {
  double patches = 0, raster = 0, cluster = 0, assign = 0, total = 0;
};

// What order_overdraw() did, and how good the orders are.
struct OverdrawRun {
  std::uint64_t patches = 0;
  std::uint64_t views = 0, training_views = 0;  // key frames x viewpoints
  std::uint64_t lists = 0;                      // distinct lists of the patches at a pixel, by depth
  std::uint32_t iterations = 0;                 // rounds of k-means
  double training_overdraw = 0;                 // mean over the training views
  double acmr = 0;                              // mean over the orders
  OverdrawSeconds seconds;
  std::uint64_t peak_rss_bytes = 0;
};

// Orders of a subject for all key frames and viewpoints.
struct OverdrawOrders {
  // All triangles, patch by patch: patch p is triangles sequence[patch_offsets[p] .. patch_offsets[p + 1]).
  // The patches in this order are the best single order for all views.
  std::vector<std::uint32_t> sequence;
  std::vector<std::uint32_t> patch_offsets;
  std::vector<std::uint32_t> patch_parts;          // part of every patch
  std::vector<std::vector<std::uint32_t>> orders;  // patches in draw order
  std::vector<BoundingSphere> spheres;             // of every frame; viewpoints are relative to it
  std::vector<std::uint32_t> cell_orders;          // frames x viewpoints (P[view_level]): index into orders
  OverdrawRun run;
};

// Orders the patches of a subject. Throws Error{nothing_to_do} without triangles or frames, and
// Error{bad_argument} for options that are out of range. Deterministic for any number of threads.
OverdrawOrders order_overdraw(const OverdrawSubject& subject, const OverdrawOptions& options);

// Returns the cheapest of these orders for every frame of `poses` and every viewpoint: frames x viewpoints.
// `poses` must have the triangles and parts that the orders were made for. Takes O(frames * viewpoints *
// raster).
std::vector<std::uint32_t> cheapest_orders(const OverdrawSubject& poses, const OverdrawOrders& orders,
                                           const OverdrawOptions& options);

// Returns the triangles of an order, in draw order.
std::vector<std::uint32_t> triangle_order(const OverdrawOrders& orders, std::uint32_t order);

// Returns an order that only uses the vertex cache well: the order by tipsify of every part (Sander, Nehab,
// Barczak, SIGGRAPH 2007). `cache_size` is the number of vertices in a FIFO cache.
std::vector<std::uint32_t> cache_order(const OverdrawSubject& subject, std::uint32_t cache_size);

// Returns the overdraw order of Sander et al. 2007 for one pose, which does not depend on views: `cached` (a
// cache_order()) is cut into patches with `lambda`, and patches that lie outside and face outwards come
// first. The paper applies it to every frame by itself ("tipsify").
std::vector<std::uint32_t> static_overdraw_order(const OverdrawSubject& subject, std::uint32_t frame,
                                                 std::span<const std::uint32_t> cached, double lambda,
                                                 std::uint32_t cache_size);

}  // namespace pellucid
