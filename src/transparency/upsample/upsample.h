// From the order of a simplified mesh to an order of the full one (section 5 of the paper).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/sequencing.h"

namespace pellucid {

// For every facing of `fine` the facing of `coarse` that lies nearest to its centroid. Surfaces that face
// away from each other, the two sides of a thin wall, are told apart: the other side counts as four times as
// far.
std::vector<NodeId> nearest_coarse_nodes(const Mesh& fine, const Mesh& coarse);

// Sort keys of the fine nodes: the coarse node's rank, and within a group the depth key (see depth_keys).
std::vector<double> upsampled_keys(std::span<const NodeId> coarse_nodes,
                                   std::span<const std::uint32_t> coarse_ranks,
                                   std::span<const double> depth_keys);

}  // namespace pellucid
