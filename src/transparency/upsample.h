// Carries orders from a simplified mesh to the full one (In-Depth Buffers, section 5), and repairs them
// there. In: the ranks of the coarse nodes. Out: ranks of the fine nodes, and the edges that bind them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/sequencing.h"
#include "pellucid/transparency.h"
#include "pellucid/view.h"
#include "sequencing/cache_order.h"
#include "transparency/graph/occlusion_graph.h"
#include "transparency/run_records.h"

namespace pellucid {

// Returns, for every facing of `fine`, the facing of `coarse` that lies nearest to its centroid. A surface
// that faces the other way counts as four times as far, so that the two sides of a thin wall are not
// confused.
std::vector<NodeId> nearest_coarse_nodes(const Mesh& fine, const Mesh& coarse);

// Returns sort keys of the fine nodes: the rank of the coarse node, and the depth key (see depth_keys) among
// the fine nodes of the same coarse node.
std::vector<double> upsampled_keys(std::span<const NodeId> coarse_nodes,
                                   std::span<const std::uint32_t> coarse_ranks,
                                   std::span<const double> depth_keys);

// ---------------------------------------------------------------------------------------------------- repair

// The occlusion graphs of all cells of a large mesh do not fit in memory. They are not needed, because a
// carried order is right for nearly all pairs. A raster finds the nodes that are in a wrong order from some
// sample of their cluster. Only these nodes move. All edges that they have in the rasters are known when they
// are sifted.

struct RefineOptions {
  std::uint32_t rounds = 1;  // 0: leave the orders as they are
  std::uint32_t raster_size = 1024;
  std::vector<double> distances;
  double alpha = 0;  // OrderOptions::alpha
  bool front_only = false;
  Progress* progress = nullptr;
  RunRecords records{};  // keeps the result of every round
};

// Returns the length of the runs, in ranks, within which an order of `node_count` nodes is rearranged for the
// vertex cache.
std::uint32_t refine_window(std::uint64_t node_count);

// Improves `ranks` (one permutation of the nodes per cluster) in place. Returns for every cluster the edges
// that agree with the final ranks and span less than refine_window() of them; these bind windowed_sequence().
// Takes O((2 rounds + 1) * samples * (pixels + triangles)) time, and 16 bytes for each edge of one pass.
std::vector<EdgeRows> refine_orders(const Mesh& mesh, const BoundingSphere& sphere,
                                    const PartitionSpec& partition,
                                    const std::vector<std::uint32_t>& cluster_of,
                                    const RefineOptions& options,
                                    std::vector<std::vector<std::uint32_t>>& ranks);

// Returns the nodes with drawn[node] != 0 by rank, rearranged for the vertex cache inside runs of
// refine_window() ranks, in which all edges are known.
NodeSequence windowed_sequence(const Mesh& mesh, const EdgeRows& edges, std::span<const std::uint32_t> ranks,
                               std::span<const std::uint8_t> drawn, const CacheOrderOptions& options);

}  // namespace pellucid
