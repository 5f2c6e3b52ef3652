// Tests occlusion graphs: cells are means of their samples, sums of sparse rows equal those of a map, and
// pruned weight is accounted for.
#include "transparency/graph/occlusion_graph.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "order_helpers.h"
#include "transparency/graph/viewpoint_edges.h"

namespace pellucid {
namespace {

using testing::EdgeMap;

OcclusionGraph graph_of(const Mesh& mesh, const ViewPartition& partition, const GraphOptions& options) {
  return build_occlusion_graph(mesh, bounding_sphere(mesh), partition, options);
}

// The mean over the samples of one cell, one viewpoint after the other.
EdgeMap mean_of_samples(const Mesh& mesh, const ViewPartition& partition, std::uint32_t cell,
                        const GraphOptions& options) {
  const BoundingSphere sphere = bounding_sphere(mesh);
  const OcclusionScene scene{
      mesh, sphere, unit_positions(mesh, sphere), options.front_only, options.tolerance, options.raster_size};
  EdgeMap sum;
  double views = 0;
  OcclusionScratch scratch;
  ViewpointEdges edges;
  for (const std::uint32_t sample : partition.samples_of(cell)) {
    std::vector<double> distances = options.distances;
    if (!options.all_distances) distances = {options.distances[sample % options.distances.size()]};
    for (const double distance : distances) {
      find_edges_exactly(scene, {partition.samples[sample], distance}, scratch, edges);
      ++views;
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::uint32_t i = edges.offsets[t]; i < edges.offsets[t + 1]; ++i) {
          sum[{node_of(t, edges.front_flipped[t] != 0), edges.backs[i]}] +=
              static_cast<double>(edges.areas[i]);
        }
      }
    }
  }
  for (auto& [pair, weight] : sum) weight /= views;
  return sum;
}

constexpr double kWeightError = 1.0 / 256;  // of CompactRows, relative

TEST(CompactRows, HoldWhatTheyAreMadeOf) {
  Random random(7);
  // More nodes than one step of the lower half bridges; rows that begin, end and jump anywhere.
  const std::uint32_t nodes = 300000;
  EdgeMap edges;
  for (int i = 0; i < 4000; ++i) {
    const auto front = static_cast<NodeId>(random.below(40));
    edges[{front, static_cast<NodeId>(random.below(nodes))}] = std::pow(10.0, random.uniform(-9, 1));
  }
  for (const NodeId back : {0U, 0xFFFEU, 0xFFFFU, 0x10000U, 0x1FFFEU, nodes - 1}) edges[{50, back}] = 0.5;
  const CompactRows compact(testing::rows_of(nodes, edges));
  EXPECT_EQ(compact.node_count(), nodes);
  EXPECT_EQ(compact.edge_count(), edges.size());
  const EdgeMap found = testing::map_of(compact);
  ASSERT_EQ(found.size(), edges.size());
  for (const auto& [pair, weight] : edges) {
    ASSERT_TRUE(found.contains(pair));
    EXPECT_NEAR(found.at(pair), weight, kWeightError * weight);
  }
}

TEST(OcclusionGraph, ACellIsTheMeanOfItsSamples) {
  const Mesh mesh = testing::random_soup(40, 0.5, 1);
  for (const bool all_distances : {false, true}) {
    // 80 cells: several batches, samples shared between them.
    const ViewPartition partition = make_partition({PartitionKind::sampled_triangles, 1, 1});
    GraphOptions options;
    options.distances = {1.5, 4.0, kInfiniteDistance};
    options.all_distances = all_distances;
    const OcclusionGraph graph = graph_of(mesh, partition, options);
    ASSERT_EQ(graph.cells.size(), 80U);
    EXPECT_EQ(graph.viewpoint_count, partition.samples.size() * (all_distances ? 3 : 1));
    double total = 0;
    for (std::uint32_t cell = 0; cell < 80; ++cell) {
      const EdgeMap expected = mean_of_samples(mesh, partition, cell, options);
      const EdgeMap found = testing::map_of(graph.cells[cell]);
      ASSERT_EQ(found.size(), expected.size()) << cell;
      for (const auto& [pair, weight] : expected) {
        ASSERT_TRUE(found.contains(pair)) << cell;
        EXPECT_NEAR(found.at(pair), weight, 1e-6 + kWeightError * weight);
        total += weight;
      }
    }
    EXPECT_NEAR(graph.total_weight, total, 1e-4 * total);
    EXPECT_EQ(graph.pruned_weight, 0.0);
  }
}

TEST(OcclusionGraph, ViewpointCellsSeeTheirVertex) {
  const Mesh mesh = testing::random_soup(30, 0.5, 2);
  const ViewPartition partition = make_partition({PartitionKind::viewpoints, 1, 0});
  GraphOptions options;
  options.distances = {2.0};
  options.all_distances = true;
  const OcclusionGraph graph = graph_of(mesh, partition, options);
  for (const std::uint32_t cell : {0U, 17U, 41U}) {
    const EdgeMap expected = mean_of_samples(mesh, partition, cell, options);
    EXPECT_EQ(testing::map_of(graph.cells[cell]).size(), expected.size());
  }
}

TEST(OcclusionGraph, PrunedWeightIsWhatIsMissing) {
  const Mesh mesh = testing::random_soup(60, 0.3, 3);
  const ViewPartition partition = make_partition({PartitionKind::sampled_triangles, 0, 1});
  GraphOptions options;
  options.distances = {3.0};
  const OcclusionGraph whole = graph_of(mesh, partition, options);
  options.least_weight = 2e-3F;
  const OcclusionGraph pruned = graph_of(mesh, partition, options);
  EXPECT_NEAR(pruned.total_weight, whole.total_weight, 1e-5 * whole.total_weight);
  const auto least = static_cast<double>(options.least_weight);
  double kept = 0;
  for (std::uint32_t cell = 0; cell < partition.cell_count(); ++cell) {
    const EdgeMap all = testing::map_of(whole.cells[cell]);
    const EdgeMap heavy = testing::map_of(pruned.cells[cell]);
    EXPECT_LT(heavy.size(), all.size());
    for (const auto& [pair, weight] : all) {
      if (std::abs(weight - least) <= kWeightError * least) continue;
      EXPECT_EQ(heavy.contains(pair), weight >= least);
    }
    for (const auto& [pair, weight] : heavy) kept += weight;
  }
  EXPECT_NEAR(pruned.pruned_weight, 1 - kept / whole.total_weight, 1e-3);
  EXPECT_GT(pruned.pruned_weight, 0.001);
}

TEST(OcclusionGraph, ThreadsDoNotMatter) {
  const Mesh mesh = testing::random_soup(80, 0.4, 4);
  const ViewPartition partition = make_partition({PartitionKind::sampled_triangles, 1, 1});
  GraphOptions options;
  options.distances = {1.5, kInfiniteDistance};
  const OcclusionGraph many = graph_of(mesh, partition, options);
  const ThreadLimit one(1);
  const OcclusionGraph single = graph_of(mesh, partition, options);
  for (std::uint32_t cell = 0; cell < partition.cell_count(); ++cell) {
    EXPECT_EQ(testing::map_of(many.cells[cell]), testing::map_of(single.cells[cell]));
  }
  EXPECT_EQ(many.total_weight, single.total_weight);
  EXPECT_EQ(many.intersecting, single.intersecting);
}

TEST(OcclusionGraph, WhatIsInTheFileIsWhatWouldBeInMemory) {
  const Mesh mesh = testing::random_soup(80, 0.4, 5);
  const ViewPartition partition = make_partition({PartitionKind::sampled_triangles, 1, 1});
  GraphOptions options;
  options.distances = {2.0};
  const OcclusionGraph whole = graph_of(mesh, partition, options);
  EXPECT_FALSE(whole.spilled);
  std::uint64_t bytes = 0;
  for (const CompactRows& cell : whole.cells) bytes += cell.memory_bytes();
  options.memory = bytes / 2;
  const OcclusionGraph spilled = graph_of(mesh, partition, options);
  EXPECT_TRUE(spilled.spilled);
  std::uint64_t kept = 0;
  for (std::uint32_t cell = 0; cell < partition.cell_count(); ++cell) {
    EXPECT_EQ(testing::map_of(whole.cells[cell]), testing::map_of(spilled.cells[cell]));
    kept += spilled.cells[cell].memory_bytes();
  }
  EXPECT_LT(kept, bytes * 3 / 4);  // where rows begin stays in memory
  const std::vector<std::uint32_t> some = {3, 20, 21, 79};
  EXPECT_EQ(testing::map_of(sum_cells(whole, some)), testing::map_of(sum_cells(spilled, some)));
  options.memory = 2 * bytes;
  EXPECT_FALSE(graph_of(mesh, partition, options).spilled);
}

#ifndef _WIN32  // asks the system for the folder, not $TMPDIR

TEST(SpillFile, NamesTheFolderThatCannotHoldIt) {
  const char* before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  ::setenv("TMPDIR", "/nonexistent", 1);
  try {
    const SpillFile file;
    ADD_FAILURE() << "made a file in a folder that is not there";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::cannot_write);
    EXPECT_NE(std::string(error.what()).find("/nonexistent"), std::string::npos);
  }
  if (before == nullptr) {
    ::unsetenv("TMPDIR");
  } else {
    ::setenv("TMPDIR", kept.c_str(), 1);
  }
}

#endif

TEST(OcclusionGraph, RasterSourceFindsMostOfTheWeight) {
  const Mesh mesh = testing::nested_spheres(1);
  const ViewPartition partition = make_partition({PartitionKind::sampled_triangles, 0, 0});
  GraphOptions options;
  options.distances = {3.0};
  const OcclusionGraph exact = graph_of(mesh, partition, options);
  options.source = OcclusionSource::raster;
  options.raster_size = 256;
  const OcclusionGraph raster = graph_of(mesh, partition, options);
  for (std::uint32_t cell = 0; cell < partition.cell_count(); ++cell) {
    const EdgeMap all = testing::map_of(exact.cells[cell]);
    double inside = 0;
    double outside = 0;
    for (const auto& [pair, weight] : testing::map_of(raster.cells[cell])) {
      (all.contains(pair) ? inside : outside) += weight;
    }
    EXPECT_GT(inside, 1.0);
    // Seen along a vertex, as here, many edges of the mesh cover each other exactly: corners are snapped.
    EXPECT_LT(outside, 0.01 * inside);
  }
}

// ------------------------------------------------------------------------------------------ sparse rows

TEST(RowAccumulator, AddsLikeAMap) {
  Random random(5);
  for (const std::uint32_t nodes : {1U, 63U, 64U, 65U, 5000U}) {
    RowAccumulator accumulator(nodes);
    for (int row = 0; row < 60; ++row) {
      std::map<NodeId, double> expected;
      for (std::uint64_t part = random.below(6); part > 0; --part) {
        std::vector<NodeId> backs;
        std::vector<float> weights;
        // Sums of multiples of 1/128 are exact in single precision.
        const float scale = random.below(2) == 0 ? 0.5F : 2.0F;
        for (std::uint64_t i = random.below(row < 40 ? 8 : 400); i > 0; --i) {
          backs.push_back(static_cast<NodeId>(random.below(nodes)));
          weights.push_back(static_cast<float>(1 + random.below(64)) / 64.0F);
          expected[backs.back()] += static_cast<double>(weights.back() * scale);
        }
        accumulator.add(backs, weights, scale);
      }
      const float least = row % 2 == 0 ? 0.0F : 0.5F;
      EdgeRows rows;
      const double left_out = accumulator.flush(rows, least);
      std::vector<NodeId> backs;
      double light = 0;
      for (const auto& [back, weight] : expected) {
        if (weight >= static_cast<double>(least)) backs.push_back(back);
        if (weight < static_cast<double>(least)) light += weight;
      }
      ASSERT_EQ(rows.backs, backs);
      for (std::size_t i = 0; i < backs.size(); ++i) {
        EXPECT_EQ(static_cast<double>(rows.weights[i]), expected[backs[i]]);
      }
      EXPECT_EQ(left_out, light);
      EXPECT_EQ(rows.offsets.back(), backs.size());
    }
  }
}

TEST(SumCells, AddsTheCellsNamed) {
  Random random(8);
  OcclusionGraph graph;
  graph.node_count = 2500;  // several blocks of rows
  EdgeMap expected;
  for (std::uint32_t cell = 0; cell < 5; ++cell) {
    EdgeMap edges;
    for (int i = 0; i < 3000; ++i) {
      const auto front = static_cast<NodeId>(random.below(graph.node_count));
      edges[{front, static_cast<NodeId>(random.below(graph.node_count))}] = random.uniform(0.1, 1);
    }
    graph.cells.emplace_back(testing::rows_of(graph.node_count, edges));
    if (cell % 2 == 0) {
      for (const auto& [pair, weight] : edges) expected[pair] += weight;
    }
  }
  const EdgeMap sum = testing::map_of(sum_cells(graph, std::vector<std::uint32_t>{0, 2, 4}));
  ASSERT_EQ(sum.size(), expected.size());
  for (const auto& [pair, weight] : expected) EXPECT_NEAR(sum.at(pair), weight, kWeightError * weight);
  EXPECT_TRUE(testing::map_of(sum_cells(graph, {})).empty());
}

}  // namespace
}  // namespace pellucid
