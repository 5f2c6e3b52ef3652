// Cycles of directed graphs in rows: node n's edges lead to targets[offsets[n]] .. targets[offsets[n + 1] -
// 1].
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "transparency/graph/occlusion_graph.h"

namespace pellucid {

// O(nodes + edges).
bool has_cycle(std::span<const std::uint32_t> offsets, std::span<const std::uint32_t> targets);

// Per node the number of its strongly connected component; numbers are a reverse topological order: edges
// between components lead to smaller numbers. Tarjan, "Depth-first search and linear graph algorithms", SIAM
// J. Comput. 1972, without recursion. O(nodes + edges).
std::vector<std::uint32_t> strong_components(std::span<const std::uint32_t> offsets,
                                             std::span<const std::uint32_t> targets);

// View cells whose own edges are cyclic.
std::uint32_t count_cyclic_cells(const OcclusionGraph& graph);

}  // namespace pellucid
