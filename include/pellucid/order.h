// pellucid/order.h - module `order`: occlusion graph -> clusters of view cells -> triangle sequences.
//
// In: a clean Mesh and a ViewPartition. Out: an OrderSet, the in-depth buffers: a few sequences of all
// triangles and the table that says which of them draws correctly from which view cell.
// Follows: Han, Chen, Nehab, Sander, "In-Depth Buffers", PACMCGIT 1(1), 2018 (section numbers below), and
// goes beyond it with weighted edges and an error budget (docs/in-depth-buffers.md).
//
// A *node* is one facing of a triangle: 2 * triangle is the triangle as stored, 2 * triangle + 1 its flipped
// twin. From a viewpoint exactly one of the two faces the camera (section 2.2).
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/mesh.h"
#include "pellucid/raster.h"
#include "pellucid/view.h"

namespace pellucid {

class CheckpointStore;

using NodeId = std::uint32_t;
constexpr NodeId node_of(std::uint32_t triangle, bool flipped) {
  return 2 * triangle + (flipped ? 1 : 0);
}
constexpr std::uint32_t triangle_of(NodeId node) {
  return node / 2;
}
constexpr bool is_flipped(NodeId node) {
  return (node & 1U) != 0;
}
// Corners in drawing order: (a, b, c), flipped (a, c, b).
constexpr Triangle corners_of(const Mesh& mesh, NodeId node) {
  const Triangle& t = mesh.triangles[triangle_of(node)];
  return is_flipped(node) ? Triangle{t[0], t[2], t[1]} : t;
}

// ------------------------------------------------------------------------------------------- the result

// Which faces a mesh shows.
enum class Facing {
  single,      // back faces are culled: orders hold front facings only
  duplicated,  // both sides are drawn: orders hold the flipped twin of every triangle that can be seen from
               // behind
};

// Nodes front to back; every node at most once; every node that the cells of this order can see is in it.
using NodeSequence = std::vector<NodeId>;

// What an order set is for, and so what it promises.
enum class OrderPurpose {
  transparency,  // depth order: blending is right from every view of the cell
  overdraw,      // opaque faces: few fragments are shaded in vain; any order draws the right picture
};

// Which order draws an animated mesh: overdraw orders after Han, Sander, "Triangle Reordering for Efficient
// Rendering in Complex Scenes", JCGT 6(3), 2017, section 3.3.
struct KeyFrameTable {
  std::uint32_t animation = 0;  // glTF: animations[animation]
  std::vector<double> times;    // seconds, strictly increasing; the nearest one counts
  // Of the whole posed model at that time, in the space of its scene: directions are relative to it.
  std::vector<BoundingSphere> spheres;
  std::vector<std::uint32_t> cell_orders;  // times x cells, row by row: index into OrderSet::orders
};

struct OrderSet {
  OrderPurpose purpose = OrderPurpose::transparency;
  PartitionSpec partition;
  BoundingSphere sphere;  // of the mesh (overdraw: of the model at rest): viewpoints are relative to it
  double valid_from = 0;  // the orders hold for cameras at valid_from .. valid_to bounding radii
  double valid_to = kInfiniteDistance;
  Facing facing = Facing::duplicated;
  std::vector<NodeSequence> orders;
  std::vector<std::uint32_t> cell_orders;  // one per view cell: index into orders
  // The best single sequence for all views, each triangle exactly once, as stored (never flipped), BACK TO
  // FRONT: what a viewer without the order extension blends correctly most often, and what is drawn outside
  // the valid range. Overdraw: the single order with the least overdraw over all views, as it is drawn.
  std::vector<std::uint32_t> base_sequence;

  // Overdraw only. Patch p is the triangles base_sequence[patch_offsets[p] .. patch_offsets[p + 1]); every
  // order is a permutation of whole patches. Empty: every triangle is a patch.
  std::vector<std::uint32_t> patch_offsets;
  // Overdraw only, one per order: the place of this mesh among the meshes of its model when that order is
  // drawn. Empty: the meshes may be drawn in any sequence.
  std::vector<std::uint32_t> model_ranks;
  // Overdraw only: while one of these animations plays. cell_orders is for the model at rest.
  std::vector<KeyFrameTable> animations;
};

// Orders are made for clean meshes and kept for the meshes that these came from (CleanMesh::source).
// Triangle t of the orders becomes triangle source[t].
OrderSet lift_orders(OrderSet orders, std::span<const std::uint32_t> source);
// The inverse: triangle source[t] becomes t, nodes of triangles that `source` does not name are left out.
OrderSet restrict_orders(OrderSet orders, std::span<const std::uint32_t> source,
                         std::uint64_t source_triangles);

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
// How the nodes of an order are put into a sequence for the vertex cache (section 4).
enum class CacheMethod {
  scheduled,  // list scheduling and a local search, twins beside each other where they may be
  tipsify,    // the paper's
};
enum class Projection { perspective, orthographic };

struct OrderOptions {
  OrderMethod method = OrderMethod::budget;
  PartitionSpec partition{};
  // Distances of the samples in bounding radii (infinity allowed). Empty: the default spread, see
  // default_distances().
  std::vector<double> distances;
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
  std::optional<double> min_psnr;
  // budget, in the place of both: the fewest buffers, up to max_buffers, with which frames by verified
  // blending take hardly longer than with any number of them (verified_frame_time()).
  bool least_frame_time = false;
  std::uint32_t max_buffers = 16;  // budget: never more than this many
  std::uint32_t min_buffers = 1;   // budget: start here (equal to max_buffers: that many, but none unused)
  MergePriority priority = MergePriority::union_size;  // acyclic
  std::uint32_t fruitless_rounds = 5;                  // acyclic: relaxation stops after so many

  // Section 5: order the mesh simplified to so many triangles, carry the order over to all, and repair it
  // there. 0: never. Unset: above 24,000 triangles, from 10,000.
  std::optional<std::uint32_t> upsample_from;
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

// --------------------------------------------------------------------------------- run-time counterpart

// Index of the order that draws the mesh from a viewpoint (exact descent of pellucid/runtime/select.h).
// O(level) for S[n,m]; P[n] rebuilds its vertices, O(cells): programs that ask every frame use select.h
// itself.
std::uint32_t select_order(const OrderSet& set, const Vec3d& direction);

// The key frame nearest to a time (seconds), the earlier of two; NaN: the first. An animation that loops is
// the caller's. O(log times).
std::size_t nearest_key_frame(const KeyFrameTable& table, double time);
// Index of the order that draws the mesh at a key frame of set.animations[animation] from a direction
// relative to the sphere of that key frame: also for orthographic cameras.
std::uint32_t select_order(const OrderSet& set, std::size_t animation, std::size_t key_frame,
                           const Vec3d& direction);
// The same at a time of the animation for an eye in the space of the scene, at any distance: the answer of
// pellucid_select_animated.
std::uint32_t select_order_at(const OrderSet& set, std::size_t animation, double time, const Vec3d& eye);

// rank[node] = position in the sequence, kNoRank for nodes that it does not hold. Size 2 * triangles.
constexpr std::uint32_t kNoRank = std::numeric_limits<std::uint32_t>::max();
std::vector<std::uint32_t> ranks_of(std::span<const NodeId> sequence, std::uint64_t triangle_count);

// Is the drawing order of one pixel's fragments (sorted by depth) right? Wrong: a fragment's node has no
// rank, or a nearer fragment comes later. Fragments whose depths differ by no more than kDepthTie count as
// coincident: they may come in either order.
constexpr float kDepthTie = 1e-6F;  // of the 0..1 depth range
bool pixel_in_order(std::span<const Fragment> fragments, std::span<const std::uint32_t> ranks);

// Does verified blending (render.h) leave it as it is? Each fragment has to be drawn after all that are
// nearer, and none may lie at the depth of another one.
bool pixel_is_verified(std::span<const Fragment> fragments, std::span<const std::uint32_t> ranks);

struct PixelCount {
  std::uint64_t foreground = 0;  // pixels with at least one fragment
  std::uint64_t incorrect = 0;   // of these, pixels that are not in order: IPR = incorrect / foreground
  std::uint64_t repaired = 0;    // of these, pixels that are not verified
};
PixelCount count_incorrect_pixels(const FragmentBuffer& fragments, std::span<const std::uint32_t> ranks);

// Indices in drawing order, three per node.
std::vector<std::uint32_t> index_buffer(const Mesh& mesh, std::span<const NodeId> sequence);

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

}  // namespace pellucid
