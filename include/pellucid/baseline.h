// pellucid/baseline.h - module `baseline`: what programs do without precomputed orders, built well.
//
// In: a clean mesh and a viewpoint. Out: triangles in depth order, found with work in every frame or with
// copies: centroid sort, binary space partition, presorted lists, and the best order of one view. They are
// measured beside order sets (docs/baselines.md).
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

// Baseline: all triangles sorted by the distance of their centroid to the camera, front to back, the facing
// that the camera sees. What a viewer does per frame on the CPU.
NodeSequence centroid_sorted(const Mesh& mesh, const BoundingSphere& sphere, const Viewpoint& viewpoint);

// -------------------------------------------------------------- rivals: exact orders that cost run-time work
//
// What programs do without in-depth buffers, built well, to be measured beside them (docs/baselines.md).

// Where the camera stands in object space: w = 1 a point, w = 0 infinitely far in a direction.
struct Eye {
  Vec3d at;
  double w = 1;
};
Eye eye_of(const BoundingSphere& sphere, const Viewpoint& viewpoint);

// All triangles sorted by the distance of their centroid in every frame: radix sort on 32-bit keys.
class CentroidSort {
 public:
  CentroidSort(const Mesh& mesh, const BoundingSphere& sphere);
  struct Scratch {
    std::vector<std::uint64_t> keyed, swapped;  // key and triangle
  };
  // Triangles front to back, equal distances in file order. O(triangles).
  void sort(const Eye& eye, Scratch& scratch, std::vector<std::uint32_t>& triangles) const;
  [[nodiscard]] std::uint64_t memory_bytes() const { return centroids_.size() * sizeof(Vec3f); }

 private:
  Vec3d center_;
  std::vector<Vec3f> centroids_;  // relative to the centre
};

// A plane as a renderer stores it: dot(normal, point) = offset.
struct Plane {
  Vec3f normal;
  float offset = 0;
};
// > 0 in front of the plane.
inline double side_of(const Plane& plane, const Eye& eye) {
  return dot(to_double(plane.normal), eye.at) - static_cast<double>(plane.offset) * eye.w;
}

// A binary space partition by planes of the triangles themselves; triangles that a plane crosses are split.
// Fuchs, Kedem, Naylor, "On Visible Surface Generation by A Priori Tree Structures", SIGGRAPH 1980.
struct BspNode {
  Plane plane;
  std::uint32_t front = 0, back = 0;   // children; 0, the root: none
  std::uint32_t first = 0, count = 0;  // triangles of BspTree::mesh that lie in the plane
};
struct BspTree {
  Mesh mesh;                          // the pieces as triangles; vertices of the input first, no normals
  std::vector<std::uint32_t> source;  // per piece: the triangle of the input that it is a part of
  std::vector<BspNode> nodes;         // 0 is the root
  std::uint64_t splits = 0;           // times that a piece was cut in two
  bool complete = true;               // false: max_pieces was met, the tree is empty
};
struct BspOptions {
  std::uint64_t max_pieces = 5'000'000;
  std::uint64_t seed = 1;
  Progress* progress = nullptr;
};
// Expected O(n log n) for n pieces, O(n^2) where the mesh is convex. Deterministic.
BspTree build_bsp(const Mesh& mesh, const BspOptions& options);
// The pieces front to back for any eye, also inside the hull. O(pieces).
void walk_bsp(const BspTree& tree, const Eye& eye, std::vector<std::uint32_t>& pieces);

// Depth-presorted triangle lists after Chen, Sander, Nehab, Yang, Hu, 2012, as Han et al. 2018 describe them:
// for every region of view directions one list that merges the orders of all its viewpoints. A node may be in
// it several times; plane tests see to it that exactly one of these copies is drawn. See docs/baselines.md
// for what the text leaves open and what was assumed.
struct PresortedList {
  std::vector<NodeId> nodes;                // one per copy, front to back
  std::vector<std::uint32_t> test_offsets;  // copies + 1, into tests
  // 2 * plane: the viewpoint must be in front of it or on it; 2 * plane + 1: behind.
  std::vector<std::uint32_t> tests;
};
struct PresortedLists {
  PartitionSpec partition;
  BoundingSphere sphere;
  std::vector<PresortedList> lists;
  std::vector<std::uint32_t> cell_lists;  // per view cell: index into lists
  std::vector<Plane> planes;
  std::uint64_t violated_edges = 0;  // occlusions that no plane could put right
  bool complete = true;              // false: a limit below was met, there are no lists
};
struct PresortedOptions {
  PartitionSpec partition{};      // the viewpoints that the lists are right for are its samples
  std::uint32_t regions = 6;      // 1 .. number of cells
  std::vector<double> distances;  // as in OrderOptions
  Facing facing = Facing::duplicated;
  std::uint32_t cache_size = 20;         // FIFO size that lists are optimised for; 0: leave them alone
  std::uint64_t max_copies = 2'000'000;  // of one list
  // Occlusions of one region, counted once per viewpoint; each takes about 35 bytes while its list is made.
  std::uint64_t max_edges = 150'000'000;
  Progress* progress = nullptr;
};
PresortedLists build_presorted_lists(const Mesh& mesh, const PresortedOptions& options);
// The list for a viewpoint; what a renderer walks.
const PresortedList& select_list(const PresortedLists& lists, const Vec3d& direction);
// The copies that pass their tests, in the list's order. O(list).
void walk_list(const PresortedLists& lists, const PresortedList& list, const Eye& eye, NodeSequence& nodes);

// Ranks of all nodes in the best order that is found for one viewpoint alone, by the raster: nodes in no
// cycle are right, the others are sifted. Pixels that it draws wrong have no right order (up to what sifting
// misses).
std::vector<std::uint32_t> best_ranks(const Mesh& mesh, const BoundingSphere& sphere,
                                      const Viewpoint& viewpoint, std::uint32_t raster_size, Facing facing);

// --------------------------------------------------------------------- measuring order sets beside baselines

// A mesh as one file draws it. `orders` null: the file's own triangle order is all there is.
struct MeasureSubject {
  std::string label;
  const Mesh* mesh = nullptr;        // clean
  const OrderSet* orders = nullptr;  // nodes refer to `mesh`
};

// Rivals to measure beside the order sets.
struct Baselines {
  bool base = true, cache_optimized = true, centroid_sort = true;
  bool bsp = false, dptl = false;  // take time and memory to build
};
// "all", "none", or names with commas: "base,cache_optimized,centroid_sort,bsp,dptl". Throws
// Error{bad_argument}.
Baselines parse_baselines(const std::string& text);
// Names that methods of any choice may have.
std::span<const std::string_view> baseline_names();

struct MeasureSettings {
  std::uint32_t viewpoints = 900;
  double min_distance = 2, max_distance = 5;
  std::uint32_t size = 1024;
  std::uint64_t seed = 20180501;
  std::uint32_t cache_size = 20;
  double alpha = 0.5;
  Baselines baselines{};
};

enum class MethodKind { orders, baseline };

// Caches that every method's ACMR is reported for, so that a reader sees what tuning for one size costs with
// another.
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

struct MethodReport {
  MethodKind kind = MethodKind::orders;
  std::uint32_t buffers = 1;
  std::uint64_t memory_bytes = 0;     // index data when drawn
  std::uint64_t auxiliary_bytes = 0;  // what else it needs: tables, planes, trees, centroids, new vertices
  double build_seconds = -1;          // wall time of making it in this run; < 0: nothing was made
  double nanoseconds_per_frame = 0;   // CPU work before a frame can be drawn
  double triangles_submitted = 0;     // per frame, facing twins counted
  double plane_tests = 0;             // per frame
  std::uint64_t splits = 0;           // triangles and pieces that were cut in two
  BufferStatistics fifo;              // all buffers pooled
  double acmr_lru = 0;
  std::array<double, kReportedCaches.size()> acmr_by_cache{};
  double atvr = 0;
  double overdraw = 0;
  MethodQuality quality;  // carries the name
};

struct PrimitiveMeasureReport {
  std::string name;
  std::uint64_t triangles = 0, vertices = 0;
  std::vector<MethodReport> methods;  // the order sets first, then the baselines
  std::vector<std::string> notes;     // what was asked for and left out, and why
};

// Measure every subject that has orders, and beside them the rivals of the first subject's mesh: `original`
// (the triangle order of `original`, drawn as viewers draw it: later triangles over earlier ones; null: left
// out), `base` (the best single order of the set), `cache_optimized` (meshoptimizer's unconstrained vertex
// cache order of all triangles), `cache_optimized_twins` (the same of every buffer of the set, with the nodes
// that it holds: what its constraints cost), `centroid_sort` (sorted for every frame), `bsp` (walk of a
// binary space partition) and `dptl` (depth-presorted triangle lists). The first subject decides the facing.
PrimitiveMeasureReport measure_subjects(std::span<const MeasureSubject> subjects, const Mesh* original,
                                        const std::string& name, const MeasureSettings& settings,
                                        Progress* progress);
// Viewpoints that overdraw is counted on: the first of those that quality is measured on.
std::uint32_t overdraw_viewpoints(const MeasureSettings& settings);

// Ranks of all nodes when the order set is drawn from a viewpoint: its order, or the base order inside
// valid_from.
std::vector<std::uint32_t> ranks_from(const Mesh& mesh, const OrderSet& orders, const Viewpoint& viewpoint);
// Ranks of both facings when whole triangles are drawn front to back in this sequence.
std::vector<std::uint32_t> ranks_of_triangles(std::span<const std::uint32_t> sequence,
                                              std::uint64_t triangle_count);
// The triangle order of the file as viewers blend it: the last triangle is the nearest.
std::vector<std::uint32_t> ranks_as_stored(std::uint64_t triangle_count);
// Baseline: triangles in meshoptimizer's vertex cache order, which knows nothing of depth.
std::vector<std::uint32_t> cache_optimized_sequence(const Mesh& mesh);
// The same nodes in meshoptimizer's vertex cache order.
NodeSequence cache_optimized_nodes(const Mesh& mesh, const NodeSequence& nodes);

// -------------------------------------------------------- measuring overdraw orders beside baselines

// A key frame of the subject: frame f of OverdrawSubject::frames shows clip `clip` at `time`.
struct PosedFrame {
  std::uint32_t clip = 0;
  double time = 0;
};

// Orders for all key frames of a model: one set for all clips ("joint"), or one for each ("per animation").
struct OverdrawSets {
  std::vector<OverdrawOrders> sets;
  std::vector<std::uint32_t> set_of;        // by frame
  std::vector<std::uint32_t> frame_in_set;  // by frame
  std::uint32_t view_level = 2;

  [[nodiscard]] std::uint32_t order_count() const;
};
// `joint`: one set; else one per clip, in the order of the clips.
OverdrawSets order_overdraw_sets(const OverdrawSubject& subject, const std::vector<PosedFrame>& frames,
                                 const OverdrawOptions& options, bool joint);

// A way of drawing the subject, measured beside others.
struct OverdrawRival {
  std::string name;  // "refined", "paper", "single", "per-frame", "meshopt", "original", "input"
  std::uint32_t buffers = 1;
  double acmr = 0;              // mean over its buffers
  OverdrawContender contender;  // holds its ranks by itself
};
OverdrawRival rival_of(const std::string& name, const OverdrawSubject& subject, OverdrawSets sets,
                       std::uint32_t cache_size);

struct RivalOptions {
  std::vector<std::string> names;  // of "input", "original", "meshopt", "per-frame", "single", "paper"
  OverdrawOptions orders;          // lambda, cache, buffers, seed: those of the orders they stand beside
  bool joint = true;
  double acmr = 0;          // meshopt: with the threshold that gives it at least so many misses per triangle
  std::vector<Vec3f> rest;  // vertices of the rest pose: what meshopt is given
};
std::vector<OverdrawRival> make_overdraw_rivals(const OverdrawSubject& subject,
                                                const std::vector<PosedFrame>& frames,
                                                const RivalOptions& options);
// meshopt_optimizeVertexCache and meshopt_optimizeOverdraw of every part.
std::vector<std::uint32_t> meshopt_overdraw_order(const OverdrawSubject& subject,
                                                  const std::vector<Vec3f>& rest, float threshold);

}  // namespace pellucid
