// Finds k orders for many cells by k-means clustering. In: a function that returns the cost of every cell
// under every order, and one that improves orders. Out: an order per cluster, and the cluster of every cell.
//
// A cell is anything that needs an order: a view cell of a static mesh, or a view of a key frame. Items are
// what is ordered: facings of triangles, or patches. The caller defines the cost: the area drawn in the wrong
// order (transparency) or the number of wasted fragments (overdraw).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/record.h"
#include "pellucid/base.h"

namespace pellucid {

// Clusters of cells, each with an order.
struct Clustering {
  std::vector<std::uint32_t> cluster_of;          // the cluster of every cell
  std::vector<std::vector<std::uint32_t>> ranks;  // per cluster: the rank of every item, a permutation
  double cost = 0;                                // the sum over all cells
  std::uint32_t rounds = 0;

  [[nodiscard]] std::uint32_t cluster_count() const { return static_cast<std::uint32_t>(ranks.size()); }
};

template <class Archive, RecordOf<Clustering> T>
void fields(Archive& archive, T& clustering) {
  archive(clustering.cluster_of, clustering.ranks, clustering.cost, clustering.rounds);
}

// The costs that the caller defines.
struct OrderCosts {
  // Returns the cost of every cell under every order: cells x orders, row by row.
  std::function<std::vector<double>(const std::vector<std::vector<std::uint32_t>>& ranks)> table;
  // Improves the orders of the flagged clusters for their cells, on average.
  std::function<void(const std::vector<std::uint8_t>& flagged, bool last_round, Clustering&)> reorder;
  // True if reorder() is only exact in the last round.
  bool approximate = false;
};

struct KOrdersOptions {
  std::uint32_t rounds = 40;
  double least_gain = 1e-3;  // stop after a round that lowers the cost by less than this share
};

struct KOrders {
  Clustering clustering;
  std::vector<double> table;  // the costs of its orders, as returned by OrderCosts::table
};

// Improves a clustering by k-means: every cluster orders its items for its cells, and every cell moves to its
// cheapest order, until this gains little. Starts from start.ranks. The cost of the result is never higher
// than at the start. Deterministic.
KOrders improve_orders(const OrderCosts& costs, Clustering start, const KOrdersOptions& options);

// Removes orders that no cell uses and renumbers the others.
Clustering without_unused_orders(Clustering clustering);

// Returns the cells of a cluster in ascending order.
std::vector<std::uint32_t> cells_of_cluster(const std::vector<std::uint32_t>& cluster_of,
                                            std::uint32_t cluster);

// Returns `count` unit directions far from each other, as starting points for clusters of views.
std::vector<Vec3d> spread_directions(std::uint32_t count, Random& random);
// Returns the index of the direction nearest to `direction`, the first one of several.
std::uint32_t nearest_direction(const std::vector<Vec3d>& directions, const Vec3d& direction);

}  // namespace pellucid
