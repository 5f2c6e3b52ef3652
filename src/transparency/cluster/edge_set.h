// Represents the edges of view cells and of clusters as sets of ids, over one table of all distinct edges.
// In: an occlusion graph. Out: sets without implied edges, and topological orders of their unions.
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
// Returns `edges` without those that a path of two others implies. The result has fewer edges and allows the
// same orders. `edges` must be acyclic. Takes O(sum of the out-degrees of all followers).
EdgeSet without_shortcuts(const EdgeTable& table, const EdgeSet& edges);
EdgeSet unite(const EdgeSet& a, const EdgeSet& b);
EdgeSet unite_all(const EdgeTable& table, std::span<const EdgeSet* const> sets);
std::uint64_t intersection_size(const EdgeSet& a, const EdgeSet& b);

// Finds a topological order, as ranks. Returns false if the edges have a cycle. Takes O(nodes +
// edges).
bool topological_ranks(const EdgeTable& table, const EdgeSet& edges, std::vector<std::uint32_t>& ranks);

// Extends `ranks`, a topological order of `base`, to one of the union of `base` and `added`. Returns false,
// and leaves `ranks` unchanged, when the union has a cycle. A cycle can lie only in the window of ranks
// between the edges of `added` that disagree (as in Pearce and Kelly, "A dynamic topological sort algorithm
// for directed acyclic graphs", JEA 2006, here for many edges at once).
bool extend_ranks(const EdgeTable& table, const EdgeSet& base, const EdgeSet& added,
                  std::vector<std::uint32_t>& ranks);

// Returns cells that contradict each other pairwise: two cells contradict each other if one has an edge whose
// reverse the other has. No two of them can share an order without a violation, so their number is a lower
// bound of the number of acyclic clusters. They are found as a greedy clique. `cells` has the kept edges of
// every cell, each set acyclic; edges that others imply may be left out, which can only lower the bound.
// Takes O(edges + cells^2 * pairs / 64).
std::vector<std::uint32_t> contradicting_cells(const EdgeTable& table, std::span<const EdgeSet> cells);

}  // namespace pellucid
