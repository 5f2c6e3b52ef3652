// Which cells cannot share an order whatever the method: those with opposite edges. They bound the number of
// acyclic clusters from below.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "transparency/cluster/edge_set.h"

namespace pellucid {

// The cells of a greedy clique of the graph "has an edge whose reverse the other has": so many orders without
// a violation are needed at least. `cells`: all edges of every cell that are to be kept, each set acyclic;
// those that others imply may be left out, at the price of a lower bound. O(edges + cells^2 * pairs / 64).
std::vector<std::uint32_t> contradicting_cells(const EdgeTable& table, std::span<const EdgeSet> cells);

}  // namespace pellucid
