// Tests acyclic clustering: no kept edge is violated, every cell has a cluster, cycles are broken and
// counted.
#include <gtest/gtest.h>

#include "order_helpers.h"
#include "transparency/cluster/clustering.h"
#include "transparency/cluster/edge_set.h"

namespace pellucid {
namespace {

using testing::EdgeMap;

constexpr MergePriority kPriorities[] = {MergePriority::union_size, MergePriority::intersection,
                                         MergePriority::difference};

OrderProblem acyclic_problem_of(const Mesh& mesh, double tolerance = 0.003) {
  OrderOptions options;
  options.distances = {1.5, kInfiniteDistance};
  return make_problem(mesh, {PartitionKind::sampled_triangles, 1, 1}, options, tolerance);
}

OrderOptions options_of(MergePriority priority, std::uint64_t seed = 1) {
  OrderOptions options;
  options.method = OrderMethod::acyclic;
  options.priority = priority;
  options.seed = seed;
  return options;
}

// Edges of all cells that their cluster's order violates. A cell without a cycle of its own must have none.
std::uint64_t violated_edges(const OrderProblem& problem, const Clustering& clustering) {
  const EdgeTable table = make_edge_table(problem.graph);
  std::uint64_t count = 0;
  for (std::uint32_t cell = 0; cell < problem.graph.cells.size(); ++cell) {
    const CompactRows& edges = problem.graph.cells[cell];
    const std::vector<std::uint32_t>& ranks = clustering.ranks[clustering.cluster_of[cell]];
    std::uint64_t here = 0;
    for (const auto& [pair, weight] : testing::map_of(edges))
      here += ranks[pair.first] > ranks[pair.second] ? 1U : 0U;
    std::vector<std::uint32_t> own;
    if (topological_ranks(table, edges_of_cell(table, edges), own)) {
      EXPECT_EQ(here, 0U) << "cell " << cell;
    }
    count += here;
  }
  return count;
}

void expect_sound(const OrderProblem& problem, const Clustering& clustering) {
  ASSERT_EQ(clustering.cluster_of.size(), problem.graph.cells.size());
  std::vector<int> cells(clustering.cluster_count(), 0);
  for (const std::uint32_t cluster : clustering.cluster_of) {
    ASSERT_LT(cluster, clustering.cluster_count());
    ++cells[cluster];
  }
  for (const int count : cells) EXPECT_GT(count, 0);
  for (const std::vector<std::uint32_t>& ranks : clustering.ranks) {
    EXPECT_EQ(ranks.size(), problem.graph.node_count);
    EXPECT_TRUE(testing::is_permutation_of_all(ranks));
  }
}

TEST(Acyclic, ViolatesNoKeptEdgeWhateverThePriority) {
  for (const Mesh& mesh : {testing::sample_mesh("torus-knot", 0.1, 300), testing::random_soup(60, 0.2, 1),
                           testing::nested_spheres(1)}) {
    const OrderProblem problem = acyclic_problem_of(mesh);
    for (const MergePriority priority : kPriorities) {
      OrderStatistics statistics;
      const Clustering clustering = cluster_acyclically(problem, options_of(priority), statistics);
      expect_sound(problem, clustering);
      EXPECT_LE(violated_edges(problem, clustering), statistics.dropped_edges);
      EXPECT_LE(clustering.cluster_count(), statistics.clusters_before_relaxation);
      EXPECT_LT(clustering.cluster_count(), problem.graph.cells.size());
      if (statistics.dropped_edges == 0) {
        EXPECT_EQ(clustering.cost, 0.0);
      }
    }
  }
}

TEST(Acyclic, AConvexMeshNeedsOneOrder) {
  // Only a face turned away lies behind one turned to the camera: no two edges ever disagree.
  const OrderProblem problem = acyclic_problem_of(testing::icosphere_mesh(2));
  for (const MergePriority priority : kPriorities) {
    OrderStatistics statistics;
    const Clustering clustering = cluster_acyclically(problem, options_of(priority), statistics);
    EXPECT_EQ(clustering.cluster_count(), 1U);
    EXPECT_EQ(clustering.cost, 0.0);
    EXPECT_EQ(statistics.cyclic_cells, 0U);
  }
}

TEST(Acyclic, BreaksACycleAtItsLightestEdge) {
  const OrderProblem problem = acyclic_problem_of(testing::three_sticks(), 0);
  OrderStatistics statistics;
  const Clustering clustering =
      cluster_acyclically(problem, options_of(MergePriority::union_size), statistics);
  expect_sound(problem, clustering);
  EXPECT_GT(statistics.cyclic_cells, 0U);
  // One edge of every cyclic cell.
  EXPECT_EQ(statistics.dropped_edges, statistics.cyclic_cells);
  EXPECT_EQ(violated_edges(problem, clustering), statistics.dropped_edges);
  EXPECT_GT(statistics.dropped_weight, 0.0);
  EXPECT_LT(statistics.dropped_weight, 1.0 / 3);
  EXPECT_NEAR(clustering.cost / problem.graph.total_weight, statistics.dropped_weight, 1e-6);
}

TEST(Acyclic, RelaxationOnlyLowersTheCount) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const OrderProblem problem = acyclic_problem_of(testing::random_soup(80, 0.3, seed));
    OrderOptions options = options_of(MergePriority::union_size, seed);
    options.fruitless_rounds = 0;
    OrderStatistics without;
    const Clustering unrelaxed = cluster_acyclically(problem, options, without);
    EXPECT_EQ(unrelaxed.cluster_count(), without.clusters_before_relaxation);
    EXPECT_EQ(without.iterations, 0U);
    options.fruitless_rounds = 5;
    OrderStatistics with;
    const Clustering relaxed = cluster_acyclically(problem, options, with);
    EXPECT_EQ(with.clusters_before_relaxation, without.clusters_before_relaxation);
    EXPECT_LE(relaxed.cluster_count(), unrelaxed.cluster_count());
    EXPECT_GE(with.iterations, 5U);
    expect_sound(problem, relaxed);
    EXPECT_LE(violated_edges(problem, relaxed), with.dropped_edges);
  }
}

}  // namespace
}  // namespace pellucid
