// Implements k-means clustering over orders.
#include "sequencing/k_orders.h"

#include <algorithm>
#include <limits>

namespace pellucid {
namespace {

// Assigns every cell to its cheapest order. A cell stays in its cluster if there is a tie.
void reassign_cells(const std::vector<double>& table, Clustering& clustering) {
  const std::uint32_t orders = clustering.cluster_count();
  clustering.cost = 0;
  for (std::size_t cell = 0; cell < clustering.cluster_of.size(); ++cell) {
    const double* costs = &table[cell * orders];
    std::uint32_t& best = clustering.cluster_of[cell];
    for (std::uint32_t order = 0; order < orders; ++order) {
      if (costs[order] < costs[best]) best = order;
    }
    clustering.cost += costs[best];
  }
}

// Restarts every order that no cell uses with the cell of the highest cost.
void reseed_empty_clusters(const std::vector<double>& table, Clustering& clustering) {
  const std::uint32_t orders = clustering.cluster_count();
  for (std::uint32_t cluster = 0; cluster < orders; ++cluster) {
    if (std::find(clustering.cluster_of.begin(), clustering.cluster_of.end(), cluster) !=
        clustering.cluster_of.end()) {
      continue;
    }
    std::size_t worst = 0;
    double worst_cost = -1;
    for (std::size_t cell = 0; cell < clustering.cluster_of.size(); ++cell) {
      const double cost = table[cell * orders + clustering.cluster_of[cell]];
      if (cost > worst_cost) {
        worst_cost = cost;
        worst = cell;
      }
    }
    clustering.ranks[cluster] = clustering.ranks[clustering.cluster_of[worst]];
    clustering.cluster_of[worst] = cluster;
  }
}

// Returns a flag per cluster: whether it gained or lost a cell.
std::vector<std::uint8_t> changed_clusters(const std::vector<std::uint32_t>& before,
                                           const std::vector<std::uint32_t>& after,
                                           std::uint32_t cluster_count) {
  std::vector<std::uint8_t> changed(cluster_count, 0);
  for (std::size_t cell = 0; cell < after.size(); ++cell) {
    if (before[cell] == after[cell]) continue;
    changed[before[cell]] = 1;
    changed[after[cell]] = 1;
  }
  return changed;
}

}  // namespace

std::vector<std::uint32_t> cells_of_cluster(const std::vector<std::uint32_t>& cluster_of,
                                            std::uint32_t cluster) {
  std::vector<std::uint32_t> cells;
  for (std::uint32_t cell = 0; cell < cluster_of.size(); ++cell) {
    if (cluster_of[cell] == cluster) cells.push_back(cell);
  }
  return cells;
}

Clustering without_unused_orders(Clustering clustering) {
  std::vector<std::uint32_t> numbers(clustering.cluster_count(), 0);
  for (const std::uint32_t cluster : clustering.cluster_of) numbers[cluster] = 1;
  std::vector<std::vector<std::uint32_t>> used;
  for (std::uint32_t cluster = 0; cluster < numbers.size(); ++cluster) {
    if (numbers[cluster] == 0) continue;
    numbers[cluster] = static_cast<std::uint32_t>(used.size());
    used.push_back(std::move(clustering.ranks[cluster]));
  }
  for (std::uint32_t& cluster : clustering.cluster_of) cluster = numbers[cluster];
  clustering.ranks = std::move(used);
  return clustering;
}

KOrders improve_orders(const OrderCosts& costs, Clustering start, const KOrdersOptions& options) {
  Clustering current = std::move(start);
  std::vector<double> table = costs.table(current.ranks);
  reassign_cells(table, current);
  KOrders best{current, table};
  std::vector<std::uint32_t> ordered_for;  // the clusters for which the orders were last made
  bool last = false;
  for (std::uint32_t round = 0; !last && best.clustering.cost > 0; ++round) {
    const double before = best.clustering.cost;
    last = round + 1 >= options.rounds;
    reseed_empty_clusters(table, current);
    const bool all = ordered_for.empty() || (costs.approximate && last);
    costs.reorder(all ? std::vector<std::uint8_t>(current.cluster_count(), 1)
                      : changed_clusters(ordered_for, current.cluster_of, current.cluster_count()),
                  last, current);
    ordered_for = current.cluster_of;
    table = costs.table(current.ranks);
    reassign_cells(table, current);
    current.rounds = round + 1;
    if (current.cost < best.clustering.cost) best = {current, table};
    // End the search after a round that gains little, but run an exact last round first if there was none.
    if (!last && before - best.clustering.cost <= options.least_gain * before) {
      if (!costs.approximate) break;
      round = std::max(round, options.rounds - 2);
    }
  }
  best.clustering.rounds = current.rounds;
  return best;
}

std::vector<Vec3d> spread_directions(std::uint32_t count, Random& random) {
  std::vector<Vec3d> chosen{random.direction()};
  while (chosen.size() < count) {
    // Of some random candidates, take the one farthest from those chosen so far (Mitchell, "Spectrally
    // optimal sampling for distribution ray tracing", SIGGRAPH 1991).
    Vec3d best{};
    double best_nearness = std::numeric_limits<double>::infinity();
    for (int trial = 0; trial < 200; ++trial) {
      const Vec3d candidate = random.direction();
      double nearest = -1;
      for (const Vec3d& c : chosen) nearest = std::max(nearest, dot(c, candidate));
      if (nearest < best_nearness) {
        best_nearness = nearest;
        best = candidate;
      }
    }
    chosen.push_back(best);
  }
  return chosen;
}

std::uint32_t nearest_direction(const std::vector<Vec3d>& directions, const Vec3d& direction) {
  std::uint32_t nearest = 0;
  double best = -2;
  for (std::uint32_t i = 0; i < directions.size(); ++i) {
    const double cosine = dot(direction, directions[i]);
    if (cosine > best) {
      best = cosine;
      nearest = i;
    }
  }
  return nearest;
}

}  // namespace pellucid
