// From a partial order to a drawing sequence that keeps the vertex cache warm (section 4 of the paper).
//
// The paper's tipsify (tipsify.h), or ours: list scheduling (list_schedule.h), then a local search
// (gather_visits.h), then the same with the lightest constraints lifted, as long as the violated weight stays
// within a budget.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/sequencing.h"
#include "pellucid/transparency.h"
#include "transparency/graph/occlusion_graph.h"

namespace pellucid {

// Which nodes must come after a node. Acyclic.
struct SequenceConstraints {
  std::vector<std::uint32_t> offsets;  // nodes + 1
  std::vector<NodeId> followers;

  [[nodiscard]] std::span<const NodeId> followers_of(NodeId node) const {
    return std::span(followers).subspan(offsets[node], offsets[node + 1] - offsets[node]);
  }
};

// Edges whose two nodes are drawn, that agree with the ranks, and weigh at least `least`.
SequenceConstraints agreeing_edges(const EdgeRows& edges, std::span<const std::uint32_t> ranks,
                                   std::span<const std::uint8_t> drawn, float least);

// The transitive reduction: without the constraints that others imply. The same sequences, a hundredth of the
// constraints. `ranks` agree with all constraints. O(kept constraints * nodes / 64); memory: nodes * 1 KB.
SequenceConstraints without_implied(const SequenceConstraints& constraints,
                                    std::span<const std::uint32_t> ranks,
                                    std::span<const std::uint8_t> drawn);

// The drawn nodes by rank alone.
NodeSequence rank_sequence(std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn);

// Weight of the edges between drawn nodes that disagree with the ranks.
double violated_weight_of(const EdgeRows& edges, std::span<const std::uint32_t> ranks,
                          std::span<const std::uint8_t> drawn);

struct SequenceOptions {
  CacheMethod method = CacheMethod::scheduled;
  std::uint32_t cache_size = 20;  // FIFO entries, at least 3
  // Constraints lighter than this do not bind; 0: all do. tipsify: whatever that costs. scheduled: as long as
  // it stays within the slack, and heavier ones after them.
  float least_binding = 0;
  // scheduled: the weight that the sequence may violate beyond what the ranks do; 0: every constraint binds.
  double slack = 0;
  const Progress* progress = nullptr;  // may stop it
};

// All nodes with drawn[node] != 0. Never more vertex-cache misses than the rank order.
NodeSequence cache_aware_sequence(const Mesh& mesh, const EdgeRows& edges,
                                  std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn,
                                  const SequenceOptions& options);

}  // namespace pellucid
