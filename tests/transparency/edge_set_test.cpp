// Tests edge sets against std::set, and topological orders against the algorithm of Kahn on thousands of
// small graphs.
#include "transparency/cluster/edge_set.h"

#include <gtest/gtest.h>

#include <set>

#include "order_helpers.h"

namespace pellucid {
namespace {

using testing::EdgeMap;
using Pairs = std::set<std::pair<NodeId, NodeId>>;

Pairs random_pairs(std::uint32_t nodes, std::uint64_t count, Random& random) {
  Pairs pairs;
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto u = static_cast<NodeId>(random.below(nodes));
    const auto v = static_cast<NodeId>(random.below(nodes));
    if (u != v) pairs.emplace(u, v);
  }
  return pairs;
}

OcclusionGraph graph_of(std::uint32_t nodes, const std::vector<Pairs>& cells) {
  OcclusionGraph graph;
  graph.node_count = nodes;
  for (const Pairs& cell : cells) {
    EdgeMap edges;
    for (const auto& pair : cell) edges[pair] = 1;
    graph.cells.emplace_back(testing::rows_of(nodes, edges));
  }
  return graph;
}

Pairs pairs_of(const EdgeTable& table, const EdgeSet& set) {
  Pairs pairs;
  for (NodeId front = 0; front + 1 < set.rows.size(); ++front) {
    for (std::uint32_t i = set.rows[front]; i < set.rows[front + 1]; ++i)
      pairs.emplace(front, table.backs[set.ids[i]]);
  }
  EXPECT_EQ(pairs.size(), set.size());
  return pairs;
}

// Kahn: take away nodes without predecessors until none is left.
bool acyclic(std::uint32_t nodes, const Pairs& edges) {
  std::vector<int> predecessors(nodes, 0);
  for (const auto& [u, v] : edges) ++predecessors[v];
  std::vector<NodeId> ready;
  for (NodeId n = 0; n < nodes; ++n) {
    if (predecessors[n] == 0) ready.push_back(n);
  }
  std::uint32_t taken = 0;
  while (!ready.empty()) {
    const NodeId node = ready.back();
    ready.pop_back();
    ++taken;
    for (const auto& [u, v] : edges) {
      if (u == node && --predecessors[v] == 0) ready.push_back(v);
    }
  }
  return taken == nodes;
}

void expect_topological(const std::vector<std::uint32_t>& ranks, const Pairs& edges) {
  EXPECT_TRUE(testing::is_permutation_of_all(ranks));
  for (const auto& [u, v] : edges) EXPECT_LT(ranks[u], ranks[v]);
}

Pairs united(const Pairs& a, const Pairs& b) {
  Pairs both = a;
  both.insert(b.begin(), b.end());
  return both;
}

TEST(EdgeSet, UnionAndIntersectionAreThoseOfSets) {
  Random random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const auto nodes = static_cast<std::uint32_t>(2 + random.below(30));
    const std::vector<Pairs> cells{random_pairs(nodes, random.below(120), random),
                                   random_pairs(nodes, random.below(120), random),
                                   random_pairs(nodes, random.below(20), random)};
    const OcclusionGraph graph = graph_of(nodes, cells);
    const EdgeTable table = make_edge_table(graph);
    std::vector<EdgeSet> sets;
    for (const CompactRows& cell : graph.cells) sets.push_back(edges_of_cell(table, cell));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(pairs_of(table, sets[i]), cells[i]);

    EXPECT_EQ(pairs_of(table, unite(sets[0], sets[1])), united(cells[0], cells[1]));
    const std::vector<const EdgeSet*> all{&sets[0], &sets[1], &sets[2]};
    EXPECT_EQ(pairs_of(table, unite_all(table, all)), united(united(cells[0], cells[1]), cells[2]));
    std::uint64_t common = 0;
    for (const auto& pair : cells[0]) common += cells[1].contains(pair) ? 1U : 0U;
    EXPECT_EQ(intersection_size(sets[0], sets[1]), common);

    for (NodeId front = 0; front < nodes; ++front) {
      for (std::uint32_t id = table.row_ids[front]; id < table.row_ids[front + 1]; ++id) {
        const std::uint32_t reverse = table.reverse[id];
        const Pairs everything = united(united(cells[0], cells[1]), cells[2]);
        EXPECT_EQ(reverse != kNoEdge, everything.contains({table.backs[id], front}));
        if (reverse != kNoEdge) {
          EXPECT_EQ(table.backs[reverse], front);
        }
      }
    }
  }
}

TEST(TopologicalRanks, AgreeWithKahn) {
  Random random(2);
  int cyclic = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const auto nodes = static_cast<std::uint32_t>(1 + random.below(15));
    const Pairs edges = random_pairs(nodes, random.below(2 * nodes), random);
    const OcclusionGraph graph = graph_of(nodes, {edges});
    const EdgeTable table = make_edge_table(graph);
    std::vector<std::uint32_t> ranks;
    const bool sorted = topological_ranks(table, edges_of_cell(table, graph.cells[0]), ranks);
    ASSERT_EQ(sorted, acyclic(nodes, edges)) << trial;
    if (sorted) expect_topological(ranks, edges);
    cyclic += sorted ? 0 : 1;
  }
  EXPECT_GT(cyclic, 300);
  EXPECT_LT(cyclic, 2700);
}

TEST(ExtendRanks, AgreeWithKahnEdgeSetByEdgeSet) {
  Random random(3);
  int accepted = 0;
  int refused = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const auto nodes = static_cast<std::uint32_t>(2 + random.below(20));
    std::vector<Pairs> parts;
    parts.reserve(6);
    for (int i = 0; i < 6; ++i) parts.push_back(random_pairs(nodes, 1 + random.below(6), random));
    const OcclusionGraph graph = graph_of(nodes, parts);
    const EdgeTable table = make_edge_table(graph);
    Pairs base;
    EdgeSet base_set = unite_all(table, {});
    std::vector<std::uint32_t> ranks = testing::random_ranks(nodes, random);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const EdgeSet added = edges_of_cell(table, graph.cells[i]);
      const std::vector<std::uint32_t> before = ranks;
      const bool possible = acyclic(nodes, united(base, parts[i]));
      ASSERT_EQ(extend_ranks(table, base_set, added, ranks), possible) << trial;
      if (!possible) {
        EXPECT_EQ(ranks, before);
        ++refused;
        continue;
      }
      base = united(base, parts[i]);
      base_set = unite(base_set, added);
      expect_topological(ranks, base);
      ++accepted;
    }
  }
  EXPECT_GT(accepted, 1000);
  EXPECT_GT(refused, 1000);
}

// Every pair of nodes with a path between them.
Pairs closure(std::uint32_t nodes, const Pairs& edges) {
  Pairs paths = edges;
  for (NodeId via = 0; via < nodes; ++via) {
    for (NodeId from = 0; from < nodes; ++from) {
      for (NodeId to = 0; to < nodes; ++to) {
        if (paths.contains({from, via}) && paths.contains({via, to})) paths.emplace(from, to);
      }
    }
  }
  return paths;
}

TEST(WithoutShortcuts, KeepsEveryPathAndNoTriangle) {
  Random random(4);
  std::size_t removed = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const auto nodes = static_cast<std::uint32_t>(2 + random.below(12));
    Pairs edges;
    for (const auto& [u, v] : random_pairs(nodes, 4 * nodes, random))
      edges.emplace(std::min(u, v), std::max(u, v));
    const OcclusionGraph graph = graph_of(nodes, {edges});
    const EdgeTable table = make_edge_table(graph);
    const Pairs kept = pairs_of(table, without_shortcuts(table, edges_of_cell(table, graph.cells[0])));
    EXPECT_EQ(closure(nodes, kept), closure(nodes, edges));
    for (const auto& [u, v] : edges) {
      bool implied = false;
      for (NodeId via = 0; via < nodes; ++via)
        implied |= edges.contains({u, via}) && edges.contains({via, v});
      EXPECT_EQ(kept.contains({u, v}), !implied);
    }
    removed += edges.size() - kept.size();
  }
  EXPECT_GT(removed, 500U);
}

}  // namespace
}  // namespace pellucid
