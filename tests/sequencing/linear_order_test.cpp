// Tests sifting against brute force over all permutations, on acyclic graphs, and that it never makes an
// order worse.
#include "sequencing/linear_order.h"

#include <gtest/gtest.h>

#include "order_helpers.h"

namespace pellucid {
namespace {

using testing::EdgeMap;
using testing::random_ranks;
using testing::rows_of;
using testing::violated;

EdgeMap random_edges(std::uint32_t nodes, std::size_t count, Random& random) {
  EdgeMap edges;
  for (std::size_t i = 0; i < count; ++i) {
    const auto u = static_cast<NodeId>(random.below(nodes));
    const auto v = static_cast<NodeId>(random.below(nodes));
    if (u != v) edges[{u, v}] = random.uniform(0.1, 1);
  }
  return edges;
}

// Returns edges that follow a hidden order, so that an order without violations exists.
EdgeMap random_dag(std::uint32_t nodes, std::size_t count, Random& random) {
  const std::vector<std::uint32_t> hidden = random_ranks(nodes, random);
  EdgeMap edges;
  for (const auto& [pair, weight] : random_edges(nodes, count, random)) {
    const bool forward = hidden[pair.first] < hidden[pair.second];
    edges[forward ? pair : std::pair{pair.second, pair.first}] = weight;
  }
  return edges;
}

double best_of_all(const EdgeMap& edges, std::uint32_t nodes) {
  std::vector<std::uint32_t> ranks(nodes);
  std::iota(ranks.begin(), ranks.end(), 0U);
  double best = violated(edges, ranks);
  while (std::next_permutation(ranks.begin(), ranks.end())) best = std::min(best, violated(edges, ranks));
  return best;
}

TEST(NetPreferences, AreAntisymmetricAndIncludeEveryEdge) {
  Random random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const auto nodes = static_cast<std::uint32_t>(2 + random.below(20));
    const EdgeMap edges = random_edges(nodes, random.below(100), random);
    const PairPreferences preferences = net_preferences(rows_of(nodes, edges));
    EdgeMap found;
    for (NodeId u = 0; u < nodes; ++u) {
      for (std::uint32_t i = preferences.offsets[u]; i < preferences.offsets[u + 1]; ++i)
        found[{u, preferences.neighbors[i]}] += static_cast<double>(preferences.weights[i]);
    }
    for (const auto& [pair, weight] : found) {
      EXPECT_EQ((found.at({pair.second, pair.first})), -weight);
      const auto get = [&](NodeId a, NodeId b) { return edges.contains({a, b}) ? edges.at({a, b}) : 0.0; };
      EXPECT_NEAR(weight, get(pair.first, pair.second) - get(pair.second, pair.first), 1e-6);
    }
    // The violated weight is the same computed from the edges and from the preferences.
    const std::vector<std::uint32_t> ranks = random_ranks(nodes, random);
    EXPECT_NEAR(violated_weight(preferences, ranks) + preferences.unavoidable, violated(edges, ranks), 1e-4);
  }
}

TEST(Sift, FindsTheOptimumOfMostSmallGraphs) {
  Random random(2);
  int optimal = 0;
  constexpr int kTrials = 60;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto nodes = static_cast<std::uint32_t>(3 + random.below(5));
    const EdgeMap edges = random_edges(nodes, 3 * nodes, random);
    const PairPreferences preferences = net_preferences(rows_of(nodes, edges));
    const double best = best_of_all(edges, nodes);
    std::vector<std::uint32_t> ranks = random_ranks(nodes, random);
    const double start = violated(edges, ranks);
    const double left = sift(preferences, {30, 0, {}}, ranks) + preferences.unavoidable;
    EXPECT_TRUE(testing::is_permutation_of_all(ranks));
    EXPECT_NEAR(left, violated(edges, ranks), 1e-4);
    EXPECT_LE(left, start + 1e-4);
    EXPECT_GE(left, best - 1e-4);
    optimal += left < best + 1e-4 ? 1 : 0;
  }
  EXPECT_GE(optimal, kTrials * 6 / 10);
}

TEST(Sift, NeverEndsWorseOnLargerGraphs) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const EdgeMap edges = random_edges(300, 5000, random);
    const PairPreferences preferences = net_preferences(rows_of(300, edges));
    std::vector<std::uint32_t> ranks = random_ranks(300, random);
    const double start = violated_weight(preferences, ranks);
    const double left = sift(preferences, {}, ranks);
    EXPECT_TRUE(testing::is_permutation_of_all(ranks));
    EXPECT_EQ(left, violated_weight(preferences, ranks));
    EXPECT_LT(left, 0.85 * start);  // about half of the weight before, and much less after
    const double again = left;
    EXPECT_LE(sift(preferences, {}, ranks), again);
  }
}

TEST(Sift, SortsAcyclicGraphs) {
  Random random(4);
  int sorted = 0;
  constexpr int kTrials = 50;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto nodes = static_cast<std::uint32_t>(5 + random.below(40));
    const EdgeMap edges = random_dag(nodes, 2 * nodes, random);
    const PairPreferences preferences = net_preferences(rows_of(nodes, edges));
    std::vector<std::uint32_t> ranks = random_ranks(nodes, random);
    const double start = violated(edges, ranks);
    const double left = sift(preferences, {100, 0, {}}, ranks);
    EXPECT_LE(left, 0.6 * start);
    sorted += left == 0 ? 1 : 0;
    // An order without violations does not change.
    if (left == 0) {
      const std::vector<std::uint32_t> before = ranks;
      EXPECT_EQ(sift(preferences, {}, ranks), 0.0);
      EXPECT_EQ(ranks, before);
    }
  }
  EXPECT_GE(sorted, kTrials / 2);
}

TEST(Sift, SortsAChain) {
  // Every pair has an edge, as in the depth order of parallel planes.
  EdgeMap edges;
  for (NodeId u = 0; u < 40; ++u) {
    for (NodeId v = u + 1; v < 40; ++v) edges[{u, v}] = 1;
  }
  Random random(5);
  std::vector<std::uint32_t> ranks = random_ranks(40, random);
  EXPECT_EQ(sift(net_preferences(rows_of(40, edges)), {100, 0, {}}, ranks), 0.0);
  for (NodeId u = 0; u < 40; ++u) EXPECT_EQ(ranks[u], u);
}

TEST(Sift, AcceptsGraphsWithoutNodesOrEdges) {
  std::vector<std::uint32_t> none;
  EXPECT_EQ(sift(net_preferences(rows_of(0, {})), {}, none), 0.0);
  std::vector<std::uint32_t> two{1, 0};
  EXPECT_EQ(sift(net_preferences(rows_of(2, {})), {}, two), 0.0);
  EXPECT_EQ(two, (std::vector<std::uint32_t>{1, 0}));
}

TEST(RanksByKey, SortsWithTiesByNode) {
  EXPECT_EQ(ranks_by_key(std::vector<double>{3, 1, 1, -2}), (std::vector<std::uint32_t>{3, 1, 2, 0}));
}

}  // namespace
}  // namespace pellucid
