// pellucid/baseline.h - module `baseline`: implements the methods that programs use without precomputed
// orders, so that order sets can be measured beside them (docs/baselines.md).
//
// In: a clean mesh and a viewpoint. Out: triangles in depth order, found with work in every frame or with
// copies of triangles: centroid sort, binary space partition, depth-presorted lists, and the best order of
// one view. Also the measurement of order sets and of overdraw orders beside their baselines.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/mesh.h"
#include "pellucid/metric.h"
#include "pellucid/overdraw.h"
#include "pellucid/sequencing.h"
#include "pellucid/view.h"

namespace pellucid {

// ------------------------------------------------------------------------------------------ centroid sort

// Returns all triangles front to back by the distance of their centroids to the camera, each with the facing
// that the camera sees. Viewers do this on the CPU in every frame.
NodeSequence centroid_sorted(const Mesh& mesh, const BoundingSphere& sphere, const Viewpoint& viewpoint);

// Sorts all triangles by the distance of their centroids, with a radix sort on 32-bit keys.
class CentroidSort {
 public:
  CentroidSort(const Mesh& mesh, const BoundingSphere& sphere);
  struct Scratch {
    std::vector<std::uint64_t> keyed, swapped;  // key and triangle
  };
  // Returns the triangles front to back; equal distances stay in file order. Takes O(triangles).
  void sort(const Eye& eye, Scratch& scratch, std::vector<std::uint32_t>& triangles) const;
  [[nodiscard]] std::uint64_t memory_bytes() const { return centroids_.size() * sizeof(Vec3f); }

 private:
  Vec3d center_;
  std::vector<Vec3f> centroids_;  // relative to the centre
};

// ---------------------------------------------------------------------------------- binary space partition

// A plane as a renderer stores it: dot(normal, point) = offset.
struct Plane {
  Vec3f normal;
  float offset = 0;
};
// Returns a value > 0 if the eye is in front of the plane.
inline double side_of(const Plane& plane, const Eye& eye) {
  return dot(to_double(plane.normal), eye.at) - static_cast<double>(plane.offset) * eye.w;
}

// A binary space partition by the planes of the triangles themselves. Triangles that a plane crosses are
// split. Based on: Fuchs, Kedem, Naylor, "On Visible Surface Generation by A Priori Tree Structures",
// SIGGRAPH 1980.
struct BspNode {
  Plane plane;
  std::uint32_t front = 0, back = 0;   // children; 0 (the root) means none
  std::uint32_t first = 0, count = 0;  // triangles of BspTree::mesh that lie in the plane
};
struct BspTree {
  Mesh mesh;                          // the pieces as triangles; vertices of the input first, no normals
  std::vector<std::uint32_t> source;  // per piece: the triangle of the input that it is a part of
  std::vector<BspNode> nodes;         // 0 is the root
  std::uint64_t splits = 0;           // number of cuts of a piece in two
  bool complete = true;               // false: more than max_pieces would be needed, and the tree is empty
};
struct BspOptions {
  std::uint64_t max_pieces = 5'000'000;
  std::uint64_t seed = 1;
  Progress* progress = nullptr;
};
// Builds the partition. Expected O(n log n) for n pieces, O(n^2) if the mesh is convex. Deterministic.
BspTree build_bsp(const Mesh& mesh, const BspOptions& options);
// Returns the pieces front to back for any eye, also for one inside the convex hull. Takes O(pieces).
void walk_bsp(const BspTree& tree, const Eye& eye, std::vector<std::uint32_t>& pieces);

// --------------------------------------------------------------------------- depth-presorted triangle lists

// Every region of view directions has one list that merges the orders of all its viewpoints. A list can hold
// a node several times; plane tests make sure that exactly one of these copies is drawn. Based on: Chen,
// Sander, Nehab, Yang, Hu, "Depth-Presorted Triangle Lists", ACM TOG 31(6), 2012, as Han et al. 2018 describe
// it. docs/baselines.md says what the text leaves open and what was assumed.

// The list of one region.
struct PresortedList {
  std::vector<NodeId> nodes;                // one per copy, front to back
  std::vector<std::uint32_t> test_offsets;  // copies + 1, into tests
  // 2 * plane: the viewpoint must be in front of the plane or on it; 2 * plane + 1: behind it.
  std::vector<std::uint32_t> tests;
};
// The lists of all regions.
struct PresortedLists {
  PartitionSpec partition;
  BoundingSphere sphere;
  std::vector<PresortedList> lists;
  std::vector<std::uint32_t> cell_lists;  // per view cell: index into lists
  std::vector<Plane> planes;
  std::uint64_t violated_edges = 0;  // occlusions that no plane could correct
  bool complete = true;  // false: a limit of PresortedOptions was exceeded, and there are no lists
};
struct PresortedOptions {
  PartitionSpec partition{};      // the lists are right for the samples of this partition
  std::uint32_t regions = 6;      // 1 .. number of cells
  std::vector<double> distances;  // as in OrderOptions
  Facing facing = Facing::duplicated;
  std::uint32_t cache_size = 20;         // FIFO size that lists are optimised for; 0: do not optimise
  std::uint64_t max_copies = 2'000'000;  // in one list
  // The largest number of occlusions of one region, counted once per viewpoint. Each takes about 35 bytes
  // while the list is made.
  std::uint64_t max_edges = 150'000'000;
  Progress* progress = nullptr;
};
// Builds the lists. If a limit of the options is exceeded, the result is not `complete`. Deterministic.
// Throws Error{interrupted} if options.progress requests it.
PresortedLists build_presorted_lists(const Mesh& mesh, const PresortedOptions& options);
// Returns the list that a renderer walks for a view direction.
const PresortedList& select_list(const PresortedLists& lists, const Vec3d& direction);
// Returns the copies that pass their tests, in the order of the list. Takes O(list).
void walk_list(const PresortedLists& lists, const PresortedList& list, const Eye& eye, NodeSequence& nodes);

// ------------------------------------------------------------------------------- the best order of one view

// Returns the ranks of all nodes in the best order that is found for one viewpoint alone, from a raster.
// Nodes that are in no cycle are in the right order; the others are sifted. No order is right for the pixels
// that this order draws wrong, except where sifting misses a better order.
std::vector<std::uint32_t> best_ranks(const Mesh& mesh, const BoundingSphere& sphere,
                                      const Viewpoint& viewpoint, std::uint32_t raster_size, Facing facing);

// --------------------------------------------------------------------- measuring order sets beside baselines

// A mesh as one file draws it. If `orders` is null, the file has only its own triangle order.
struct MeasureSubject {
  std::string label;
  const Mesh* mesh = nullptr;        // clean
  const OrderSet* orders = nullptr;  // nodes refer to `mesh`
};

// The baselines that are measured beside the order sets.
struct Baselines {
  bool base = true, cache_optimized = true, centroid_sort = true;
  bool bsp = false, dptl = false;  // take time and memory to build
};
// Parses "all", "none", or names with commas between them: "base,cache_optimized,centroid_sort,bsp,dptl".
// Throws Error{bad_argument} for other names.
Baselines parse_baselines(const std::string& text);
// Returns all names that a measured baseline can have.
std::span<const std::string_view> baseline_names();

// What measure_subjects() measures, and how.
struct MeasureSettings : MeasuredViews {
  std::uint32_t cache_size = 20;  // FIFO size of the main vertex cache statistics
  double alpha = 0.5;             // opacity of the surface
  Baselines baselines{};
};

enum class MethodKind { orders, baseline };

// The ACMR of every method is reported for these caches, so that a reader sees what an order that is
// optimised for one size costs with another.
struct ReportedCache {
  CacheModel model;
  std::uint32_t size;
  std::string_view name;
};
constexpr std::array<ReportedCache, 5> kReportedCaches{{{CacheModel::fifo, 16, "fifo16"},
                                                        {CacheModel::fifo, 20, "fifo20"},
                                                        {CacheModel::fifo, 32, "fifo32"},
                                                        {CacheModel::lru, 16, "lru16"},
                                                        {CacheModel::lru, 32, "lru32"}}};

// A method with its costs and its quality.
struct MethodReport {
  MethodKind kind = MethodKind::orders;
  std::uint32_t buffers = 1;
  std::uint64_t memory_bytes = 0;     // index data when drawn
  std::uint64_t auxiliary_bytes = 0;  // other data: tables, planes, trees, centroids, new vertices
  double build_seconds = -1;          // wall time of building it in this run; < 0: nothing was built
  double nanoseconds_per_frame = 0;   // CPU time before a frame can be drawn
  double triangles_submitted = 0;     // per frame; front-facing and back-facing copies count separately
  double plane_tests = 0;             // per frame
  std::uint64_t splits = 0;           // triangles and pieces that were cut in two
  BufferStatistics fifo;              // all buffers pooled
  double acmr_lru = 0;
  std::array<double, kReportedCaches.size()> acmr_by_cache{};
  double atvr = 0;
  double overdraw = 0;
  MethodQuality quality;  // carries the name
};

// The methods that were measured on one primitive.
struct PrimitiveMeasureReport {
  std::string name;
  std::uint64_t triangles = 0, vertices = 0;
  std::vector<MethodReport> methods;  // the order sets first, then the baselines
  std::vector<std::string> notes;     // which requested baselines were left out, and why
};

// Measures every subject that has orders, and beside them the baselines of the first subject's mesh. The
// first subject decides the facing. The baselines are:
//   original               the triangle order of the mesh `original`, drawn as viewers draw it: later
//                          triangles over earlier ones; left out if `original` is null
//   base                   the base order of the set, its best single order
//   cache_optimized        meshoptimizer's vertex cache order of all triangles, which ignores depth
//   cache_optimized_twins  the same for every buffer of the set, with the nodes of that buffer; shows what
//                          the depth order costs in cache misses
//   centroid_sort          all triangles sorted in every frame
//   bsp                    the walk of a binary space partition
//   dptl                   depth-presorted triangle lists
PrimitiveMeasureReport measure_subjects(std::span<const MeasureSubject> subjects, const Mesh* original,
                                        const std::string& name, const MeasureSettings& settings,
                                        Progress* progress);
// Returns the number of viewpoints that overdraw is counted on. They are the first of those that quality is
// measured on.
std::uint32_t overdraw_viewpoints(const MeasureSettings& settings);

// Returns the ranks of all nodes when the order set is drawn from a viewpoint: in the order of its view cell,
// or in the base order inside valid_from.
std::vector<std::uint32_t> ranks_from(const Mesh& mesh, const OrderSet& orders, const Viewpoint& viewpoint);
// Returns the ranks of both facings when whole triangles are drawn front to back in `order`.
std::vector<std::uint32_t> ranks_of_triangles(std::span<const std::uint32_t> order,
                                              std::uint64_t triangle_count);
// Returns the ranks of a triangle order as viewers blend it: the last triangle is the nearest.
std::vector<std::uint32_t> ranks_as_stored(std::uint64_t triangle_count);
// Returns all triangles in meshoptimizer's vertex cache order, which ignores depth.
std::vector<std::uint32_t> cache_optimized_order(const Mesh& mesh);
// Returns the same nodes in meshoptimizer's vertex cache order.
NodeSequence cache_optimized_nodes(const Mesh& mesh, const NodeSequence& nodes);

// ------------------------------------------------------------- measuring overdraw orders beside baselines

// A key frame of the subject: OverdrawSubject::frames[f] shows clip `clip` at `time`.
struct PosedFrame {
  std::uint32_t clip = 0;
  double time = 0;  // seconds
};

// The orders for all key frames of a model: one set for all clips ("joint"), or one set for each clip.
struct OverdrawSets {
  std::vector<OverdrawOrders> sets;
  std::vector<std::uint32_t> set_of;        // by key frame
  std::vector<std::uint32_t> frame_in_set;  // by key frame
  std::uint32_t view_level = 2;

  [[nodiscard]] std::uint32_t order_count() const;
};
// Makes one set if `joint`, else one set per clip, in the order of the clips.
OverdrawSets order_overdraw_sets(const OverdrawSubject& subject, const std::vector<PosedFrame>& frames,
                                 const OverdrawOptions& options, bool joint);

// A way of drawing the subject with what it costs: our orders, or a baseline.
struct MeasuredOverdrawMethod {
  std::string name;  // "refined", "paper", "single", "per-frame", "meshopt", "original", "input"
  std::uint32_t buffers = 1;
  double acmr = 0;             // mean over its buffers
  PosedDrawingMethod drawing;  // owns its ranks
};
// Returns the method that draws every key frame in the order that `sets` choose for it.
MeasuredOverdrawMethod method_of_sets(const std::string& name, const OverdrawSubject& subject,
                                      OverdrawSets sets, std::uint32_t cache_size);

// Which baselines of overdraw orders are made, and how.
struct OverdrawBaselineOptions {
  std::vector<std::string> names;  // any of "input", "original", "meshopt", "per-frame", "single", "paper"
  OverdrawOptions orders;          // lambda, cache, buffers and seed as for the orders to compare with
  bool joint = true;               // as in order_overdraw_sets()
  double acmr = 0;          // meshopt: choose the least threshold with at least this many misses per triangle
  std::vector<Vec3f> rest;  // vertices of the rest pose, which meshopt gets
};
// Makes the baselines of overdraw orders, in the order of their names. Throws Error{bad_argument} for other
// names.
std::vector<MeasuredOverdrawMethod> make_overdraw_baselines(const OverdrawSubject& subject,
                                                            const std::vector<PosedFrame>& frames,
                                                            const OverdrawBaselineOptions& options);
// Returns the triangle order by meshopt_optimizeVertexCache() and then meshopt_optimizeOverdraw(), part by
// part. `threshold` is that of meshopt_optimizeOverdraw().
std::vector<std::uint32_t> meshopt_overdraw_order(const OverdrawSubject& subject,
                                                  const std::vector<Vec3f>& rest, float threshold);

}  // namespace pellucid
