// pellucid/transparency.h - module `transparency`: computes draw orders for translucent meshes, called
// in-depth buffers.
//
// In: a clean Mesh and options. Out: an OrderSet, that is, a few orders of all triangles and a table that
// says which of them blends correctly from a view direction. Steps: the occlusion graph of every view cell,
// clusters of view cells, one order per cluster. Based on: Han, Chen, Nehab, Sander, "In-Depth Buffers",
// PACMCGIT 1(1), 2018 (section numbers below), and extends it with weighted edges and an error budget
// (docs/in-depth-buffers.md).
//
// Terms. A node is a triangle with one of its two facings. An edge (front, back) of the occlusion graph says
// that the front node covers a part of the back node; its weight is the area of the overlap in the image. An
// order violates an edge if it draws the back node in front. IPR is the share of covered pixels in a wrong
// order.
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

// ---------------------------------------------------------------------------------------------- the options

enum class OrderMethod {
  budget,   // finds the fewest orders that meet an error; the orders may violate edges
  acyclic,  // the method of the paper: cells share an order only if it violates no edge
};
// How occlusions are found: by exact geometry, or from the fragments of a raster.
enum class OcclusionSource { exact, raster };
// Which pair of clusters the acyclic method merges first (section 3.2). I and J are their edge sets.
enum class MergePriority {
  intersection,  // max |I n J|
  difference,    // min |I u J| - |I n J|
  union_size     // min |I u J|
};
enum class Projection { perspective, orthographic };

struct OrderOptions {
  // ------------------------------------------------------------------------------ for both methods
  OrderMethod method = OrderMethod::budget;
  PartitionSpec partition{};
  // Distances of the samples in bounding radii; infinity is allowed. Empty: default_distances().
  std::vector<double> distances{};  // {}: GCC 12 warns of bare members that designated initializers leave out
  Facing facing = Facing::duplicated;
  OcclusionSource occlusion = OcclusionSource::exact;
  std::uint32_t raster_size = 512;  // occlusion = raster: pixels per side

  // Overlaps thinner than this make no edge. Bounding radii, measured across the overlap at the depth of the
  // sphere's centre. < 0: the default of the method: 0 for budget; 0.003, the authors' value, for acyclic.
  double tolerance = -1;

  // The opacity by which occlusions are weighted, 0..1. > 0: the weight is the area of the overlap times the
  // light transmittance of the layers in front of it, (1 - alpha)^layers. 0: the weight is the area.
  double alpha = 0;

  // ----------------------------------------------------------------------------- budget: the error
  // Buffers are added until the mean IPR over held-out viewpoints is at most this.
  double max_error = 0.001;
  // Replaces max_error: buffers are added until the mean PSNR over held-out viewpoints is at least this (dB).
  // The images are lit (shading.h), with faces of opacity alpha, or 0.5 if alpha is 0.
  std::optional<double> min_psnr{};
  // Replaces both: uses the fewest buffers with which a frame by verified blending takes hardly longer than
  // with any other number of up to max_buffers (verified_frame_time()).
  bool least_frame_time = false;
  std::uint32_t max_buffers = 16;  // the largest number of buffers
  // The least number of buffers. Set it to max_buffers to ask for one number. Buffers that no view cell uses
  // are removed, so there may be fewer.
  std::uint32_t min_buffers = 1;

  // ------------------------------------------------------------------------------ acyclic: the search
  MergePriority priority = MergePriority::union_size;
  std::uint32_t fruitless_rounds = 5;  // relaxation stops after this many rounds without a merged cluster

  // --------------------------------------------------------------------------------- large meshes
  // Section 5: simplifies the mesh to this many triangles, orders it, carries the order over to all
  // triangles, and repairs it there. 0: never. Unset: to 10,000 triangles if the mesh has more than 24,000.
  std::optional<std::uint32_t> upsample_from{};
  std::uint32_t refine_rounds = 1;  // rounds of that repair; 0: none, as in the paper

  // --------------------------------------------------------------------------------- vertex cache
  std::uint32_t cache_size = 20;  // FIFO size that orders are optimised for; 0: do not optimise
  CacheMethod cache_method = CacheMethod::scheduled;
  // budget: the area drawn in a wrong order that an order may add for the vertex cache, square bounding radii
  // per view (an image has 4). 0: none. acyclic never adds any.
  double cache_slack = 1e-4;

  // --------------------------------------------------------------------- memory, randomness, long runs
  // The memory budget in bytes; 0: no limit. Half of it is for the occlusion graphs of the cells. What does
  // not fit goes to a temporary file ($TMPDIR, else /tmp) and is read from there cell by cell, and clusters
  // are processed one at a time. The limit does not include the meshes and the summed graph of one cluster
  // (24 bytes per edge). The result does not depend on it.
  std::uint64_t memory = 0;
  std::uint64_t seed = 1;
  Progress* progress = nullptr;
  // Where finished parts are stored, so that the next run with the same mesh and options continues where this
  // one was stopped (pellucid/checkpoint.h). Null: nowhere.
  CheckpointStore* checkpoints = nullptr;
};

// Returns the distances of the samples that are used if the options give none.
std::vector<double> default_distances();
// Returns the opacity of the images that the PSNR is measured on: options.alpha, or 0.5.
double image_alpha(const OrderOptions& options);

// ----------------------------------------------------------------------------------------------- the result

// The wall time of the stages in seconds. `sequence`: the orders of the clusters. `refine`: their repair on
// the full mesh after upsampling.
struct StageSeconds {
  double graph = 0, cluster = 0, sequence = 0, refine = 0, total = 0;
};

// What order_mesh() found. Weights are those of edges (see the terms above).
struct OrderStatistics {
  // The mesh is flat or its faces lie on its hull, so one order is right from everywhere and nothing was
  // searched or measured.
  bool simple = false;
  std::uint64_t triangles = 0;
  std::uint64_t viewpoints = 0;           // samples x distances
  std::uint64_t edges_per_viewpoint = 0;  // mean
  std::uint64_t edges_total = 0;          // over all cells; an edge counts once per cell
  std::uint64_t intersecting_pairs = 0;  // pairs that swap depth inside their overlap, summed over viewpoints
  std::uint32_t cyclic_cells = 0;        // cells whose own kept edges have a cycle
  std::uint64_t dropped_edges = 0;       // acyclic: lightest edges that were removed to break those cycles
  double dropped_weight = 0;             //   their share of all weight
  double violated_weight = 0;  // share of the overlapped area that is drawn in a wrong order, at the samples
  double violated_floor = 0;   //   lower bound for any number of buffers over these cells
  double violated_bound = 0;   //   lower bound for any orders of these clusters
  std::uint32_t regions = 0;   // connected parts of the sphere of views that are drawn by one buffer each
  double switches_per_turn = 0;  // buffer changes while the camera goes once around: mean over great circles
  std::uint32_t clusters_before_relaxation = 0;  // acyclic
  std::uint32_t clusters_lower_bound = 0;        // acyclic: cells that contradict each other pairwise; else 0
  std::uint32_t iterations = 0;                  // budget: k-means rounds; acyclic: relaxation rounds
  double measured_error = -1;                    // IPR over held-out viewpoints; -1: not measured
  double measured_psnr = -1;  // PSNR there, dB, if the options ask for it; -1: not measured
  StageSeconds seconds;
  std::uint64_t peak_rss_bytes = 0;
};

struct OrderResult {
  OrderSet orders;
  OrderStatistics statistics;
};

// Returns the clean mesh that is ordered instead of `mesh`. lift_orders(orders, source) carries its orders
// over to `mesh`. Throws Error{nothing_to_do} if no triangle is left; the message begins with `name`.
CleanMesh clean_to_order(const Mesh& mesh, const CleanOptions& options, const std::string& name);

// Orders one mesh. The mesh must be clean (see clean()). Throws Error{nothing_to_do} for a mesh without
// triangles and Error{bad_argument} for options that are out of range. Deterministic for any number of
// threads.
OrderResult order_mesh(const Mesh& mesh, const OrderOptions& options);

// ------------------------------------------------------------------------- error against number of buffers

// The best order set of at most `limit` buffers.
struct FrontierPoint {
  std::uint32_t limit = 0;
  // order_mesh() with min_buffers = max_buffers = request makes this order set. It is less than `limit` if
  // fewer buffers turned out to have a smaller error than `limit` buffers.
  std::uint32_t request = 0;
  std::uint32_t buffers = 0;       // in the set; fewer than requested if no view cell would use one
  double ipr = 0, psnr = 0;        // mean over held-out viewpoints, see OrderOptions::min_psnr
  double repaired = 0;             // share of pixels that verified blending repairs, mean over the same
  double frame_time = 1;           // verified_frame_time(repaired)
  double violated_weight = 0;      // as in OrderStatistics
  std::uint64_t memory_bytes = 0;  // of the index data when drawn
  bool meets_target = false;       // the target is max_error, min_psnr or least_frame_time
};

// The curve of error against number of buffers (a Pareto front).
struct OrderFrontier {
  std::vector<FrontierPoint> points;  // limit = 1 .. options.max_buffers
  // Numbers of buffers. chosen: the fewest that meet the target; if none does, the number after which more
  // buffers hardly help. knee: the number where the curve of log error bends most; 0: it has no bend.
  std::uint32_t chosen = 0, knee = 0;
  OrderStatistics statistics;         // of the chosen number
  std::optional<OrderResult> result;  // of the chosen number, on request
};

// Returns the time of a frame by verified blending (render.h) relative to blending alone, if this share of
// the covered pixels is repaired. It is a curve through measurements (docs/rendering.md, "What repairs
// cost").
double verified_frame_time(double repaired);

// Returns the error for every number of buffers from 1 to options.max_buffers, so that a user can choose. The
// graph is built once and clustered for each number. Errors never rise with the number, by the measure of the
// target. Only the method budget is allowed, because acyclic finds its own number. With upsampling, the full
// mesh is repaired once for every number. Throws as order_mesh() does.
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
  std::uint32_t viewpoints = 0;          // that were searched for cycles
  std::uint32_t cyclic_before = 0;       // of these, viewpoints with a cycle after intersections were split
  std::uint32_t cyclic_left = 0;         // of these, viewpoints that still have a cycle
  std::uint64_t added_by_intersections = 0, added_by_cycles = 0;  // triangles
};
// Splits intersecting triangles, and then triangles that overlap in cycles. Cycles are the strongly connected
// components of the exact occlusion graph from 162 viewpoints (the vertices of an icosphere, which alternate
// between the distances), without edges that no pixel shows. In each component one triangle is cut along the
// plane of another member; the cut is chosen that leaves the fewest triangles in cycles. This is repeated
// until no cycle is left, no cut helps, or the limit of new triangles is reached. Components of more than 24
// triangles are left as they are. The mesh must be clean. Deterministic.
SplitResult split_unordered(const Mesh& mesh, const CycleOptions& options);

}  // namespace pellucid
