// Tests which cells cannot share an order, against all ways of sharing.
#include <gtest/gtest.h>

#include "order_helpers.h"
#include "transparency/cluster/edge_set.h"

namespace pellucid {
namespace {

using testing::EdgeMap;

constexpr std::uint32_t kNodes = 12;

// Cells without cycles of their own, each from a random order.
struct Cells {
  OcclusionGraph graph;
  EdgeTable table;
  std::vector<EdgeSet> edges;

  Cells(std::uint32_t count, std::uint64_t edges_each, Random& random) {
    graph.node_count = kNodes;
    for (std::uint32_t cell = 0; cell < count; ++cell) {
      const std::vector<std::uint32_t> ranks = testing::random_ranks(kNodes, random);
      EdgeMap map;
      for (std::uint64_t i = 0; i < edges_each; ++i) {
        const auto u = static_cast<NodeId>(random.below(kNodes));
        const auto v = static_cast<NodeId>(random.below(kNodes));
        if (ranks[u] < ranks[v]) map[{u, v}] = 1;
      }
      graph.cells.emplace_back(testing::rows_of(kNodes, map));
    }
    table = make_edge_table(graph);
    for (const CompactRows& cell : graph.cells) edges.push_back(edges_of_cell(table, cell));
  }

  [[nodiscard]] EdgeSet united(std::span<const std::uint32_t> cells) const {
    std::vector<const EdgeSet*> parts;
    for (const std::uint32_t cell : cells) parts.push_back(&edges[cell]);
    return unite_all(table, parts);
  }
  [[nodiscard]] bool may_share(std::span<const std::uint32_t> cells) const {
    std::vector<std::uint32_t> ranks;
    return topological_ranks(table, united(cells), ranks);
  }
};

// The fewest groups of cells without a cycle, over all ways of grouping.
std::uint32_t fewest_groups(const Cells& cells) {
  const auto count = static_cast<std::uint32_t>(cells.edges.size());
  std::vector<std::uint32_t> least(std::size_t{1} << count, count);
  least[0] = 0;
  std::vector<bool> sound(least.size());
  for (std::uint32_t subset = 1; subset < least.size(); ++subset) {
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t cell = 0; cell < count; ++cell) {
      if ((subset >> cell & 1U) != 0) chosen.push_back(cell);
    }
    sound[subset] = cells.may_share(chosen);
  }
  for (std::uint32_t subset = 1; subset < least.size(); ++subset) {
    for (std::uint32_t part = subset; part != 0; part = (part - 1) & subset) {
      if (sound[part]) least[subset] = std::min(least[subset], 1 + least[subset ^ part]);
    }
  }
  return least.back();
}

TEST(ContradictingCells, NeverExceedTheFewestGroups) {
  Random random(4);
  int tight = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Cells cells(7, 6 + random.below(10), random);
    const std::vector<std::uint32_t> clique = contradicting_cells(cells.table, cells.edges);
    const std::uint32_t fewest = fewest_groups(cells);
    EXPECT_GE(clique.size(), 1U);
    EXPECT_LE(clique.size(), fewest);
    for (const std::uint32_t a : clique) {
      for (const std::uint32_t b : clique) {
        if (a == b) continue;
        EXPECT_FALSE(cells.may_share(std::vector<std::uint32_t>{a, b}));
      }
    }
    tight += clique.size() == fewest ? 1 : 0;
  }
  EXPECT_GT(tight, 50);
}

}  // namespace
}  // namespace pellucid
