// Unweighted edge sets of view cells and clusters of them, over one table of all distinct edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "transparency/graph/occlusion_graph.h"

namespace pellucid {

// All distinct edges of an occlusion graph; edge ids are sorted by (front, back).
struct EdgeTable {
  std::vector<std::uint32_t> row_ids;  // nodes + 1: first id of every front node
  std::vector<NodeId> backs;           // per id
  std::vector<std::uint32_t> reverse;  // per id: the id of (back, front), kNoEdge where no cell has it
};
constexpr std::uint32_t kNoEdge = 0xFFFFFFFFU;
EdgeTable make_edge_table(const OcclusionGraph& graph);

// A set of edges: sorted ids, with the place where every front node's ids begin.
struct EdgeSet {
  std::vector<std::uint32_t> rows;  // nodes + 1
  std::vector<std::uint32_t> ids;
  [[nodiscard]] std::uint64_t size() const { return ids.size(); }
};
EdgeSet edges_of_cell(const EdgeTable& table, const CompactRows& cell);
// Without the edges that a path of two others implies: fewer edges, the same orders. `edges` must be acyclic.
// O(sum of the out-degrees of all followers).
EdgeSet without_shortcuts(const EdgeTable& table, const EdgeSet& edges);
EdgeSet unite(const EdgeSet& a, const EdgeSet& b);
EdgeSet unite_all(const EdgeTable& table, std::span<const EdgeSet* const> sets);
std::uint64_t intersection_size(const EdgeSet& a, const EdgeSet& b);

// A topological order as ranks; false when the edges have a cycle. O(nodes + edges).
bool topological_ranks(const EdgeTable& table, const EdgeSet& edges, std::vector<std::uint32_t>& ranks);

// `ranks` is a topological order of `base`. Make it one of base U added; false (and ranks unchanged) when
// that has a cycle. Only the window of ranks between the edges of `added` that disagree can hold a cycle (as
// in Pearce and Kelly, "A dynamic topological sort algorithm for directed acyclic graphs", JEA 2006, here for
// many edges at once).
bool extend_ranks(const EdgeTable& table, const EdgeSet& base, const EdgeSet& added,
                  std::vector<std::uint32_t>& ranks);

}  // namespace pellucid
