// Clustering by budget: see budget.h.
#include "transparency/cluster/budget.h"

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

// Sum the edges of the clusters whose cells have changed, and sift their orders.
void reorder_clusters(const OcclusionGraph& graph, const KMeansOptions& options, float light,
                      const std::vector<std::uint8_t>& changed, Clustering& clustering) {
  const auto reorder = [&](std::uint32_t cluster) {
    advance_stage(options.progress, 1);
    if (changed[cluster] == 0) return;
    stop_if_requested(options.progress);
    const std::vector<std::uint32_t> cells = cells_of_cluster(clustering.cluster_of, cluster);
    const PairPreferences preferences =
        net_preferences(sum_cells(graph, cells, light * static_cast<float>(cells.size())));
    SiftOptions sifting = options.sift;
    sifting.progress = options.progress;
    sift(preferences, sifting, clustering.ranks[cluster]);
  };
  if (graph.spilled) {  // memory is short: one cluster's sum at a time
    for (std::uint32_t cluster = 0; cluster < clustering.cluster_count(); ++cluster) reorder(cluster);
  } else {
    parallel_loop(std::uint32_t{0}, clustering.cluster_count(), reorder);
  }
}

}  // namespace

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
    start.cluster_of[cell] = nearest_direction(directions, cell_direction(partition, cell));
  }
  for (std::uint32_t c = 0; c < cluster_count; ++c) {
    start.ranks.push_back(
        ranks_by_key(depth_keys(mesh, sphere, partition, cells_of_cluster(start.cluster_of, c))));
  }
  return start;
}

Clustering improve_clustering(const OcclusionGraph& graph, Clustering start, const KMeansOptions& options) {
  OrderCosts costs;
  costs.approximate = options.light > 0;
  costs.table = [&](const std::vector<std::vector<std::uint32_t>>& ranks) {
    return violation_table(graph, ranks);
  };
  costs.reorder = [&](const std::vector<std::uint8_t>& changed, bool last, Clustering& clustering) {
    reorder_clusters(graph, options, last ? 0.0F : options.light, changed, clustering);
  };
  KOrders found = improve_orders(costs, std::move(start), {options.rounds, options.least_gain});
  if (options.partition != nullptr) {
    found.clustering.cost = join_neighbors(*options.partition, found.table, found.clustering.cluster_count(),
                                           options.contiguity, found.clustering.cluster_of);
  }
  return found.clustering;
}

}  // namespace pellucid
