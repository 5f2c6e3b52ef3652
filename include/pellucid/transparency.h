// pellucid/transparency.h - module `transparency`: draw orders for translucent meshes, the in-depth buffers.
//
// In: a clean Mesh and options. Out: an OrderSet, a few orders of all triangles of which the right one blends
// correctly from any viewpoint. Occlusion graph -> clusters of view cells -> one order per cluster.
// Follows: Han, Chen, Nehab, Sander, "In-Depth Buffers", PACMCGIT 1(1), 2018 (section numbers below), and
// goes beyond it with weighted edges and an error budget (docs/in-depth-buffers.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/mesh.h"
#include "pellucid/sequencing.h"
#include "pellucid/split.h"
#include "pellucid/view.h"

namespace pellucid {

class CheckpointStore;

struct StageSeconds {
  double graph = 0, cluster = 0, sequence = 0, refine = 0, total = 0;
};

struct OrderStatistics {
  std::uint64_t triangles = 0;
  std::uint64_t viewpoints = 0;           // samples x distances
  std::uint64_t edges_per_viewpoint = 0;  // mean
  std::uint64_t edges_total = 0;          // over all cells, each cell's union counted once
  std::uint64_t intersecting_pairs = 0;  // pairs that swap depth inside their overlap, summed over viewpoints
  std::uint32_t cyclic_cells = 0;        // cells whose own union of kept edges is cyclic
  std::uint64_t dropped_edges = 0;       // acyclic: lightest edges removed to break those cycles
  double dropped_weight = 0;             //   their share of all weight
  double violated_weight = 0;    // share of the overlapped area drawn in the wrong order, at the samples
  double violated_floor = 0;     //   at least so much for any number of buffers over these cells
  double violated_bound = 0;     //   at least so much for any orders of these clusters
  std::uint32_t regions = 0;     // connected parts of the sphere of views, each drawn by one buffer
  double switches_per_turn = 0;  // buffer changes while the camera goes once around: mean over great circles
  std::uint32_t clusters_before_relaxation = 0;  // acyclic
  std::uint32_t clusters_lower_bound = 0;        // acyclic: cells that contradict each other pairwise; else 0
  std::uint32_t iterations = 0;                  // budget: k-means rounds; acyclic: relaxation rounds
  double measured_error = -1;                    // IPR on the validation viewpoints; -1: not measured
  double measured_psnr = -1;  // PSNR there, dB, if the options asked for it; -1: not measured
  StageSeconds seconds;
  std::uint64_t peak_rss_bytes = 0;
};

struct OrderResult {
  OrderSet orders;
  OrderStatistics statistics;
};

// ------------------------------------------------------------------------------------------ the options

enum class OrderMethod { budget, acyclic };
enum class OcclusionSource { exact, raster };
// Which pair of clusters to merge first (section 3.2), I and J being their edge sets.
enum class MergePriority {
  intersection /* max |I n J| */,
  difference /* min |I u J| - |I n J| */,
  union_size /* min |I u J| */
};
enum class Projection { perspective, orthographic };

struct OrderOptions {
  OrderMethod method = OrderMethod::budget;
  PartitionSpec partition{};
  // Distances of the samples in bounding radii (infinity allowed). Empty: the default spread, see
  // default_distances().
  std::vector<double> distances{};  // {}: GCC 12 warns of bare members that designated initializers leave out
  Facing facing = Facing::duplicated;
  OcclusionSource occlusion = OcclusionSource::exact;
  std::uint32_t raster_size = 512;  // occlusion = raster: pixels per side

  // Overlaps thinner than this (in bounding radii, measured across the overlap at the sphere's centre depth)
  // make no edge. < 0: the method's default (budget 0; acyclic 0.003, the authors' value).
  double tolerance = -1;

  // Weigh occlusions by what is visible of them: the area of an overlap times the light that reaches it,
  // (1 - alpha)^(layers in front), for faces of this opacity, 0 < alpha <= 1. 0: by area alone.
  double alpha = 0;

  double max_error = 0.001;  // budget: add buffers until the measured IPR is at most this
  // budget, in the place of max_error: until the PSNR of the pictures (lit, faces of opacity alpha, 0.5 where
  // that is 0; see shading.h) is at least this, dB, mean over the validation viewpoints.
  std::optional<double> min_psnr{};
  // budget, in the place of both: the fewest buffers, up to max_buffers, with which frames by verified
  // blending take hardly longer than with any number of them (verified_frame_time()).
  bool least_frame_time = false;
  std::uint32_t max_buffers = 16;  // budget: never more than this many
  std::uint32_t min_buffers = 1;   // budget: start here (equal to max_buffers: that many, but none unused)
  MergePriority priority = MergePriority::union_size;  // acyclic
  std::uint32_t fruitless_rounds = 5;                  // acyclic: relaxation stops after so many

  // Section 5: order the mesh simplified to so many triangles, carry the order over to all, and repair it
  // there. 0: never. Unset: above 24,000 triangles, from 10,000.
  std::optional<std::uint32_t> upsample_from{};
  std::uint32_t refine_rounds = 1;  // of that repair; 0: none, the paper's form

  std::uint32_t cache_size = 20;  // FIFO size that sequences are optimised for; 0: leave the sequence alone
  CacheMethod cache_method = CacheMethod::scheduled;
  // budget: the area drawn in the wrong order that a sequence may add for the vertex cache, square bounding
  // radii per view (a picture is 4). 0: none. acyclic never adds any.
  double cache_slack = 1e-4;
  // Bytes that ordering should get by with; 0: no limit. Half of it is for the occlusion graphs of the cells:
  // what is more goes to a temporary file ($TMPDIR, else /tmp) and is read from there cell by cell, and
  // clusters are worked on one at a time. The meshes and the summed graph of one cluster (24 bytes an edge)
  // are not bounded by it. The result is the same.
  std::uint64_t memory = 0;
  std::uint64_t seed = 1;
  Progress* progress = nullptr;
  // Where finished parts are kept, so that the next run with the same mesh and options goes on where this one
  // was stopped or killed (pellucid/checkpoint.h). Null: nowhere.
  CheckpointStore* checkpoints = nullptr;
};

std::vector<double> default_distances();
// The opacity that pictures are judged at: options.alpha, or 0.5.
double picture_alpha(const OrderOptions& options);

// Order one mesh. The mesh must be clean (see clean()). A mesh without triangles throws Error{nothing_to_do}.
OrderResult order_mesh(const Mesh& mesh, const OrderOptions& options);

// Returns the clean mesh that is ordered in the place of `mesh`. Orders of it are carried over to `mesh` by
// lift_orders(orders, source). Throws Error{nothing_to_do} where no triangle is left; `name` begins the
// message.
CleanMesh clean_to_order(const Mesh& mesh, const CleanOptions& options, const std::string& name);

// ------------------------------------------------------------------------------ error against memory

// The best order set of at most `limit` buffers.
struct FrontierPoint {
  std::uint32_t limit = 0;
  // order_mesh() with min_buffers = max_buffers = request makes this order set. Less than `limit` where that
  // many buffers came out worse than fewer, which are valid for `limit`, too.
  std::uint32_t request = 0;
  std::uint32_t buffers = 0;       // that it holds: fewer than requested where one would serve no view
  double ipr = 0, psnr = 0;        // mean over the validation viewpoints, see OrderOptions::min_psnr
  double repaired = 0;             // share of pixels that verified blending repairs, mean over the same
  double frame_time = 1;           // of that, by verified_frame_time()
  double violated_weight = 0;      // as in OrderStatistics
  std::uint64_t memory_bytes = 0;  // index data when drawn
  bool meets_target = false;       // max_error, min_psnr or least_frame_time
};

struct OrderFrontier {
  std::vector<FrontierPoint> points;  // limit = 1 .. options.max_buffers
  // Limits. chosen: the fewest buffers that meet the target; where none do, the number after which more
  // hardly help. knee: where the curve of log error over buffers bends most; 0: nowhere.
  std::uint32_t chosen = 0, knee = 0;
  OrderStatistics statistics;         // of the chosen number
  std::optional<OrderResult> result;  // of the chosen number, when asked for
};

// What a frame takes by verified blending (render.h), where blending alone takes 1 and this share of the
// covered pixels is repaired: a curve through what was measured (docs/rendering.md, "What repairs cost").
double verified_frame_time(double repaired);

// Error against number of buffers, so that a user picks: the graph is built once, clustered for every number
// from 1 to options.max_buffers. Errors never rise with the number (judged by the measure of the target).
// Budget only: acyclic finds its own number. With upsampling every number takes the repair of the full mesh.
OrderFrontier order_frontier(const Mesh& mesh, const OrderOptions& options, bool with_result = false);

// ------------------------------------------------------------------------- faces without a right draw order

struct CycleOptions {
  std::vector<double> distances;  // of the viewpoints, as in OrderOptions; empty: default_distances()
  Facing facing = Facing::duplicated;
  std::uint64_t max_new_triangles = ~std::uint64_t{0};
  Progress* progress = nullptr;
};

struct SplitResult {
  MeshSplit split;
  std::uint64_t intersecting_pairs = 0;  // of triangles of the input
  std::uint64_t pairs_left = 0;          // of these, pairs that still intersect
  std::uint32_t viewpoints = 0;          // that cycles were looked for from
  std::uint32_t cyclic_before = 0;       // of these, viewpoints with a cycle; intersections were split before
  std::uint32_t cyclic_left = 0;
  std::uint64_t added_by_intersections = 0, added_by_cycles = 0;  // triangles
};
// Split intersecting triangles first. Then from 162 viewpoints (an icosphere's vertices, which take turns
// with the distances) find the strongly connected components of the exact occlusion graph, without edges that
// no pixel shows, and cut in each a triangle along the plane of another member, that which leaves the fewest
// triangles in cycles; again until no cycle is left, or no cut helps, or there are too many triangles.
// Components of more than 24 triangles are left alone. The mesh must be clean. Deterministic.
SplitResult split_unordered(const Mesh& mesh, const CycleOptions& options);

}  // namespace pellucid
