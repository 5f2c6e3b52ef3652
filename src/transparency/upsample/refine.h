// Repair of orders that were carried from a simplified mesh to the full one: multi-resolution ordering.
//
// The occlusion graphs of all cells of a large mesh do not fit in memory, and need not: a carried order is
// right for nearly all pairs. Nodes that are in a wrong order from some sample of their cluster are looked
// for by raster; only they may move, and all that they meet in the rasters is known when they are sifted.
#pragma once

#include <cstdint>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/sequencing.h"
#include "pellucid/transparency.h"
#include "pellucid/view.h"
#include "sequencing/cache_order.h"
#include "transparency/graph/occlusion_graph.h"
#include "transparency/run_records.h"

namespace pellucid {

struct RefineOptions {
  std::uint32_t rounds = 1;  // 0: leave the orders as they are
  std::uint32_t raster_size = 1024;
  std::vector<double> distances;
  double alpha = 0;  // OrderOptions::alpha
  bool front_only = false;
  Progress* progress = nullptr;
  RunRecords records{};  // of every round
};

// Ranks, for a mesh of so many nodes: a sequence is rearranged for the vertex cache within runs of so many.
std::uint32_t refine_window(std::uint64_t node_count);

// Improve `ranks` (per cluster, per node: permutations) in place. Returns per cluster the edges that agree
// with the final ranks and span less than refine_window() of them: what binds windowed_sequence(). O((2
// rounds + 1) * samples * (pixels + triangles)); memory: the edges of one pass, 16 bytes each.
std::vector<EdgeRows> refine_orders(const Mesh& mesh, const BoundingSphere& sphere,
                                    const PartitionSpec& partition,
                                    const std::vector<std::uint32_t>& cluster_of,
                                    const RefineOptions& options,
                                    std::vector<std::vector<std::uint32_t>>& ranks);

// The nodes with drawn[node] != 0 by rank, rearranged for the vertex cache inside runs of refine_window()
// ranks, where all edges are known.
NodeSequence windowed_sequence(const Mesh& mesh, const EdgeRows& edges, std::span<const std::uint32_t> ranks,
                               std::span<const std::uint8_t> drawn, const CacheOrderOptions& options);

}  // namespace pellucid
