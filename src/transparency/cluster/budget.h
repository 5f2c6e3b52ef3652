// Clustering by budget: k orders for all view cells with as little violated weight as can be found.
//
// k-means over orders: (1) every cluster orders the summed edges of its cells by
// sifting, (2) every cell moves to the order that violates least of it. No acyclicity and no tolerance is
// needed; the error is a dial.
#pragma once

#include <cstdint>
#include <vector>

#include "pellucid/view.h"
#include "sequencing/k_orders.h"
#include "sequencing/linear_order.h"
#include "transparency/cluster/contiguity.h"
#include "transparency/graph/occlusion_graph.h"

namespace pellucid {

// Where every node lies along the view directions of some cells: its mean depth, the classical painter's key.
// Smaller is nearer. One value per node.
std::vector<double> depth_keys(const Mesh& mesh, const BoundingSphere& sphere, const ViewPartition& partition,
                               std::span<const std::uint32_t> cells);

struct KMeansOptions {
  std::uint32_t rounds = 40;
  SiftOptions sift;
  double least_gain = 1e-3;  // stop when a round lowers the violated weight by less than this share
  // Rounds but the last leave out a cluster's edges lighter than this per cell: most edges, little weight.
  float light = 0;
  // In the end cells may go to their neighbours' orders; needs the partition.
  ContiguityOptions contiguity;
  const ViewPartition* partition = nullptr;
  Progress* progress = nullptr;
};

// Alternate (1) and (2) from `start`, whose ranks must be filled; never ends worse than it starts but by what
// `contiguity` allows.
Clustering improve_clustering(const OcclusionGraph& graph, Clustering start, const KMeansOptions& options);

// A start for k clusters: cells by the nearest of k spread-out random directions, orders by depth. Contiguous
// starts converge in a few rounds to a fraction of the error of starts that join opposite views
// (docs/in-depth-buffers.md).
Clustering spread_start(const OcclusionGraph& graph, const Mesh& mesh, const BoundingSphere& sphere,
                        const ViewPartition& partition, std::uint32_t cluster_count, std::uint64_t seed);

// Violated weight of every cell under every order: cells x orders, row by row.
std::vector<double> violation_table(const OcclusionGraph& graph,
                                    const std::vector<std::vector<std::uint32_t>>& ranks);

}  // namespace pellucid
