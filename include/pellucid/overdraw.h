// pellucid/overdraw.h - module `overdraw`: a few triangle orders that reduce overdraw, for all views and
// poses.
//
// In: an opaque mesh and its poses. Out: k orders of its patches and the table that says which of them draws
// which key frame best from which direction. Every order draws the right picture; good ones draw what is
// visible first, so that the depth test rejects the rest before it is shaded.
// Follows: Han, Sander, "Triangle Reordering for Efficient Rendering in Complex Scenes", JCGT 6(3), 2017
// (OverdrawMethod::paper), and goes beyond it (OverdrawMethod::refined, docs/overdraw.md).
//
// Overdraw (OVR) of a picture: fragments shaded / pixels covered, with a strict depth test in drawing order.
// 1 is the least. Excess overdraw is OVR - 1.
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
  refined,  // patches by measured overdraw, cut where it pays
};

struct OverdrawOptions {
  OverdrawMethod method = OverdrawMethod::refined;
  std::uint32_t buffers = 5;
  // Cuts the cache-friendly order into patches (section 3.1): a patch ends when its misses per triangle fall
  // below lambda. 3: every triangle is a patch.
  double lambda = 0.85;
  // refined: misses per triangle that its orders may have. Unset: those of the paper's method with this
  // lambda.
  std::optional<double> acmr{};
  std::uint32_t cache_size = 16;  // FIFO entries
  std::uint32_t view_level = 2;   // viewpoints: the 10 * 4^n + 2 vertices of an icosphere, 162
  // Distances of these viewpoints, bounding radii: spread over the range.
  double min_distance = 1.5, max_distance = 3;
  std::uint32_t size = 256;  // pixels per side of the pictures that overdraw is counted in
  // Views that orders are made from. The others get the order of the same viewpoint in the key frames around
  // theirs where these agree, else the cheapest for them. 0: all.
  std::uint32_t most_training_views = 6000;
  // Layers behind pixels, of all these views together, that are kept: of deep models some pixels are left
  // out. 12 bytes each, at most.
  std::uint64_t most_layers = 6'000'000;
  // Views that get an order of their own: of more, only some key frames do, and the others what the nearest
  // of these has.
  std::uint64_t most_views = 30'000;
  std::uint64_t seed = 1;
  Progress* progress = nullptr;
};

struct OverdrawSeconds {
  double patches = 0, raster = 0, cluster = 0, assign = 0, total = 0;
};

struct OverdrawRun {
  std::uint64_t patches = 0;
  std::uint64_t views = 0, training_views = 0;  // key frames x viewpoints
  std::uint64_t lists = 0;                      // distinct sequences of patches behind a pixel
  std::uint32_t iterations = 0;
  double training_overdraw = 0;  // mean over the training views
  double acmr = 0;               // mean over the orders
  OverdrawSeconds seconds;
  std::uint64_t peak_rss_bytes = 0;
};

struct OverdrawOrders {
  // All triangles, patch by patch: patch p is triangles sequence[patch_offsets[p] .. patch_offsets[p + 1]).
  // Patches in this sequence are the best single order for all views.
  std::vector<std::uint32_t> sequence;
  std::vector<std::uint32_t> patch_offsets;
  std::vector<std::uint32_t> patch_parts;          // part of every patch
  std::vector<std::vector<std::uint32_t>> orders;  // patches as they are drawn
  std::vector<BoundingSphere> spheres;             // of every frame: viewpoints are relative to it
  std::vector<std::uint32_t> cell_orders;          // frames x viewpoints (P[view_level]): index into orders
  OverdrawRun run;
};

// Throws Error{nothing_to_do} without triangles or frames, Error{bad_argument} for options that make no
// sense. Deterministic for any number of threads.
OverdrawOrders order_overdraw(const OverdrawSubject& subject, const OverdrawOptions& options);

// The cheapest of these orders for every frame of `poses` and every viewpoint: frames x viewpoints. `poses`
// has the triangles and parts that the orders were made for. O(frames * viewpoints * raster).
std::vector<std::uint32_t> cheapest_orders(const OverdrawSubject& poses, const OverdrawOrders& orders,
                                           const OverdrawOptions& options);

// Triangles in drawing order.
std::vector<std::uint32_t> triangle_sequence(const OverdrawOrders& orders, std::uint32_t order);

// The cache-only order: tipsify of every part (Sander, Nehab, Barczak, SIGGRAPH 2007), cache of `cache_size`.
std::vector<std::uint32_t> cache_order(const OverdrawSubject& subject, std::uint32_t cache_size);

// The overdraw order of Sander et al. 2007 for one pose, without regard to views: `cached` (a cache_order())
// in patches of `lambda`, those first that lie outside and face outwards. What the paper applies to every
// frame by itself ("tipsify").
std::vector<std::uint32_t> static_overdraw_order(const OverdrawSubject& subject, std::uint32_t frame,
                                                 std::span<const std::uint32_t> cached, double lambda,
                                                 std::uint32_t cache_size);

}  // namespace pellucid
