// Sequences keep every constraint, draw all nodes once, and keep the vertex cache warm.
#include "sequence.h"

#include <gtest/gtest.h>

#include "order_helpers.h"
#include "order_problem.h"
#include "pellucid/metric.h"

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

TEST(Sequence, KeepsEveryConstraintAndDrawsAllOnce) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const double density = 0.1 * static_cast<double>(seed);
    const Case c = random_case(
        seed % 2 == 0 ? testing::icosphere_mesh(2) : testing::random_soup(100, 0.2, seed), density, seed);
    const float least = seed % 3 == 0 ? 0.5F : 0.0F;
    const SequenceConstraints constraints = agreeing_edges(c.edges, c.ranks, c.drawn, least);
    const NodeSequence sequence = cache_aware_sequence(c.mesh, constraints, c.ranks, c.drawn, 20);
    expect_drawn_once(sequence, c.drawn);
    const std::vector<std::uint32_t> position = ranks_of(sequence, c.mesh.triangles.size());
    std::size_t bound = 0;
    for (const auto& [pair, weight] : testing::map_of(c.edges)) {
      const auto [u, v] = pair;
      if (c.drawn[u] == 0 || c.drawn[v] == 0 || weight < static_cast<double>(least)) continue;
      if (c.ranks[u] > c.ranks[v]) continue;
      EXPECT_LT(position[u], position[v]);
      ++bound;
    }
    EXPECT_EQ(bound, constraints.followers.size());
    EXPECT_GT(bound, 0U);
  }
}

TEST(Sequence, BeatsTheRankOrderInTheCache) {
  const Mesh mesh = testing::sample_mesh("torus-knot", 0.3, 1500);
  OrderOptions options;
  options.distances = {3};
  const OrderProblem problem = make_problem(mesh, {PartitionKind::viewpoints, 0, 0}, options, 0);
  const std::vector<std::uint32_t> cells{3};
  const EdgeRows edges = sum_cells(problem.graph, cells);
  // A topological order by depth of the one view there is.
  std::vector<double> keys(problem.graph.node_count);
  for (NodeId node = 0; node < keys.size(); ++node) {
    Vec3d sum{};
    for (const std::uint32_t v : mesh.triangles[triangle_of(node)]) sum += to_double(mesh.positions[v]);
    keys[node] = -dot(sum, cell_direction(problem.partition, 3));
  }
  std::vector<NodeId> nodes(keys.size());
  std::iota(nodes.begin(), nodes.end(), 0U);
  std::sort(nodes.begin(), nodes.end(), [&](NodeId a, NodeId b) { return keys[a] < keys[b]; });
  std::vector<std::uint32_t> ranks(nodes.size());
  for (std::uint32_t rank = 0; rank < nodes.size(); ++rank) ranks[nodes[rank]] = rank;

  const std::vector<std::uint8_t> drawn(keys.size(), 1);
  const SequenceConstraints constraints = agreeing_edges(edges, ranks, drawn, 0);
  const NodeSequence sequence = cache_aware_sequence(mesh, constraints, ranks, drawn, 20);
  expect_drawn_once(sequence, drawn);
  EXPECT_LT(acmr_of(mesh, sequence), 0.6 * acmr_of(mesh, rank_sequence(ranks, drawn)));
  // Without constraints it is tipsify.
  const SequenceConstraints free{std::vector<std::uint32_t>(keys.size() + 1, 0), {}};
  EXPECT_LT(acmr_of(mesh, cache_aware_sequence(mesh, free, ranks, drawn, 20)), 0.45);
}

TEST(Sequence, ByRankAlone) {
  EXPECT_EQ(rank_sequence(std::vector<std::uint32_t>{3, 1, 0, 2}, std::vector<std::uint8_t>{1, 1, 0, 1}),
            (NodeSequence{1, 3, 0}));
  EXPECT_TRUE(rank_sequence({}, {}).empty());
}

TEST(Sequence, NothingDrawnIsNothing) {
  const Mesh mesh = testing::one_triangle();
  const SequenceConstraints none{{0, 0, 0}, {}};
  const std::vector<std::uint32_t> ranks{0, 1};
  EXPECT_TRUE(cache_aware_sequence(mesh, none, ranks, std::vector<std::uint8_t>{0, 0}, 20).empty());
  EXPECT_EQ(cache_aware_sequence(mesh, none, ranks, std::vector<std::uint8_t>{0, 1}, 3), NodeSequence{1});
}

}  // namespace
}  // namespace pellucid
