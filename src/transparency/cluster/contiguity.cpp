// Implements the contiguous regions of clustering.h: joins neighbouring cells to regions with the same order,
// and counts how often a camera switches orders.
//
// Based on: Besag, "On the Statistical
// Analysis of Dirty Pictures", JRSS B 48(3), 1986 (iterated conditional modes for the Potts model). Differs
// in: a bound on every cell's cost instead of a price per border, and moves of whole regions.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "transparency/cluster/clustering.h"

namespace pellucid {
namespace {

// Great circles, and steps on each of them. With these the mean is accurate to some per cent.
constexpr int kCircles = 64;
constexpr int kSteps = 720;

class Joiner {
 public:
  Joiner(const ViewPartition& partition, std::span<const double> costs, std::uint32_t order_count,
         const ContiguityOptions& options, std::vector<std::uint32_t>& cluster_of)
      : partition_(partition), costs_(costs), order_count_(order_count), cluster_of_(cluster_of) {
    users_.resize(order_count, 0);
    for (const std::uint32_t order : cluster_of) ++users_[order];
    for (std::uint32_t cell = 0; cell < cluster_of.size(); ++cell) {
      const double cost = cost_of(cell, cluster_of[cell]);
      limits_.push_back(cost + std::max(options.share * cost, options.floor));
    }
  }

  // Every move makes fewer neighbours differ, so this ends.
  void run() {
    for (bool changed = true; changed;) {
      changed = false;
      for (std::uint32_t cell = 0; cell < cluster_of_.size(); ++cell) changed = move_cell(cell) || changed;
      changed = move_regions() || changed;
    }
  }

  [[nodiscard]] double violated() const {
    double sum = 0;
    for (std::uint32_t cell = 0; cell < cluster_of_.size(); ++cell) sum += cost_of(cell, cluster_of_[cell]);
    return sum;
  }

 private:
  [[nodiscard]] double cost_of(std::uint32_t cell, std::uint32_t order) const {
    return costs_[std::size_t{cell} * order_count_ + order];
  }
  [[nodiscard]] bool tolerates(std::uint32_t cell, std::uint32_t order) const {
    return cost_of(cell, order) <= limits_[cell];
  }
  [[nodiscard]] std::uint32_t neighbors_with(std::uint32_t cell, std::uint32_t order) const {
    const auto neighbors = partition_.neighbors_of(cell);
    return static_cast<std::uint32_t>(std::count_if(
        neighbors.begin(), neighbors.end(), [&](std::uint32_t n) { return cluster_of_[n] == order; }));
  }

  void give(std::uint32_t cell, std::uint32_t order) {
    --users_[cluster_of_[cell]];
    ++users_[order];
    cluster_of_[cell] = order;
  }

  // Moves a cell to the order that most of its neighbours have, and to the cheapest of several such orders.
  bool move_cell(std::uint32_t cell) {
    const std::uint32_t own = cluster_of_[cell];
    std::uint32_t best = own;
    std::uint32_t most = neighbors_with(cell, own);
    for (const std::uint32_t neighbor : partition_.neighbors_of(cell)) {
      const std::uint32_t order = cluster_of_[neighbor];
      if (order == own || !tolerates(cell, order)) continue;
      const std::uint32_t count = neighbors_with(cell, order);
      if (count > most || (count == most && best != own && cost_of(cell, order) < cost_of(cell, best))) {
        best = order;
        most = count;
      }
    }
    if (best == own || users_[own] == 1 || !is_expendable(cell)) return false;
    give(cell, best);
    return true;
  }

  // Returns whether the neighbours of the same order stay connected without the cell.
  [[nodiscard]] bool is_expendable(std::uint32_t cell) const {
    const std::uint32_t order = cluster_of_[cell];
    if (neighbors_with(cell, order) < 2) return true;
    std::vector<std::uint32_t> others = cluster_of_;
    others[cell] = order_count_;
    const Regions regions = find_regions(partition_, others);
    std::uint32_t first = regions.count;
    for (const std::uint32_t neighbor : partition_.neighbors_of(cell)) {
      if (others[neighbor] != order) continue;
      if (first == regions.count) first = regions.region_of[neighbor];
      if (regions.region_of[neighbor] != first) return false;
    }
    return true;
  }

  // Joins a region to a neighbouring one whose order all its cells tolerate. Of several, the cheapest is
  // chosen.
  bool move_regions() {
    const Regions regions = find_regions(partition_, cluster_of_);
    std::vector<std::vector<std::uint32_t>> cells(regions.count);
    for (std::uint32_t cell = 0; cell < cluster_of_.size(); ++cell)
      cells[regions.region_of[cell]].push_back(cell);
    bool changed = false;
    for (const std::vector<std::uint32_t>& region : cells) changed = move_region(region) || changed;
    return changed;
  }

  bool move_region(const std::vector<std::uint32_t>& region) {
    const std::uint32_t own = cluster_of_[region.front()];
    if (users_[own] == region.size()) return false;
    std::uint32_t best = own;
    double least = 0;
    for (const std::uint32_t cell : region) {
      for (const std::uint32_t neighbor : partition_.neighbors_of(cell)) {
        const std::uint32_t order = cluster_of_[neighbor];
        if (order == own || order == best) continue;
        if (!std::all_of(region.begin(), region.end(), [&](std::uint32_t c) { return tolerates(c, order); }))
          continue;
        double cost = 0;
        for (const std::uint32_t c : region) cost += cost_of(c, order);
        if (best == own || cost < least) {
          best = order;
          least = cost;
        }
      }
    }
    for (const std::uint32_t cell : region) give(cell, best);
    return best != own;
  }

  const ViewPartition& partition_;
  std::span<const double> costs_;
  std::uint32_t order_count_;
  std::vector<std::uint32_t>& cluster_of_;
  std::vector<double> limits_;        // per cell
  std::vector<std::uint32_t> users_;  // cells of every order
};

}  // namespace

double join_neighbors(const ViewPartition& partition, std::span<const double> costs,
                      std::uint32_t order_count, const ContiguityOptions& options,
                      std::vector<std::uint32_t>& cluster_of) {
  Joiner joiner(partition, costs, order_count, options, cluster_of);
  if (options.share > 0) joiner.run();
  return joiner.violated();
}

Regions find_regions(const ViewPartition& partition, std::span<const std::uint32_t> cluster_of) {
  constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  Regions regions;
  regions.region_of.assign(cluster_of.size(), kNone);
  std::vector<std::uint32_t> open;
  for (std::uint32_t seed = 0; seed < cluster_of.size(); ++seed) {
    if (regions.region_of[seed] != kNone) continue;
    regions.region_of[seed] = regions.count;
    open.push_back(seed);
    while (!open.empty()) {
      const std::uint32_t cell = open.back();
      open.pop_back();
      for (const std::uint32_t neighbor : partition.neighbors_of(cell)) {
        if (regions.region_of[neighbor] != kNone || cluster_of[neighbor] != cluster_of[cell]) continue;
        regions.region_of[neighbor] = regions.count;
        open.push_back(neighbor);
      }
    }
    ++regions.count;
  }
  return regions;
}

double switches_per_turn(const ViewPartition& partition, std::span<const std::uint32_t> cluster_of) {
  Random random(1);
  int switches = 0;
  for (int circle = 0; circle < kCircles; ++circle) {
    const Vec3d x = random.direction();
    const Vec3d other = random.direction();
    const Vec3d y = normalized(other - x * dot(x, other));
    const auto order_at = [&](int step) {
      const double angle = 2 * std::numbers::pi * step / kSteps;
      return cluster_of[find_cell(partition, x * std::cos(angle) + y * std::sin(angle))];
    };
    std::uint32_t last = order_at(kSteps - 1);
    for (int step = 0; step < kSteps; ++step) {
      const std::uint32_t now = order_at(step);
      switches += now != last ? 1 : 0;
      last = now;
    }
  }
  return static_cast<double>(switches) / kCircles;
}

}  // namespace pellucid
