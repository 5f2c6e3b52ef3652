// Tests clustering within an error budget: k-means never ends worse than it starts, starts are spread, and
// the fewest orders are found.
#include <gtest/gtest.h>

#include "metric/validation.h"
#include "order_helpers.h"
#include "transparency/cluster/clustering.h"
#include "transparency/upsample.h"

namespace pellucid {
namespace {

OrderProblem problem_of(const Mesh& mesh,
                        const PartitionSpec& spec = {PartitionKind::sampled_triangles, 1, 1}) {
  OrderOptions options;
  options.distances = {1.5, 3, kInfiniteDistance};
  return make_problem(mesh, spec, options, 0);
}

// Of every cell, edge by edge.
double violated(const OcclusionGraph& graph, const Clustering& clustering) {
  double sum = 0;
  for (std::uint32_t cell = 0; cell < graph.cells.size(); ++cell) {
    const std::vector<std::uint32_t>& ranks = clustering.ranks[clustering.cluster_of[cell]];
    for (const auto& [pair, weight] : testing::map_of(graph.cells[cell])) {
      if (ranks[pair.first] > ranks[pair.second]) sum += weight;
    }
  }
  return sum;
}

Clustering start_of(const OrderProblem& problem, std::uint32_t count, std::uint64_t seed) {
  return spread_start(problem.graph, *problem.mesh, problem.sphere, problem.partition, count, seed);
}

TEST(KMeans, NeverEndsWorseThanItsStart) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Mesh mesh = testing::random_soup(60, 0.5, seed);
    const OrderProblem problem = problem_of(mesh);
    for (const std::uint32_t count : {1U, 3U, 7U}) {
      const Clustering start = start_of(problem, count, seed);
      const Clustering end = improve_clustering(problem.graph, start, {});
      const double before = violated(problem.graph, start);
      EXPECT_LT(end.cost, before);
      EXPECT_NEAR(end.cost, violated(problem.graph, end), 1e-3 * before);
      EXPECT_EQ(end.cluster_count(), count);
      for (const auto& ranks : end.ranks) EXPECT_TRUE(testing::is_permutation_of_all(ranks));
      // Every cell has the order that suits it best.
      const std::vector<double> table = violation_table(problem.graph, end.ranks);
      for (std::size_t cell = 0; cell < end.cluster_of.size(); ++cell) {
        for (std::uint32_t c = 0; c < count; ++c)
          EXPECT_LE(table[cell * count + end.cluster_of[cell]], table[cell * count + c]);
      }
    }
  }
}

TEST(KMeans, OneOrderIsEnoughForAConvexMesh) {
  const Mesh mesh = testing::icosphere_mesh(2);
  const OrderProblem problem = problem_of(mesh);
  EXPECT_EQ(improve_clustering(problem.graph, start_of(problem, 1, 1), {}).cost, 0.0);
}

TEST(Clustering, UnusedOrdersAreLeftOut) {
  const Clustering given{{3, 1, 3}, {{0, 1}, {1, 0}, {0, 1}, {1, 0}}, 0.5, 2};
  const Clustering used = without_unused_orders(given);
  EXPECT_EQ(used.cluster_of, (std::vector<std::uint32_t>{1, 0, 1}));
  ASSERT_EQ(used.cluster_count(), 2U);
  EXPECT_EQ(used.ranks[0], given.ranks[1]);
  EXPECT_EQ(used.ranks[1], given.ranks[3]);
}

TEST(SpreadStart, CellsFollowTheNearestOfKDirections) {
  const Mesh mesh = testing::nested_spheres(1);
  const OrderProblem problem = problem_of(mesh);
  const Clustering start = start_of(problem, 6, 1);
  EXPECT_EQ(start.cluster_count(), 6U);
  for (std::uint32_t c = 0; c < 6; ++c) {
    const std::vector<std::uint32_t> cells = cells_of_cluster(start.cluster_of, c);
    ASSERT_FALSE(cells.empty());
    // Spread: nobody has more than half of the sphere, and what belongs together looks the same way.
    EXPECT_LT(cells.size(), 40U);
    Vec3d mean{};
    for (const std::uint32_t cell : cells) mean += cell_direction(problem.partition, cell);
    EXPECT_GT(length(mean) / static_cast<double>(cells.size()), 0.6);
  }
  EXPECT_EQ(start_of(problem, 6, 1).cluster_of, start.cluster_of);
  EXPECT_NE(start_of(problem, 6, 2).cluster_of, start.cluster_of);
}

TEST(DepthKeys, SortParallelPlanesAlongTheView) {
  Mesh mesh;
  for (const float z : {0.3F, -0.4F, 0.9F}) {
    testing::append(mesh, {{{-1, -1, z}, {1, -1, z}, {0, 1, z}}, {}, {{0, 1, 2}}});
  }
  const ViewPartition partition = make_partition({PartitionKind::sampled_triangles, 1, 0});
  const std::vector<std::uint32_t> cell{find_cell(partition, {0, 0.1, 1})};
  const std::vector<double> keys = depth_keys(mesh, bounding_sphere(mesh), partition, cell);
  EXPECT_LT(keys[node_of(2, false)], keys[node_of(0, false)]);
  EXPECT_LT(keys[node_of(0, false)], keys[node_of(1, false)]);
}

// ----------------------------------------------------------------------------------------------- search

ErrorBudgetOptions exactly(std::uint32_t count) {
  ErrorBudgetOptions options;
  options.min_buffers = options.max_buffers = count;
  options.range = {1.5, kInfiniteDistance};
  return options;
}

TEST(ErrorBudget, TheErrorFallsWithTheBuffers) {
  const Mesh mesh = testing::sample_mesh("torus-knot", 0.1, 300);
  const OrderProblem problem = problem_of(mesh);
  double last = 1;
  for (const std::uint32_t count : {1U, 4U, 12U}) {
    const ErrorBudgetResult result = find_fewest_orders(problem, problem, exactly(count));
    EXPECT_EQ(result.clustering.cluster_count(), count);
    EXPECT_LT(result.error, last);
    last = result.error;
  }
  EXPECT_LT(last, 0.02);
}

TEST(ErrorBudget, StopsAtTheErrorAskedFor) {
  const Mesh mesh = testing::sample_mesh("torus-knot", 0.1, 300);
  const OrderProblem problem = problem_of(mesh);
  ErrorBudgetOptions options = exactly(1);
  options.max_buffers = 16;
  const double one = find_fewest_orders(problem, problem, exactly(1)).error;
  options.target.max_ipr = one;
  EXPECT_EQ(find_fewest_orders(problem, problem, options).clustering.cluster_count(), 1U);
  options.target.max_ipr = 0.4 * one;
  const ErrorBudgetResult fewer = find_fewest_orders(problem, problem, options);
  EXPECT_GT(fewer.clustering.cluster_count(), 1U);
  EXPECT_LT(fewer.clustering.cluster_count(), 16U);
  EXPECT_LE(fewer.error, options.target.max_ipr);
}

TEST(ErrorBudget, CarriesACoarseClusteringToAFinePartition) {
  const Mesh fine_mesh = testing::sample_mesh("goblet", 0.3, 1200);
  const Mesh coarse_mesh = simplify(fine_mesh, 400);
  const OrderProblem fine = problem_of(fine_mesh, {PartitionKind::sampled_triangles, 2, 0});
  const OrderProblem coarse = problem_of(coarse_mesh, {PartitionKind::sampled_triangles, 1, 1});
  const ErrorBudgetResult result = find_fewest_orders(coarse, fine, exactly(5));
  EXPECT_EQ(result.clustering.cluster_of.size(), 320U);
  EXPECT_EQ(result.clustering.cluster_count(), 5U);
  for (const auto& ranks : result.clustering.ranks) {
    EXPECT_EQ(ranks.size(), 2 * fine_mesh.triangles.size());
    EXPECT_TRUE(testing::is_permutation_of_all(ranks));
  }
  const double one = find_fewest_orders(coarse, fine, exactly(1)).error;
  EXPECT_LT(result.error, 0.5 * one);
}

TEST(Validation, CountsWrongPixels) {
  const Mesh mesh = testing::nested_spheres(1);
  const BoundingSphere sphere = bounding_sphere(mesh);
  const ViewPartition partition = make_partition({PartitionKind::sampled_triangles, 0, 0});
  const std::vector<std::uint32_t> one_cluster(partition.cell_count(), 0);
  ValidationOptions options;
  options.viewpoints = 8;
  options.size = 128;
  const auto error_of = [&](const std::vector<std::uint32_t>& ranks) {
    return measure_order_error(mesh, sphere, partition, one_cluster, {ranks}, options).ipr;
  };
  // Front faces of the outer shell, of the inner one, backs of the inner one, of the outer one: always right.
  const auto outer = static_cast<std::uint32_t>(mesh.triangles.size() / 2);
  std::vector<double> keys(2 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    keys[node_of(t, false)] = t < outer ? 0 : 1;
    keys[node_of(t, true)] = t < outer ? 3 : 2;
  }
  const std::vector<std::uint32_t> right = ranks_by_key(keys);
  // But for pixels of the outline, where a front and a back face meet.
  EXPECT_LT(error_of(right), 1e-4);
  std::vector<std::uint32_t> reversed = right;
  for (std::uint32_t& rank : reversed) rank = static_cast<std::uint32_t>(right.size()) - 1 - rank;
  EXPECT_GT(error_of(reversed), 0.999);
}

// --------------------------------------------------------------------------------------------- upsample

TEST(Upsample, EveryFaceFindsItself) {
  // A mesh is its own best simplification.
  const Mesh mesh = testing::nested_spheres(1);
  const std::vector<NodeId> nodes = nearest_coarse_nodes(mesh, mesh);
  for (NodeId node = 0; node < nodes.size(); ++node) EXPECT_EQ(nodes[node], node);
}

TEST(Upsample, NearestIsThatOfAllTriangles) {
  const Mesh fine = testing::icosphere_mesh(2);
  const Mesh coarse = testing::icosphere_mesh(0, 1.05);
  const std::vector<NodeId> nodes = nearest_coarse_nodes(fine, coarse);
  for (std::uint32_t t = 0; t < fine.triangles.size(); ++t) {
    // Children lie inside their parent: 16 to a face, numbered after it.
    EXPECT_EQ(triangle_of(nodes[2 * std::size_t{t}]), t / 16) << t;
    EXPECT_FALSE(is_flipped(nodes[2 * std::size_t{t}]));
    EXPECT_EQ(nodes[2 * std::size_t{t} + 1], nodes[2 * std::size_t{t}] + 1);
  }
}

TEST(Upsample, SidesOfAThinWallAreNotConfused) {
  Mesh wall{
      {{-1, -1, 0.01F}, {1, -1, 0.01F}, {0, 1, 0.01F}, {-1, -1, -0.01F}, {0, 1, -0.01F}, {1, -1, -0.01F}},
      {},
      {{0, 1, 2}, {3, 4, 5}}};
  // A face slightly nearer to the wrong side, but turned like the right one.
  const Mesh face{{{-0.1F, -0.1F, -0.002F}, {0.1F, -0.1F, -0.002F}, {0, 0.1F, -0.002F}}, {}, {{0, 1, 2}}};
  EXPECT_EQ(nearest_coarse_nodes(face, wall)[0], node_of(0, false));
}

TEST(Upsample, KeysFollowTheCoarseRanksFirst) {
  const std::vector<NodeId> parents{1, 0, 1, 0};
  const std::vector<std::uint32_t> ranks{1, 0};
  const std::vector<double> depth{0.5, -9, -0.5, 9};
  const std::vector<std::uint32_t> order = ranks_by_key(upsampled_keys(parents, ranks, depth));
  EXPECT_EQ(order, (std::vector<std::uint32_t>{1, 2, 0, 3}));
}

}  // namespace
}  // namespace pellucid
