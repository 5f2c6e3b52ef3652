// From a partial order to a drawing sequence that keeps the vertex cache warm (section 4 of the paper).
//
// Tipsify (Sander, Nehab, Barczak, "Fast Triangle Reordering for Vertex Locality and Reduced Overdraw",
// SIGGRAPH 2007) over the ready set: only nodes all of whose predecessors are drawn may be drawn.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "occlusion_graph.h"
#include "pellucid/order.h"

namespace pellucid {

// The constraints of a sequence: edges whose two nodes are drawn, that agree with the ranks, and weigh at
// least `least`. Acyclic by construction.
struct SequenceConstraints {
  std::vector<std::uint32_t> offsets;  // nodes + 1
  std::vector<NodeId> followers;       // nodes that must come later
};
SequenceConstraints agreeing_edges(const EdgeRows& edges, std::span<const std::uint32_t> ranks,
                                   std::span<const std::uint8_t> drawn, float least);

// All nodes with drawn[node] != 0, in an order that violates no constraint. `ranks` breaks dead ends. O(nodes
// + edges) and a heap. cache_size: FIFO entries.
NodeSequence cache_aware_sequence(const Mesh& mesh, const SequenceConstraints& constraints,
                                  std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn,
                                  std::uint32_t cache_size);

// The same nodes by rank alone.
NodeSequence rank_sequence(std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn);

}  // namespace pellucid
