// Tests that orders keep every constraint, draw all nodes once, and use the vertex cache well.
#include <gtest/gtest.h>

#include <cmath>

#include "order_helpers.h"
#include "pellucid/metric.h"
#include "pellucid/sequencing.h"
#include "sequencing/cache_order.h"
#include "sequencing/fifo_cache.h"
#include "transparency/cluster/clustering.h"
#include "transparency/order_problem.h"

namespace pellucid {
namespace {

struct Case {
  Mesh mesh;
  EdgeRows edges;
  std::vector<std::uint32_t> ranks;
  std::vector<std::uint8_t> drawn;
};

// Random constraints between the nodes of a mesh, a random part of the nodes drawn.
Case random_case(const Mesh& mesh, double edges_per_node, std::uint64_t seed) {
  Random random(seed);
  const auto nodes = static_cast<std::uint32_t>(2 * mesh.triangles.size());
  testing::EdgeMap edges;
  for (double i = 0; i < edges_per_node * nodes; ++i) {
    const auto u = static_cast<NodeId>(random.below(nodes));
    const auto v = static_cast<NodeId>(random.below(nodes));
    if (u != v) edges[{u, v}] = random.uniform(0.01, 1);
  }
  Case result{mesh, testing::rows_of(nodes, edges), testing::random_ranks(nodes, random), {}};
  for (NodeId node = 0; node < nodes; ++node) result.drawn.push_back(random.below(4) > 0 ? 1 : 0);
  return result;
}

void expect_drawn_once(const NodeSequence& sequence, const std::vector<std::uint8_t>& drawn) {
  std::vector<std::uint8_t> seen(drawn.size(), 0);
  for (const NodeId node : sequence) {
    ASSERT_LT(node, drawn.size());
    EXPECT_EQ(seen[node], 0) << "drawn twice";
    seen[node] = 1;
  }
  EXPECT_EQ(seen, drawn);
}

double acmr_of(const Mesh& mesh, const NodeSequence& sequence) {
  return simulate_vertex_cache(index_buffer(mesh, sequence),
                               static_cast<std::uint32_t>(mesh.positions.size()), CacheModel::fifo, 20)
      .acmr;
}

// The ways from constraints to an order, with their names.
struct Method {
  const char* name;
  NodeSequence (*run)(const Mesh&, const OrderConstraints&, std::span<const std::uint32_t>,
                      std::span<const std::uint8_t>, std::uint32_t);
};
const Method kMethods[] = {
    {"tipsify", tipsify},
    {"list", list_schedule},
    {"list and search",
     [](const Mesh& mesh, const OrderConstraints& constraints, std::span<const std::uint32_t> ranks,
        std::span<const std::uint8_t> drawn, std::uint32_t cache_size) {
       return gather_visits(mesh, constraints, list_schedule(mesh, constraints, ranks, drawn, cache_size),
                            cache_size);
     }},
    {"rank and search",
     [](const Mesh& mesh, const OrderConstraints& constraints, std::span<const std::uint32_t> ranks,
        std::span<const std::uint8_t> drawn, std::uint32_t cache_size) {
       return gather_visits(mesh, constraints, order_by_rank(ranks, drawn), cache_size);
     }}};

void expect_in_order(const NodeSequence& sequence, const OrderConstraints& constraints) {
  const std::vector<std::uint32_t> position = ranks_of(sequence, (constraints.offsets.size() - 1) / 2);
  for (NodeId node = 0; node + 1 < constraints.offsets.size(); ++node) {
    for (const NodeId follower : constraints.followers_of(node)) {
      ASSERT_LT(position[node], position[follower]) << node << " before " << follower;
    }
  }
}

OrderConstraints unconstrained(std::size_t nodes) {
  return {std::vector<std::uint32_t>(nodes + 1, 0), {}};
}

// Every node to the next one by rank.
OrderConstraints chain_of(const NodeSequence& sequence, std::size_t nodes) {
  testing::EdgeMap edges;
  for (std::size_t i = 0; i + 1 < sequence.size(); ++i) edges[{sequence[i], sequence[i + 1]}] = 1;
  const EdgeRows rows = testing::rows_of(static_cast<std::uint32_t>(nodes), edges);
  return {rows.offsets, rows.backs};
}

// reached[u][v]: is there a path?
std::vector<std::vector<bool>> closure_of(const OrderConstraints& constraints) {
  const std::size_t nodes = constraints.offsets.size() - 1;
  std::vector<std::vector<bool>> reached(nodes, std::vector<bool>(nodes, false));
  for (NodeId start = 0; start < nodes; ++start) {
    std::vector<NodeId> open{start};
    while (!open.empty()) {
      const NodeId node = open.back();
      open.pop_back();
      for (const NodeId follower : constraints.followers_of(node)) {
        if (reached[start][follower]) continue;
        reached[start][follower] = true;
        open.push_back(follower);
      }
    }
  }
  return reached;
}

// Some views of the torus knot, which covers itself many times: its occlusion graph and a sifted order.
Case torus_knot_case(const std::vector<std::uint32_t>& cells) {
  Case c{testing::sample_mesh("torus-knot", 0.3, 1500), {}, {}, {}};
  OrderOptions options;
  options.distances = {3};
  const OrderProblem problem = make_problem(c.mesh, {PartitionKind::viewpoints, 0, 0}, options, 0);
  c.edges = sum_cells(problem.graph, cells);
  c.ranks = ranks_by_key(depth_keys(c.mesh, problem.sphere, problem.partition, cells));
  sift(net_preferences(c.edges), {}, c.ranks);
  c.drawn.assign(c.ranks.size(), 1);
  return c;
}

TEST(Sequence, EveryMethodKeepsEveryConstraintAndDrawsAllOnce) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const double density = 0.1 * static_cast<double>(seed);
    const Case c = random_case(
        seed % 2 == 0 ? testing::icosphere_mesh(2) : testing::random_soup(100, 0.2, seed), density, seed);
    const float least = seed % 3 == 0 ? 0.5F : 0.0F;
    const OrderConstraints constraints = agreeing_edges(c.edges, c.ranks, c.drawn, least);
    std::size_t expected = 0;
    for (const auto& [pair, weight] : testing::map_of(c.edges)) {
      const auto [u, v] = pair;
      if (c.drawn[u] == 0 || c.drawn[v] == 0 || weight < static_cast<double>(least)) continue;
      if (c.ranks[u] < c.ranks[v]) ++expected;
    }
    EXPECT_EQ(constraints.followers.size(), expected);
    EXPECT_GT(expected, 0U);
    const OrderConstraints reduced = without_implied(constraints, c.ranks, c.drawn);
    for (const Method& method : kMethods) {
      SCOPED_TRACE(method.name);
      for (const std::uint32_t cache_size : {3U, 20U}) {
        const NodeSequence sequence = method.run(c.mesh, reduced, c.ranks, c.drawn, cache_size);
        expect_drawn_once(sequence, c.drawn);
        expect_in_order(sequence, constraints);
        EXPECT_EQ(sequence, method.run(c.mesh, reduced, c.ranks, c.drawn, cache_size));
      }
    }
  }
}

TEST(Sequence, WithoutImpliedKeepsTheClosureAndNothingElse) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Case c = random_case(testing::random_soup(60, 0.2, seed), 0.4 * static_cast<double>(seed), seed);
    const OrderConstraints all = agreeing_edges(c.edges, c.ranks, c.drawn, 0);
    const OrderConstraints reduced = without_implied(all, c.ranks, c.drawn);
    const std::vector<std::vector<bool>> reached = closure_of(reduced);
    EXPECT_EQ(reached, closure_of(all));
    for (NodeId node = 0; node < c.drawn.size(); ++node) {
      for (const NodeId follower : reduced.followers_of(node)) {
        for (const NodeId other : reduced.followers_of(node)) EXPECT_FALSE(reached[other][follower]);
      }
    }
  }
}

// More nodes than are looked at in one go.
TEST(Sequence, WithoutImpliedOfALongChainIsTheChain) {
  constexpr std::uint32_t kNodes = 20000;
  testing::EdgeMap edges;
  for (NodeId node = 0; node + 1 < kNodes; ++node) {
    for (const NodeId step : {1U, 2U, 7U, 9000U}) {
      if (node + step < kNodes) edges[{node, node + step}] = 1;
    }
  }
  const EdgeRows rows = testing::rows_of(kNodes, edges);
  std::vector<std::uint32_t> ranks(kNodes);
  std::iota(ranks.begin(), ranks.end(), 0U);
  const std::vector<std::uint8_t> drawn(kNodes, 1);
  const OrderConstraints reduced = without_implied({rows.offsets, rows.backs}, ranks, drawn);
  ASSERT_EQ(reduced.followers.size(), kNodes - 1);
  for (NodeId node = 0; node + 1 < kNodes; ++node) {
    EXPECT_EQ(reduced.followers_of(node).front(), node + 1);
  }
}

TEST(Sequence, CountsMissesAsTheMetricDoes) {
  Random random(5);
  const Mesh mesh = testing::icosphere_mesh(3);
  const auto nodes = static_cast<std::uint32_t>(2 * mesh.triangles.size());
  const NodeSequence sequence = testing::random_ranks(nodes, random);
  for (const std::uint32_t size : {3U, 16U, 20U, 100U}) {
    EXPECT_EQ(fifo_misses(mesh, sequence, size),
              simulate_vertex_cache(index_buffer(mesh, sequence),
                                    static_cast<std::uint32_t>(mesh.positions.size()), CacheModel::fifo, size)
                  .misses);
  }
}

TEST(Sequence, SearchNeverAddsMisses) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Mesh mesh = seed % 2 == 0 ? testing::nested_spheres(2) : testing::icosphere_mesh(2);
    const Case c = random_case(mesh, 0.2 * static_cast<double>(seed), seed);
    const OrderConstraints constraints =
        without_implied(agreeing_edges(c.edges, c.ranks, c.drawn, 0), c.ranks, c.drawn);
    for (const std::uint32_t size : {3U, 12U, 20U}) {
      for (const NodeSequence& start :
           {order_by_rank(c.ranks, c.drawn), list_schedule(c.mesh, constraints, c.ranks, c.drawn, size)}) {
        EXPECT_LE(fifo_misses(c.mesh, gather_visits(c.mesh, constraints, start, size), size),
                  fifo_misses(c.mesh, start, size));
      }
    }
  }
}

TEST(Sequence, BeatsTheRankOrderAndTipsifyInTheCache) {
  const Case c = torus_knot_case({3});
  const double by_rank = acmr_of(c.mesh, order_by_rank(c.ranks, c.drawn));
  CacheOrderOptions options;
  options.method = CacheMethod::tipsify;
  const double tipsified = acmr_of(c.mesh, cache_aware_order(c.mesh, c.edges, c.ranks, c.drawn, options));
  options.method = CacheMethod::scheduled;
  const NodeSequence scheduled = cache_aware_order(c.mesh, c.edges, c.ranks, c.drawn, options);
  expect_drawn_once(scheduled, c.drawn);
  expect_in_order(scheduled, agreeing_edges(c.edges, c.ranks, c.drawn, 0));
  EXPECT_LT(tipsified, 0.6 * by_rank);
  EXPECT_LT(acmr_of(c.mesh, scheduled), 0.8 * tipsified);
}

TEST(Sequence, NeverMoreMissesThanByRank) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    // Ranks that suit the cache, and constraints that hardly leave a choice.
    Case c = random_case(testing::icosphere_mesh(2), 3.0, seed);
    const NodeSequence good = list_schedule(c.mesh, unconstrained(c.drawn.size()), c.ranks, c.drawn, 20);
    std::uint32_t next = 0;
    for (const NodeId node : good) c.ranks[node] = next++;
    for (NodeId node = 0; node < c.drawn.size(); ++node) {
      if (c.drawn[node] == 0) c.ranks[node] = next++;
    }
    for (const CacheMethod method : {CacheMethod::scheduled, CacheMethod::tipsify}) {
      CacheOrderOptions options;
      options.method = method;
      const NodeSequence sequence = cache_aware_order(c.mesh, c.edges, c.ranks, c.drawn, options);
      EXPECT_LE(fifo_misses(c.mesh, sequence, 20), fifo_misses(c.mesh, good, 20));
    }
  }
}

TEST(Sequence, SlackBuysMissesAndIsNeverExceeded) {
  const Case c = torus_knot_case({0, 1, 2, 3, 4, 5});
  const double least_violated = violated_weight_of(c.edges, c.ranks, c.drawn);
  std::vector<std::uint64_t> misses;
  bool used = false;
  for (const double slack : {0.0, 1e-5, 1e-3, 100.0}) {
    CacheOrderOptions options;
    options.least_binding = 1e-6F;
    options.slack = slack;
    const NodeSequence sequence = cache_aware_order(c.mesh, c.edges, c.ranks, c.drawn, options);
    expect_drawn_once(sequence, c.drawn);
    const double violated = violated_weight_of(c.edges, ranks_of(sequence, c.mesh.triangles.size()), c.drawn);
    EXPECT_LE(violated, least_violated + slack);
    used = used || violated > least_violated;
    misses.push_back(fifo_misses(c.mesh, sequence, 20));
  }
  EXPECT_TRUE(used);
  EXPECT_LT(misses.back(), 0.9 * static_cast<double>(misses.front()));
}

TEST(Sequence, BothFacingsStandTogetherWhereNoEdgeForbidsIt) {
  const Case c = torus_knot_case({3});
  const OrderConstraints free = unconstrained(c.drawn.size());
  for (const Method& method : kMethods) {
    EXPECT_LT(acmr_of(c.mesh, method.run(c.mesh, free, c.ranks, c.drawn, 20)), 0.45) << method.name;
  }
  const NodeSequence scheduled =
      gather_visits(c.mesh, free, list_schedule(c.mesh, free, c.ranks, c.drawn, 20), 20);
  EXPECT_LT(acmr_of(c.mesh, scheduled), 0.38);
}

TEST(Sequence, AChainLeavesNoChoice) {
  const Case c = random_case(testing::icosphere_mesh(1), 1, 3);
  const NodeSequence by_rank = order_by_rank(c.ranks, c.drawn);
  const OrderConstraints chain = chain_of(by_rank, c.drawn.size());
  for (const Method& method : kMethods) {
    EXPECT_EQ(method.run(c.mesh, chain, c.ranks, c.drawn, 20), by_rank) << method.name;
  }
}

// All triangles share one vertex: more uses than the searches look at.
TEST(Sequence, Fan) {
  Mesh mesh;
  mesh.positions.push_back({0, 0, 0});
  constexpr std::uint32_t kBlades = 3000;
  for (std::uint32_t i = 0; i <= kBlades; ++i) {
    mesh.positions.push_back(
        {std::cos(0.002F * static_cast<float>(i)), std::sin(0.002F * static_cast<float>(i)), 0});
    if (i > 0) mesh.triangles.push_back({0, i, i + 1});
  }
  const Case c = random_case(mesh, 0.2, 9);
  const OrderConstraints constraints =
      without_implied(agreeing_edges(c.edges, c.ranks, c.drawn, 0), c.ranks, c.drawn);
  for (const Method& method : kMethods) {
    SCOPED_TRACE(method.name);
    const NodeSequence sequence = method.run(c.mesh, constraints, c.ranks, c.drawn, 20);
    expect_drawn_once(sequence, c.drawn);
    expect_in_order(sequence, constraints);
  }
}

TEST(Sequence, ByRankAlone) {
  EXPECT_EQ(order_by_rank(std::vector<std::uint32_t>{3, 1, 0, 2}, std::vector<std::uint8_t>{1, 1, 0, 1}),
            (NodeSequence{1, 3, 0}));
  EXPECT_TRUE(order_by_rank({}, {}).empty());
}

TEST(Sequence, NothingOrOneTriangle) {
  const Mesh mesh = testing::one_triangle();
  const OrderConstraints none = unconstrained(2);
  const std::vector<std::uint32_t> ranks{1, 0};
  for (const Method& method : kMethods) {
    SCOPED_TRACE(method.name);
    EXPECT_TRUE(method.run(mesh, none, ranks, std::vector<std::uint8_t>{0, 0}, 20).empty());
    EXPECT_EQ(method.run(mesh, none, ranks, std::vector<std::uint8_t>{0, 1}, 3), NodeSequence{1});
    const NodeSequence both = method.run(mesh, none, ranks, std::vector<std::uint8_t>{1, 1}, 3);
    EXPECT_EQ(both.size(), 2U);
    EXPECT_EQ(fifo_misses(mesh, both, 3), 3U);
  }
  EdgeRows no_edges;
  no_edges.offsets.assign(3, 0);
  CacheOrderOptions options;
  options.slack = 1;
  EXPECT_TRUE(cache_aware_order(mesh, no_edges, ranks, std::vector<std::uint8_t>{0, 0}, options).empty());
  EXPECT_EQ(cache_aware_order(mesh, no_edges, ranks, std::vector<std::uint8_t>{1, 0}, options),
            NodeSequence{0});
}

}  // namespace
}  // namespace pellucid
