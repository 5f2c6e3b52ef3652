// Turns a partial order into a draw order with few vertex-cache misses. In: a mesh, the edges that a draw
// order should respect, and an order that respects them. Out: an order of the same nodes that uses the vertex
// cache better.
//
// Based on: section 4 of Han, Chen, Nehab, Sander, "In-Depth Buffers", PACMCGIT 1(1), 2018. There are two
// methods. The paper uses tipsify under constraints. The other method is list scheduling, followed by a local
// search, which is repeated without the lightest constraints as long as the violated weight stays within a
// given slack.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/sequencing.h"
#include "sequencing/edge_rows.h"

namespace pellucid {

// In this header, `drawn` has one flag per node that says whether the node is part of the order. `ranks` has
// the rank of every node in an order; where constraints are given, this order respects them. `cache_size` is
// the number of vertices in a first-in first-out cache.

// ----------------------------------------------------------------------------------------------- constraints

// The nodes that must come after each node. Acyclic.
struct OrderConstraints {
  std::vector<std::uint32_t> offsets;  // nodes + 1
  std::vector<NodeId> followers;

  [[nodiscard]] std::span<const NodeId> followers_of(NodeId node) const {
    return std::span(followers).subspan(offsets[node], offsets[node + 1] - offsets[node]);
  }
};

// Returns the edges between drawn nodes that agree with the ranks and weigh at least `least`.
OrderConstraints agreeing_edges(const EdgeRows& edges, std::span<const std::uint32_t> ranks,
                                std::span<const std::uint8_t> drawn, float least);

// Returns the transitive reduction, which has no constraints that others imply. It permits the same orders
// with about a hundredth of the constraints. Takes O(kept constraints * nodes / 64) time and 1 KB per node.
OrderConstraints without_implied(const OrderConstraints& constraints, std::span<const std::uint32_t> ranks,
                                 std::span<const std::uint8_t> drawn);

// Returns the weight of the edges between drawn nodes that disagree with the ranks.
double violated_weight_of(const EdgeRows& edges, std::span<const std::uint32_t> ranks,
                          std::span<const std::uint8_t> drawn);

// ----------------------------------------------------------------------------------------------- the methods

// Returns the drawn nodes sorted by rank.
NodeSequence order_by_rank(std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn);

// Returns the drawn nodes in an order that violates no constraint, by tipsify under constraints. `ranks`
// resolves dead ends. Takes O(nodes + edges) and the operations of a heap.
NodeSequence tipsify(const Mesh& mesh, const OrderConstraints& constraints,
                     std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn,
                     std::uint32_t cache_size);

// Returns the drawn nodes in an order that violates no constraint, by list scheduling: of all nodes that may
// be drawn next, the one with the best score is drawn. `ranks` breaks ties and resolves dead ends. A node
// whose vertices are all in the cache, often the flipped copy of the last one, is drawn at once, because it
// costs nothing and may permit others. Takes O(nodes * cache_size * valence + edges).
NodeSequence list_schedule(const Mesh& mesh, const OrderConstraints& constraints,
                           std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn,
                           std::uint32_t cache_size);

// Improves an order that respects the constraints by a local search. The result respects the constraints,
// too, and never has more misses. Takes O(sweeps * nodes * valence^2 + edges). Deterministic. `progress`,
// which may be null, may request a stop.
NodeSequence gather_visits(const Mesh& mesh, const OrderConstraints& constraints, NodeSequence order,
                           std::uint32_t cache_size, const Progress* progress = nullptr);

struct CacheOrderOptions {
  CacheMethod method = CacheMethod::scheduled;
  std::uint32_t cache_size = 20;  // vertices, at least 3
  // Constraints lighter than this do not bind; 0: all constraints bind. tipsify ignores the lighter ones
  // completely. scheduled ignores them only as long as the violated weight stays within the slack, and then
  // also heavier ones.
  float least_binding = 0;
  // scheduled: the weight that the order may violate in addition to what the ranks violate. 0: every
  // constraint binds.
  double slack = 0;
  const Progress* progress = nullptr;  // may be null; may request a stop
};

// Returns the drawn nodes in an order for the vertex cache. It never has more misses than the order by rank.
NodeSequence cache_aware_order(const Mesh& mesh, const EdgeRows& edges, std::span<const std::uint32_t> ranks,
                               std::span<const std::uint8_t> drawn, const CacheOrderOptions& options);

// ----------------------------------------------------------------------------------------- vertices to nodes

// The drawn nodes that use each vertex.
class VertexNodes {
 public:
  VertexNodes(const Mesh& mesh, std::span<const std::uint8_t> drawn);

  // Returns the nodes that use a vertex, in ascending order.
  [[nodiscard]] std::span<const NodeId> of(std::uint32_t vertex) const {
    return std::span(nodes_).subspan(offsets_[vertex], offsets_[vertex + 1] - offsets_[vertex]);
  }

 private:
  std::vector<std::uint32_t> offsets_;  // vertices + 1
  std::vector<NodeId> nodes_;
};

}  // namespace pellucid
