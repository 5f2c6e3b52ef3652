// Clustering by budget: see budget.h.
#include "budget.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel.h"

namespace pellucid {
namespace {

// Orders side by side, so that one edge is compared under all of them at once.
struct RankTable {
  std::uint32_t order_count;
  std::vector<std::uint32_t> ranks;  // node * order_count + order
};

RankTable interleave(const std::vector<std::vector<std::uint32_t>>& ranks) {
  const auto order_count = static_cast<std::uint32_t>(ranks.size());
  RankTable table{order_count, std::vector<std::uint32_t>(ranks.front().size() * order_count)};
  for (std::uint32_t order = 0; order < order_count; ++order) {
    for (std::size_t node = 0; node < ranks[order].size(); ++node) {
      table.ranks[node * order_count + order] = ranks[order][node];
    }
  }
  return table;
}

void add_violations(const CompactRows& rows, const RankTable& table, double* costs) {
  const std::uint32_t orders = table.order_count;
  std::vector<float> row_costs(orders);
  const RowBlock block = rows.all();
  for (NodeId node = 0; node < rows.node_count(); ++node) {
    const std::uint32_t* front = &table.ranks[std::size_t{node} * orders];
    std::fill(row_costs.begin(), row_costs.end(), 0.0F);
    block.for_each(node, [&](NodeId back_node, float weight) {
      const std::uint32_t* back = &table.ranks[std::size_t{back_node} * orders];
      for (std::uint32_t order = 0; order < orders; ++order) {
        row_costs[order] += front[order] > back[order] ? weight : 0.0F;
      }
    });
    for (std::uint32_t order = 0; order < orders; ++order)
      costs[order] += static_cast<double>(row_costs[order]);
  }
}

// Directions far from each other.
std::vector<Vec3d> spread_directions(std::uint32_t count, Random& random) {
  std::vector<Vec3d> chosen{random.direction()};
  while (chosen.size() < count) {
    // Of some random candidates, take the one farthest from those chosen (Mitchell's best candidate).
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

// Sum the edges of the clusters whose cells have changed, and sift their orders.
void reorder_clusters(const OcclusionGraph& graph, const KMeansOptions& options, float light,
                      const std::vector<std::uint8_t>& changed, Clustering& clustering) {
  const auto reorder = [&](std::uint32_t cluster) {
    advance_stage(options.progress, 1);
    if (changed[cluster] == 0) return;
    stop_if_requested(options.progress);
    const std::vector<std::uint32_t> cells = cells_of_cluster(clustering.cluster_of, cluster);
    const PairWishes wishes = net_wishes(sum_cells(graph, cells, light * static_cast<float>(cells.size())));
    SiftOptions sifting = options.sift;
    sifting.progress = options.progress;
    sift(wishes, sifting, clustering.ranks[cluster]);
  };
  if (graph.spilled) {  // memory is short: one cluster's sum at a time
    for (std::uint32_t cluster = 0; cluster < clustering.cluster_count(); ++cluster) reorder(cluster);
  } else {
    parallel_loop(std::uint32_t{0}, clustering.cluster_count(), reorder);
  }
}

// Give every cell its cheapest order; a tie keeps the cell where it is.
void reassign_cells(const std::vector<double>& table, Clustering& clustering) {
  const std::uint32_t orders = clustering.cluster_count();
  clustering.violated = 0;
  for (std::size_t cell = 0; cell < clustering.cluster_of.size(); ++cell) {
    const double* costs = &table[cell * orders];
    std::uint32_t& best = clustering.cluster_of[cell];
    for (std::uint32_t order = 0; order < orders; ++order) {
      if (costs[order] < costs[best]) best = order;
    }
    clustering.violated += costs[best];
  }
}

// An order that no cell uses is of no use: restart it from the cell that suffers most.
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

// Which clusters gained or lost a cell.
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

std::vector<double> depth_keys(const Mesh& mesh, const BoundingSphere& sphere, const ViewPartition& partition,
                               std::span<const std::uint32_t> cells) {
  std::vector<double> keys(2 * mesh.triangles.size(), 0.0);
  std::vector<Vec3d> directions;
  directions.reserve(cells.size());
  for (const std::uint32_t cell : cells) directions.push_back(cell_direction(partition, cell));
  const double scale = sphere.radius > 0 ? 1.0 / sphere.radius : 0.0;
  parallel_loop(std::size_t{0}, mesh.triangles.size(), [&](std::size_t t) {
    const Triangle& corners = mesh.triangles[t];
    Vec3d centroid{};
    for (const std::uint32_t v : corners) centroid += to_double(mesh.positions[v]) - sphere.center;
    centroid = centroid * (scale / 3.0);
    const Vec3d normal = triangle_normal(mesh, static_cast<std::uint32_t>(t));
    double sums[2] = {0, 0};
    double weights[2] = {0, 0};
    for (const Vec3d& direction : directions) {
      // Head-on views count most: there the face covers most.
      const double cosine = dot(normal, direction);
      const int facing = cosine < 0 ? 1 : 0;
      sums[facing] -= dot(centroid, direction) * std::fabs(cosine);
      weights[facing] += std::fabs(cosine);
    }
    for (std::size_t facing = 0; facing < 2; ++facing) {
      keys[2 * t + facing] = weights[facing] > 0 ? sums[facing] / weights[facing] : 0.0;
    }
  });
  return keys;
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

std::vector<double> violation_table(const OcclusionGraph& graph,
                                    const std::vector<std::vector<std::uint32_t>>& ranks) {
  const RankTable table = interleave(ranks);
  std::vector<double> costs(graph.cells.size() * ranks.size(), 0.0);
  parallel_loop(std::size_t{0}, graph.cells.size(), [&](std::size_t cell) {
    add_violations(graph.cells[cell], table, &costs[cell * ranks.size()]);
  });
  return costs;
}

Clustering spread_start(const OcclusionGraph& graph, const Mesh& mesh, const BoundingSphere& sphere,
                        const ViewPartition& partition, std::uint32_t cluster_count, std::uint64_t seed) {
  Random random(seed);
  const std::vector<Vec3d> directions = spread_directions(cluster_count, random);
  Clustering start;
  start.cluster_of.resize(graph.cells.size());
  for (std::uint32_t cell = 0; cell < graph.cells.size(); ++cell) {
    const Vec3d direction = cell_direction(partition, cell);
    double best = -2;
    for (std::uint32_t c = 0; c < cluster_count; ++c) {
      const double cosine = dot(direction, directions[c]);
      if (cosine > best) {
        best = cosine;
        start.cluster_of[cell] = c;
      }
    }
  }
  for (std::uint32_t c = 0; c < cluster_count; ++c) {
    start.ranks.push_back(
        ranks_by_key(depth_keys(mesh, sphere, partition, cells_of_cluster(start.cluster_of, c))));
  }
  return start;
}

Clustering improve_clustering(const OcclusionGraph& graph, Clustering start, const KMeansOptions& options) {
  Clustering current = std::move(start);
  std::vector<double> table = violation_table(graph, current.ranks);
  reassign_cells(table, current);
  Clustering best = current;
  std::vector<double> best_table = table;
  // The cells that the orders were last made for, and the lightness of the edges then left out.
  std::vector<std::uint32_t> ordered_for;
  float ordered_light = 0;
  bool last = false;
  for (std::uint32_t round = 0; !last && best.violated > 0; ++round) {
    const double before = best.violated;
    last = round + 1 >= options.rounds;
    const float light = last ? 0.0F : options.light;
    reseed_empty_clusters(table, current);
    const bool all = ordered_for.empty() || light != ordered_light;
    reorder_clusters(graph, options, light,
                     all ? std::vector<std::uint8_t>(current.cluster_count(), 1)
                         : changed_clusters(ordered_for, current.cluster_of, current.cluster_count()),
                     current);
    ordered_for = current.cluster_of;
    ordered_light = light;
    table = violation_table(graph, current.ranks);
    reassign_cells(table, current);
    current.rounds = round + 1;
    if (current.violated < best.violated) {
      best = current;
      best_table = table;
    }
    // Rounds that gain little end the search, after one over all edges if there was none yet.
    if (!last && before - best.violated <= options.least_gain * before) {
      if (options.light == 0) break;
      round = std::max(round, options.rounds - 2);
    }
  }
  best.rounds = current.rounds;
  if (options.partition != nullptr) {
    best.violated = join_neighbors(*options.partition, best_table, best.cluster_count(), options.contiguity,
                                   best.cluster_of);
  }
  return best;
}

}  // namespace pellucid
