// k orders for many cells: the one optimiser of this module.
//
// A cell is whatever needs an order: a view cell of a static mesh, or a view of a key frame. Items are what
// is put in order: facings of triangles, or patches. What an order costs a cell is said by the caller: the
// area drawn in the wrong order (budget.h), or fragments shaded in vain (overdraw_costs.h).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/record.h"
#include "pellucid/base.h"

namespace pellucid {

struct Clustering {
  std::vector<std::uint32_t> cluster_of;          // per cell
  std::vector<std::vector<std::uint32_t>> ranks;  // per cluster, per item: a permutation
  double cost = 0;                                // summed over cells
  std::uint32_t rounds = 0;

  [[nodiscard]] std::uint32_t cluster_count() const { return static_cast<std::uint32_t>(ranks.size()); }
};

template <class Archive, RecordOf<Clustering> T>
void fields(Archive& archive, T& clustering) {
  archive(clustering.cluster_of, clustering.ranks, clustering.cost, clustering.rounds);
}

struct OrderCosts {
  // Cost of every cell under every order: cells x orders, row by row.
  std::function<std::vector<double>(const std::vector<std::vector<std::uint32_t>>& ranks)> table;
  // Make the orders of the flagged clusters better for their cells, on average.
  std::function<void(const std::vector<std::uint8_t>& flagged, bool last_round, Clustering&)> reorder;
  // reorder leaves something out but in the last round.
  bool approximate = false;
};

struct KOrdersOptions {
  std::uint32_t rounds = 40;
  double least_gain = 1e-3;  // stop when a round lowers the cost by less than this share
};

struct KOrders {
  Clustering clustering;
  std::vector<double> table;  // of its orders
};

// k-means over orders: every cluster orders its items for its cells, every cell moves to the order that is
// cheapest for it, until that gains little. Starts from ranks; never ends worse than it starts.
KOrders improve_orders(const OrderCosts& costs, Clustering start, const KOrdersOptions& options);

// Orders that no cell uses (there were more than cells, or fewer already suffice) left out, the rest
// renumbered.
Clustering without_unused_orders(Clustering clustering);

std::vector<std::uint32_t> cells_of_cluster(const std::vector<std::uint32_t>& cluster_of,
                                            std::uint32_t cluster);

// Unit directions far from each other: starts for clusters of views.
std::vector<Vec3d> spread_directions(std::uint32_t count, Random& random);
// The one that is nearest to `direction`; ties: the first.
std::uint32_t nearest_direction(const std::vector<Vec3d>& directions, const Vec3d& direction);

}  // namespace pellucid
