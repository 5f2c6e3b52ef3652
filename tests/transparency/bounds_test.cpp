// Tests lower bounds against the best of all permutations.
#include <gtest/gtest.h>

#include "order_helpers.h"
#include "transparency/cluster/clustering.h"

namespace pellucid {
namespace {

using testing::EdgeMap;
using testing::violated;

EdgeMap random_exact_edges(std::uint32_t nodes, std::uint64_t count, Random& random) {
  EdgeMap edges;
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto u = static_cast<NodeId>(random.below(nodes));
    const auto v = static_cast<NodeId>(random.below(nodes));
    if (u != v) edges[{u, v}] = static_cast<double>(1 + random.below(32)) / 32;
  }
  return edges;
}

std::vector<std::vector<std::uint32_t>> permutations(std::uint32_t nodes) {
  std::vector<std::vector<std::uint32_t>> all;
  std::vector<std::uint32_t> ranks(nodes);
  std::iota(ranks.begin(), ranks.end(), 0U);
  do {
    all.push_back(ranks);
  } while (std::next_permutation(ranks.begin(), ranks.end()));
  return all;
}

TEST(UnavoidableWeight, IsAtMostTheBestOfAllPermutations) {
  Random random(1);
  double bounds = 0;
  double optima = 0;
  for (std::uint32_t nodes = 2; nodes <= 7; ++nodes) {
    const auto all = permutations(nodes);
    for (int trial = 0; trial < 12; ++trial) {
      const EdgeMap edges = random_exact_edges(nodes, random.below(std::uint64_t{nodes} * nodes), random);
      const EdgeRows rows = testing::rows_of(nodes, edges);
      double optimum = std::numeric_limits<double>::infinity();
      for (const auto& ranks : all) optimum = std::min(optimum, violated(edges, ranks));
      std::vector<std::uint32_t> sifted = testing::random_ranks(nodes, random);
      // From any order, also a bad one.
      EXPECT_LE(unavoidable_weight(rows, sifted), optimum + 1e-6);
      sift(net_preferences(rows), {}, sifted);
      const double bound = unavoidable_weight(rows, sifted);
      EXPECT_LE(bound, optimum + 1e-6);
      EXPECT_LE(optimum, violated(edges, sifted) + 1e-6);
      bounds += bound;
      optima += optimum;
    }
  }
  // And it says something.
  EXPECT_GT(bounds, 0.7 * optima);
}

TEST(UnavoidableWeight, IsTheLighterOfTwoOppositeEdgesAndTheLightestOfACycle) {
  const std::vector<std::uint32_t> ranks{0, 1, 2, 3};
  EXPECT_NEAR(unavoidable_weight(testing::rows_of(4, {{{0, 1}, 0.5}, {{1, 0}, 0.25}}), ranks), 0.25, 1e-7);
  EXPECT_NEAR(
      unavoidable_weight(testing::rows_of(4, {{{0, 1}, 0.5}, {{1, 2}, 0.75}, {{2, 0}, 0.625}}), ranks), 0.5,
      1e-7);
  EXPECT_NEAR(unavoidable_weight(
                  testing::rows_of(4, {{{0, 1}, 1}, {{1, 2}, 1}, {{2, 3}, 0.5}, {{3, 0}, 0.75}}), ranks),
              0.5, 1e-7);
  EXPECT_EQ(unavoidable_weight(testing::rows_of(4, {{{0, 1}, 1}, {{3, 2}, 1}}), ranks), 0.0);
}

TEST(UnavoidableInCells, NoTwoOrdersOfAFewCellsViolateLess) {
  Random random(2);
  const auto all = permutations(5);
  double floors = 0;
  for (int trial = 0; trial < 5; ++trial) {
    OcclusionGraph graph;
    graph.node_count = 5;
    std::vector<EdgeMap> cells;
    for (int cell = 0; cell < 3; ++cell) {
      cells.push_back(random_exact_edges(5, 14, random));
      graph.cells.emplace_back(testing::rows_of(5, cells.back()));
    }
    // Weights are kept with 8 bits: 1/32 .. 1 are exact.
    std::vector<std::vector<double>> costs;
    for (const auto& ranks : all) {
      costs.emplace_back();
      for (const EdgeMap& cell : cells) costs.back().push_back(violated(cell, ranks));
    }
    double optimum = std::numeric_limits<double>::infinity();
    for (const auto& a : costs) {
      for (const auto& b : costs) {
        double sum = 0;
        for (std::size_t cell = 0; cell < cells.size(); ++cell) sum += std::min(a[cell], b[cell]);
        optimum = std::min(optimum, sum);
      }
    }
    Clustering clustering;
    clustering.cluster_of = {0, 1, 0};
    clustering.ranks = {testing::random_ranks(5, random), testing::random_ranks(5, random)};
    const Clustering found = improve_clustering(graph, clustering, {});
    const double floor = unavoidable_in_cells(graph, found);
    EXPECT_LE(floor, optimum + 1e-6);
    EXPECT_LE(optimum, found.cost + 1e-6);
    floors += floor;
    // What the cells cannot avoid, a cluster of them cannot.
    for (std::uint32_t c = 0; c < found.cluster_count(); ++c) {
      const auto own = cells_of_cluster(found.cluster_of, c);
      if (own.empty()) continue;
      double best = std::numeric_limits<double>::infinity();
      for (const auto& cost : costs) {
        double sum = 0;
        for (const std::uint32_t cell : own) sum += cost[cell];
        best = std::min(best, sum);
      }
      EXPECT_LE(unavoidable_weight(sum_cells(graph, own), found.ranks[c]), best + 1e-6);
    }
  }
  EXPECT_GT(floors, 0.0);
}

}  // namespace
}  // namespace pellucid
