// What orders cannot avoid: lower bounds on the violated weight.
#pragma once

#include <cstdint>
#include <span>

#include "transparency/cluster/budget.h"
#include "transparency/graph/occlusion_graph.h"

namespace pellucid {

// A weight that every order of `edges` (rows sorted by back node) violates at least. `ranks`, a good order,
// says where to look: the closer it is to the best one, the tighter the bound. O(edges) and, for each edge
// that `ranks` violates, O(degree^2).
double unavoidable_weight(const EdgeRows& edges, std::span<const std::uint32_t> ranks);

// The same for every cell under an order of its own, summed: no number of buffers violates less.
double unavoidable_in_cells(const OcclusionGraph& graph, const Clustering& clustering);

}  // namespace pellucid
