// pellucid/sequencing.h - module `sequencing`: orders of triangles, and the vertex cache that draws them.
//
// In: triangle meshes and view partitions. Out: the types that every later module works on, an OrderSet first
// of all: a few orders of the triangles of a mesh, and the table that says which of them to draw from which
// view cell.
//
// A *node* is one facing of a triangle: 2 * triangle is the triangle as stored, 2 * triangle + 1 its flipped
// twin. From a viewpoint exactly one of the two faces the camera (Han, Chen, Nehab, Sander, "In-Depth
// Buffers", PACMCGIT 1(1), 2018, section 2.2).
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/mesh.h"
#include "pellucid/view.h"

namespace pellucid {

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

// In which direction the triangles of an order are stored or drawn: front to back for "under" blending and
// for opaque meshes, back to front for the usual "over" blending.
enum class SortDirection { front_to_back, back_to_front };

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

// Returns the bytes of an index into this many vertices: 2 for at most 65,535 vertices, else 4. No 16-bit
// index buffer may hold the value 65535, because it restarts a strip wherever primitive restart is on.
constexpr std::uint32_t bytes_per_index(std::uint64_t vertex_count) {
  return vertex_count <= 65535 ? 2 : 4;
}
// Indices in drawing order, three per node.
std::vector<std::uint32_t> index_buffer(const Mesh& mesh, std::span<const NodeId> sequence);

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

// How one index buffer uses a vertex cache.
struct BufferStatistics {
  std::uint64_t triangles = 0;  // in the list, facing twins counted
  std::uint64_t misses = 0;
  double acmr = 0;        // misses per triangle of the list
  double acmr_drawn = 0;  // misses per distinct triangle: the twin that faces away is culled, yet transformed
};
BufferStatistics sequence_statistics(const Mesh& mesh, std::span<const NodeId> sequence, CacheModel model,
                                     std::uint32_t cache_size);
std::vector<BufferStatistics> buffer_statistics(const Mesh& mesh, const OrderSet& orders, CacheModel model,
                                                std::uint32_t cache_size);
// All buffers as one: ratios over the sums.
BufferStatistics pooled(std::span<const BufferStatistics> buffers);

// Misses of a first-in first-out vertex cache for triangles in this sequence.
std::uint64_t cache_misses(std::span<const Triangle> triangles, std::span<const std::uint32_t> sequence,
                           std::uint32_t vertex_count, std::uint32_t cache_size);

}  // namespace pellucid
