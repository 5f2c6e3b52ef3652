// pellucid/sequencing.h - order sets, their use at run time, and vertex-cache statistics.
//
// In: triangle meshes and view partitions. Out: the types that all later modules share. The main one is
// OrderSet: a few orders of the triangles of a mesh, and a table that says which of them to draw from which
// view cell.
//
// A *node* is a triangle with a facing: 2 * triangle is the triangle as stored, and 2 * triangle + 1 is its
// flipped copy, which has the reverse winding. From any viewpoint exactly one of the two faces the camera.
// With back-face culling, an index buffer can therefore contain both, in different places (Han, Chen, Nehab,
// Sander, "In-Depth Buffers", PACMCGIT 1(1), 2018, section 2.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/mesh.h"
#include "pellucid/view.h"

namespace pellucid {

// ----------------------------------------------------------------------------------------------------- nodes

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
// Returns the corners of a node in the order in which they are drawn: (a, b, c), or (a, c, b) if it is
// flipped.
constexpr Triangle corners_of(const Mesh& mesh, NodeId node) {
  const Triangle& t = mesh.triangles[triangle_of(node)];
  return is_flipped(node) ? Triangle{t[0], t[2], t[1]} : t;
}

// The sides of a mesh that are visible.
enum class Facing {
  single,      // back faces are culled: orders contain no flipped copies
  duplicated,  // both sides are drawn: orders also contain the flipped copy of every triangle whose back can
               // be seen
};

// ------------------------------------------------------------------------------------------------ order sets

// A draw order: nodes from front to back. Each node occurs at most once. The order contains every node that
// can be seen from the view cells that use it.
using NodeSequence = std::vector<NodeId>;

// In which direction the triangles of an order are stored or drawn: front to back for "under" blending and
// for opaque meshes, back to front for the usual "over" blending.
enum class SortDirection { front_to_back, back_to_front };

// What an order set is for, and therefore what it guarantees.
enum class OrderPurpose {
  transparency,  // depth order: alpha blending is correct from every view of a cell
  overdraw,  // opaque faces with a depth test: the order reduces overdraw; the image is correct in any order
};

// The orders of an animated mesh, per key frame and view cell. Only for overdraw. Based on: Han, Sander,
// "Triangle Reordering for Efficient Rendering in Complex Scenes", JCGT 6(3), 2017, section 3.3.
struct KeyFrameTable {
  std::uint32_t animation = 0;  // glTF: animations[animation]
  std::vector<double> times;    // seconds, strictly increasing; the nearest key frame is used
  // One per key frame: the bounding sphere of the whole posed model, in the space of its scene. Directions
  // are relative to its centre.
  std::vector<BoundingSphere> spheres;
  std::vector<std::uint32_t> cell_orders;  // key frames x view cells, row by row: index into OrderSet::orders
};

// A few orders of the triangles of one mesh, and the table that says which of them to draw.
struct OrderSet {
  OrderPurpose purpose = OrderPurpose::transparency;
  PartitionSpec partition;
  // Viewpoints are relative to this sphere. Transparency: of the mesh. Overdraw: of the whole model at rest.
  BoundingSphere sphere;
  // The orders are valid for cameras at valid_from .. valid_to bounding radii from the centre of the sphere.
  double valid_from = 0;
  double valid_to = kInfiniteDistance;
  Facing facing = Facing::duplicated;
  std::vector<NodeSequence> orders;
  std::vector<std::uint32_t> cell_orders;  // one per view cell: index into orders
  // The best single order for all views. It contains each triangle exactly once, as stored, and is in draw
  // order. Transparency: from BACK TO FRONT. Viewers without the order extension use it, and so do all
  // viewers outside of the valid range. Overdraw: the single order with the least overdraw over all views.
  std::vector<std::uint32_t> base_sequence;

  // Overdraw only. Patch p consists of the triangles base_sequence[patch_offsets[p] .. patch_offsets[p + 1]).
  // Every order is a permutation of whole patches. If empty, every triangle is a patch.
  std::vector<std::uint32_t> patch_offsets;
  // Overdraw only. One per order: the place of this mesh among the meshes of its model when that order is
  // drawn. If empty, the meshes may be drawn in any order.
  std::vector<std::uint32_t> model_ranks;
  // Overdraw only: the orders while one of these animations plays. cell_orders is for the model at rest.
  std::vector<KeyFrameTable> animations;
};

// Converts orders of a clean mesh to orders of the mesh that it came from: triangle t becomes source[t], see
// CleanMesh::source.
OrderSet lift_orders(OrderSet orders, std::span<const std::uint32_t> source);
// Converts in the opposite direction: triangle source[t] becomes t. Removes the nodes of triangles that are
// not in `source`.
OrderSet restrict_orders(OrderSet orders, std::span<const std::uint32_t> source,
                         std::uint64_t source_triangles);

// ------------------------------------------------------------------------------------------- use at run time

// Returns the index of the order for a view direction, by the descent of pellucid/runtime/select.h. Takes
// O(level) for triangular cells. For P[n] it rebuilds the partition in O(cells), so programs that select in
// every frame should use select.h.
std::uint32_t select_order(const OrderSet& set, const Vec3d& direction);

// Returns the key frame nearest to a time in seconds: the earlier one of two at the same distance, and the
// first one for NaN. The caller maps the time of a looping animation to its duration. Takes O(log key
// frames).
std::size_t nearest_key_frame(const KeyFrameTable& table, double time);
// Returns the index of the order at a key frame of set.animations[animation] for a direction from the centre
// of the sphere of that key frame. Also for orthographic cameras.
std::uint32_t select_order(const OrderSet& set, std::size_t animation, std::size_t key_frame,
                           const Vec3d& direction);
// Returns the index of the order at a time of an animation for an eye in the space of the scene at any
// distance. Gives the same result as pellucid_select_animated().
std::uint32_t select_order_at(const OrderSet& set, std::size_t animation, double time, const Vec3d& eye);

// The rank of a node that an order does not contain.
constexpr std::uint32_t kNoRank = std::numeric_limits<std::uint32_t>::max();
// Returns the position of every node in an order, or kNoRank. The result has 2 * triangle_count entries.
std::vector<std::uint32_t> ranks_of(std::span<const NodeId> order, std::uint64_t triangle_count);

// Returns the bytes of an index into this many vertices: 2 for at most 65,535 vertices, else 4. No 16-bit
// index buffer may hold the value 65535, because it restarts a strip wherever primitive restart is on.
constexpr std::uint32_t bytes_per_index(std::uint64_t vertex_count) {
  return vertex_count <= 65535 ? 2 : 4;
}
// Returns the index buffer of an order: three vertex indices per node.
std::vector<std::uint32_t> index_buffer(const Mesh& mesh, std::span<const NodeId> order);

// ---------------------------------------------------------------------------------------------- vertex cache

// How a draw order is arranged for the vertex cache (In-Depth Buffers, section 4).
enum class CacheMethod {
  scheduled,  // list scheduling and a local search, which draw flipped copies next to each other where
              // possible
  tipsify,    // the method of the paper
};

// The replacement policy of a vertex cache: first in first out, or least recently used.
enum class CacheModel { fifo, lru };

struct CacheStatistics {
  std::uint64_t misses = 0;
  // Average cache miss ratio: misses per triangle. Best about 0.5, or 0.25 if every triangle has its flipped
  // copy in the buffer; worst 3.
  double acmr = 0;
  // Average transform to vertex ratio: misses per distinct vertex. Best 1.
  double atvr = 0;
};
// Simulates a vertex cache of `cache_size` (>= 3) vertices. `indices` has three indices per triangle. Takes
// O(indices) for a FIFO cache and O(indices * cache_size) for an LRU cache. Throws Error{bad_argument} for a
// smaller cache, for an incomplete triangle and for an index out of range.
CacheStatistics simulate_vertex_cache(std::span<const std::uint32_t> indices, std::uint32_t vertex_count,
                                      CacheModel model, std::uint32_t cache_size);

// How one index buffer uses a vertex cache.
struct BufferStatistics {
  std::uint64_t triangles = 0;  // in the buffer, including flipped copies
  std::uint64_t misses = 0;
  double acmr = 0;  // misses per triangle of the buffer
  // Misses per distinct triangle. This is the cost per drawn triangle, because the copy that faces away is
  // culled after its vertices have been transformed.
  double acmr_drawn = 0;
};
// Returns the statistics of one order. Throws as simulate_vertex_cache().
BufferStatistics sequence_statistics(const Mesh& mesh, std::span<const NodeId> order, CacheModel model,
                                     std::uint32_t cache_size);
// Returns the statistics of every order of a set.
std::vector<BufferStatistics> buffer_statistics(const Mesh& mesh, const OrderSet& orders, CacheModel model,
                                                std::uint32_t cache_size);
// Returns the statistics of all buffers together: the sums of their counts, and the ratios of these sums.
BufferStatistics pooled(std::span<const BufferStatistics> buffers);

// Returns the misses of a first-in first-out vertex cache for an order of triangles.
std::uint64_t cache_misses(std::span<const Triangle> triangles, std::span<const std::uint32_t> order,
                           std::uint32_t vertex_count, std::uint32_t cache_size);

}  // namespace pellucid
