// Implements order_problem.h: builds the problem that clusters are made for, and makes the base order.
#include "transparency/order_problem.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "sequencing/linear_order.h"
#include "transparency/cluster/clustering.h"
#include "transparency/upsample.h"

namespace pellucid {
namespace {

// Edges that weigh less than this (square radii, mean over the viewpoints of a cell) cover less than a
// hundredth of a pixel of a 1024 x 1024 image. They are counted (pruned weight) but not kept.
constexpr float kLeastWeight = 3e-7F;

}  // namespace

ValidRange valid_range(PartitionKind kind, const std::vector<double>& distances) {
  const auto [least, most] = std::minmax_element(distances.begin(), distances.end());
  // All distances between the two are known. A single distance is treated as that of samples.
  if (kind == PartitionKind::view_triangles && *least < *most) return {*least, *most};
  // The view of a finite camera differs from that at infinity by its perspective, 1 / distance.
  constexpr double kFarEnough = 8;
  if (std::isinf(*least)) return {kFarEnough, kInfiniteDistance};
  const double from = std::max(1.0, 2.0 / 3.0 * *least);
  if (kind == PartitionKind::view_regions) return {from, kInfiniteDistance};
  // Errors grow slowly with distance: 3 radii stand for the paper's 2 to 5.
  return {from, 5.0 / 3.0 * *most};
}

ValidRange solid_range(PartitionKind kind, const std::vector<double>& distances) {
  if (kind == PartitionKind::view_regions) return valid_range(kind, distances);
  const auto [least, most] = std::minmax_element(distances.begin(), distances.end());
  return {*least, *most};
}

OrderProblem make_problem(const Mesh& mesh, const PartitionSpec& partition, const OrderOptions& options,
                          double tolerance, const RunRecords& records) {
  OrderProblem problem;
  problem.mesh = &mesh;
  problem.sphere = bounding_sphere(mesh);
  problem.partition = make_partition(partition);
  GraphOptions graph;
  graph.distances = options.distances;
  graph.all_distances = partition.kind == PartitionKind::viewpoints || partition.sample_level == 0;
  graph.tolerance = tolerance;
  graph.least_weight = kLeastWeight;
  graph.source = options.occlusion;
  graph.raster_size = options.raster_size;
  graph.alpha = options.alpha;
  graph.front_only = options.facing == Facing::single;
  graph.memory = options.memory / 2;
  graph.progress = options.progress;
  const ValidRange solid = solid_range(partition.kind, options.distances);
  graph.solid_from = solid.from;
  graph.solid_to = solid.to;
  graph.records = records;
  problem.graph = build_occlusion_graph(mesh, problem.sphere, problem.partition, graph);
  return problem;
}

std::vector<std::uint8_t> visible_nodes(const OrderProblem& problem, const std::vector<std::uint32_t>& cells,
                                        const ValidRange& range, Facing facing) {
  const Mesh& mesh = *problem.mesh;
  std::vector<std::uint8_t> drawn(2 * mesh.triangles.size(), 0);
  parallel_loop(std::uint32_t{0}, static_cast<std::uint32_t>(mesh.triangles.size()), [&](std::uint32_t t) {
    const Vec3d normal = triangle_normal(mesh, t);
    const double offset =
        dot(normal, to_double(mesh.positions[mesh.triangles[t][0]]) - problem.sphere.center);
    const auto seen = [&](const Vec3d& n, double o) {
      return std::any_of(cells.begin(), cells.end(), [&](std::uint32_t cell) {
        return front_visible(problem.partition, cell, n, o, problem.sphere.radius, range.from, range.to);
      });
    };
    drawn[node_of(t, false)] = seen(normal, offset) ? 1 : 0;
    if (facing == Facing::duplicated) drawn[node_of(t, true)] = seen(-normal, -offset) ? 1 : 0;
  });
  return drawn;
}

// -------------------------------------------------------------------------------------------- the base order

namespace {

// Triangles per run: enough to use the vertex cache, and few enough to follow the depth order.
constexpr std::size_t kRun = 32;

// Returns the edges between triangles as stored, without those of back-facing copies.
EdgeRows stored_facings_only(const EdgeRows& edges) {
  EdgeRows stored;
  stored.offsets.push_back(0);
  for (NodeId front = 0; front < edges.node_count(); ++front) {
    for (std::uint32_t i = edges.offsets[front]; !is_flipped(front) && i < edges.offsets[front + 1]; ++i) {
      if (is_flipped(edges.backs[i])) continue;
      stored.backs.push_back(edges.backs[i]);
      stored.weights.push_back(edges.weights[i]);
    }
    stored.offsets.push_back(static_cast<std::uint32_t>(stored.backs.size()));
  }
  return stored;
}

std::vector<std::uint32_t> single_order(const OrderProblem& problem) {
  std::vector<std::uint32_t> all_cells(problem.partition.cell_count());
  std::iota(all_cells.begin(), all_cells.end(), 0U);
  std::vector<std::uint32_t> ranks =
      ranks_by_key(depth_keys(*problem.mesh, problem.sphere, problem.partition, all_cells));
  sift(net_preferences(stored_facings_only(sum_cells(problem.graph, all_cells))), {}, ranks);
  return ranks;
}

}  // namespace

std::vector<std::uint32_t> cache_positions(const Mesh& mesh) {
  std::vector<std::uint32_t> indices;
  indices.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  // The optimiser permutes whole triangles but may rotate their corners. Find them again by their sorted
  // corners.
  std::vector<std::uint32_t> optimized(indices.size());
  meshopt_optimizeVertexCache(optimized.data(), indices.data(), indices.size(), mesh.positions.size());
  const auto key = [](const std::uint32_t* c) {
    std::array<std::uint32_t, 3> k{c[0], c[1], c[2]};
    std::rotate(k.begin(), std::min_element(k.begin(), k.end()), k.end());
    return k;
  };
  const auto sorted = [&](const std::vector<std::uint32_t>& list) {
    std::vector<std::uint32_t> order(list.size() / 3);
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      const auto ka = key(&list[3 * std::size_t{a}]);
      const auto kb = key(&list[3 * std::size_t{b}]);
      return ka != kb ? ka < kb : a < b;
    });
    return order;
  };
  const std::vector<std::uint32_t> before = sorted(indices);
  const std::vector<std::uint32_t> after = sorted(optimized);
  std::vector<std::uint32_t> positions(mesh.triangles.size());
  for (std::size_t i = 0; i < positions.size(); ++i) positions[before[i]] = after[i];
  return positions;
}

std::vector<std::uint32_t> base_order(const Mesh& mesh, const OrderProblem& coarse) {
  const std::vector<std::uint32_t> ranks = single_order(coarse);
  std::vector<NodeId> parents(2 * mesh.triangles.size());
  if (coarse.mesh == &mesh) {
    std::iota(parents.begin(), parents.end(), 0U);
  } else {
    parents = nearest_coarse_nodes(mesh, *coarse.mesh);
  }
  const std::vector<std::uint32_t> positions = cache_positions(mesh);
  std::vector<std::uint32_t> cache_order(mesh.triangles.size());
  for (std::uint32_t t = 0; t < cache_order.size(); ++t) cache_order[positions[t]] = t;

  struct Run {
    double rank;
    std::size_t begin, end;
  };
  std::vector<Run> runs;
  for (std::size_t begin = 0; begin < cache_order.size(); begin += kRun) {
    Run run{0, begin, std::min(begin + kRun, cache_order.size())};
    for (std::size_t i = run.begin; i < run.end; ++i)
      run.rank += ranks[parents[2 * std::size_t{cache_order[i]}]];
    run.rank /= static_cast<double>(run.end - run.begin);
    runs.push_back(run);
  }
  std::stable_sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.rank > b.rank; });
  std::vector<std::uint32_t> order;
  order.reserve(cache_order.size());
  for (const Run& run : runs) {
    order.insert(order.end(), cache_order.begin() + static_cast<std::ptrdiff_t>(run.begin),
                 cache_order.begin() + static_cast<std::ptrdiff_t>(run.end));
  }
  return order;
}

}  // namespace pellucid
