// Groups view cells into clusters that share one order. In: an OrderProblem. Out: a Clustering, that is, the
// cluster of every cell and the ranks of all nodes in the order of every cluster.
//
// There are two methods. The error-budget method (error_budget.cpp) accepts some violated weight, and finds
// the fewest orders that meet an error. The acyclic method of the paper (acyclic.cpp) accepts none.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "metric/validation.h"
#include "pellucid/transparency.h"
#include "pellucid/view.h"
#include "sequencing/k_orders.h"
#include "sequencing/linear_order.h"
#include "transparency/cluster/error_target.h"
#include "transparency/graph/occlusion_graph.h"
#include "transparency/order_problem.h"
#include "transparency/run_records.h"

namespace pellucid {

// ---------------------------------------------------------------------------------------- contiguous regions
//
// A camera that crosses a border between cells of different orders switches buffers. Fewer and shorter
// borders mean fewer switches in an orbit. Where the errors are nearly equal they cost nothing.

struct ContiguityOptions {
  // A cell may violate this share more than before. 0: every cell keeps its order.
  double share = 0;
  // A cell may in any case violate this much more (square radii), because no pixel shows it.
  double floor = 0;
};

// Moves cells and whole regions to the orders of their neighbours while fewer neighbours differ. Splits no
// region, and leaves no order without cells. `costs` is the violated weight of every cell under every order:
// cells x orders, row by row. Changes `cluster_of` and returns the violated weight.
double join_neighbors(const ViewPartition& partition, std::span<const double> costs,
                      std::uint32_t order_count, const ContiguityOptions& options,
                      std::vector<std::uint32_t>& cluster_of);

// The region of every cell. A region is a set of connected cells of the same order; regions are numbered by
// their first cells.
struct Regions {
  std::vector<std::uint32_t> region_of;
  std::uint32_t count = 0;
};
Regions find_regions(const ViewPartition& partition, std::span<const std::uint32_t> cluster_of);

// Returns how often the order changes while the camera goes once around: the mean over great circles.
double switches_per_turn(const ViewPartition& partition, std::span<const std::uint32_t> cluster_of);

// --------------------------------------------------------------------------------------- k-means over orders
//
// Finds k orders for all view cells with as little violated weight as possible. Two steps alternate: (1)
// every cluster orders the summed edges of its cells by sifting; (2) every cell moves to the order that
// violates the least of its edges. The method needs no acyclic graph and no tolerance.

// Returns one value per node: its mean depth along the view directions of some cells, the key of the
// painter's algorithm. Smaller is nearer.
std::vector<double> depth_keys(const Mesh& mesh, const BoundingSphere& sphere, const ViewPartition& partition,
                               std::span<const std::uint32_t> cells);

struct KMeansOptions {
  std::uint32_t rounds = 40;
  SiftOptions sift;
  double least_gain = 1e-3;  // stop when a round lowers the violated weight by less than this share
  // All rounds but the last leave out the edges of a cluster that are lighter than this per cell. These are
  // most of the edges, and little weight.
  float light = 0;
  // At the end, cells may go to the orders of their neighbours. This needs the partition.
  ContiguityOptions contiguity;
  const ViewPartition* partition = nullptr;
  Progress* progress = nullptr;
};

// Alternates (1) and (2) from `start`, whose ranks must be filled. The result is never worse than `start`,
// except for what `contiguity` allows.
Clustering improve_clustering(const OcclusionGraph& graph, Clustering start, const KMeansOptions& options);

// Returns a start for k clusters: each cell belongs to the nearest of k spread-out random directions, and
// orders are by depth. Contiguous starts converge in a few rounds to a fraction of the error of starts that
// join opposite views (docs/in-depth-buffers.md).
Clustering spread_start(const OcclusionGraph& graph, const Mesh& mesh, const BoundingSphere& sphere,
                        const ViewPartition& partition, std::uint32_t cluster_count, std::uint64_t seed);

// Returns the violated weight of every cell under every order: cells x orders, row by row.
std::vector<double> violation_table(const OcclusionGraph& graph,
                                    const std::vector<std::vector<std::uint32_t>>& ranks);

// ------------------------------------------------------------------------------- orders for an error budget
//
// Which views can share an order depends on the shape, and hardly on its tessellation. So the clustering is
// searched on a mesh of about a thousand triangles, from several starts. It is then carried to the full mesh
// (upsample.h), where a few rounds finish it.

// Triangles of the mesh that the search runs on.
constexpr std::uint32_t kCoarseTriangles = 1000;

struct ErrorBudgetOptions {
  ErrorTarget target;  // over held-out viewpoints
  std::uint32_t min_buffers = 1, max_buffers = 16;
  bool front_only = false;
  ValidRange range{2, 5};  // of the held-out viewpoints
  double image_alpha = 0;  // ValidationOptions::image_alpha
  std::uint64_t seed = 1;
  Progress* progress = nullptr;
  RunRecords records{};  // keeps the result for every number of buffers that was tried
};

struct ErrorBudgetResult {
  Clustering clustering;  // on the full mesh
  OrderError measured;    // over held-out viewpoints
  double error = 0;       // the same, by the measure of the target
};

template <class Archive, RecordOf<OrderError> T>
void fields(Archive& archive, T& error) {
  archive(error.ipr, error.psnr, error.repaired);
}
template <class Archive, RecordOf<ErrorBudgetResult> T>
void fields(Archive& archive, T& result) {
  archive(result.clustering, result.measured, result.error);
}

// Finds the fewest orders that meet the target, or the fewest after which more orders hardly help. `coarse`
// has a simpler mesh, or fewer cells, or both; it is `fine` itself where nothing can be simplified.
ErrorBudgetResult find_fewest_orders(const OrderProblem& coarse, const OrderProblem& fine,
                                     const ErrorBudgetOptions& options);

// Returns one result for every number of buffers from options.min_buffers to options.max_buffers: what
// find_fewest_orders() returns if that is the only number allowed.
std::vector<ErrorBudgetResult> solve_every_number(const OrderProblem& coarse, const OrderProblem& fine,
                                                  const ErrorBudgetOptions& options);

// Returns ranks of the nodes of `fine` from those of `coarse`, for the views of `cells`.
std::vector<std::uint32_t> carry_ranks(const OrderProblem& coarse, const OrderProblem& fine,
                                       std::span<const NodeId> coarse_nodes,
                                       std::span<const std::uint32_t> coarse_ranks,
                                       std::span<const std::uint32_t> cells);

// ------------------------------------------------------------------------------------------ acyclic clusters

// Merges neighbouring clusters greedily by priority, then relaxes the result (section 3.2 of the paper). View
// cells share an order only if the union of their edges is acyclic. Cells whose own edges are cyclic first
// lose the edges that the best order found violates; `statistics` counts these. The orders of the result
// violate no kept edge. The state after merging, and after every round of relaxation, is kept in `records`.
Clustering cluster_acyclically(const OrderProblem& problem, const OrderOptions& options,
                               OrderStatistics& statistics, const RunRecords& records = {});

// ---------------------------------------------------------------------------------------------- lower bounds

// Returns a weight that every order of `edges` (rows sorted by back node) violates at least. `ranks` is a
// good order; the closer it is to the best one, the tighter is the bound. Takes O(edges) and, for each edge
// that `ranks` violates, O(degree^2).
double unavoidable_weight(const EdgeRows& edges, std::span<const std::uint32_t> ranks);

// Returns the sum of the same over all cells, each under an order of its own. No number of buffers violates
// less.
double unavoidable_in_cells(const OcclusionGraph& graph, const Clustering& clustering);

}  // namespace pellucid
