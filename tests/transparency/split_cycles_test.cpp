// Tests how cycles are found and cut: graphs against brute force, meshes against the exact occlusions and the
// raster.
#include <gtest/gtest.h>

#include <filesystem>

#include "order_helpers.h"
#include "pellucid/baseline.h"
#include "pellucid/sequencing.h"
#include "pellucid/shading.h"
#include "pellucid/transparency.h"
#include "sequencing/edge_rows.h"
#include "transparency/graph/viewpoint_edges.h"

namespace pellucid {
namespace {

struct Rows {
  std::vector<std::uint32_t> offsets, targets;
};

Rows random_graph(std::uint32_t nodes, double density, Random& random) {
  Rows rows;
  rows.offsets.push_back(0);
  for (std::uint32_t u = 0; u < nodes; ++u) {
    for (std::uint32_t v = 0; v < nodes; ++v) {
      if (u != v && random.uniform() < density) rows.targets.push_back(v);
    }
    rows.offsets.push_back(static_cast<std::uint32_t>(rows.targets.size()));
  }
  return rows;
}

TEST(StrongComponents, AreMutuallyReachableNodesInTopologicalOrder) {
  Random random(1);
  std::size_t acyclic = 0;
  for (int round = 0; round < 300; ++round) {
    const auto nodes = static_cast<std::uint32_t>(1 + random.below(14));
    const Rows rows = random_graph(nodes, random.uniform(0, 0.25), random);
    std::vector<std::vector<bool>> reach(nodes, std::vector<bool>(nodes, false));
    for (std::uint32_t u = 0; u < nodes; ++u) {
      for (std::uint32_t i = rows.offsets[u]; i < rows.offsets[u + 1]; ++i) reach[u][rows.targets[i]] = true;
    }
    for (std::uint32_t k = 0; k < nodes; ++k) {
      for (std::uint32_t u = 0; u < nodes; ++u) {
        for (std::uint32_t v = 0; v < nodes; ++v) {
          if (reach[u][k] && reach[k][v]) reach[u][v] = true;
        }
      }
    }
    const std::vector<std::uint32_t> component = strong_components(rows.offsets, rows.targets);
    bool cyclic = false;
    for (std::uint32_t u = 0; u < nodes; ++u) {
      cyclic = cyclic || reach[u][u];
      for (std::uint32_t v = 0; v < nodes; ++v) {
        if (u == v) continue;
        EXPECT_EQ(component[u] == component[v], reach[u][v] && reach[v][u]);
        EXPECT_TRUE(!reach[u][v] || component[u] >= component[v]);
      }
    }
    EXPECT_EQ(has_cycle(rows.offsets, rows.targets), cyclic);
    acyclic += cyclic ? 0U : 1U;
  }
  EXPECT_GT(acyclic, 50U);
  EXPECT_LT(acyclic, 250U);
}

TEST(StrongComponents, NoNodesAndLongChains) {
  EXPECT_FALSE(has_cycle({}, {}));
  EXPECT_TRUE(strong_components({}, {}).empty());
  // As deep as no stack is.
  constexpr std::uint32_t kLong = 2'000'000;
  Rows ring;
  for (std::uint32_t u = 0; u < kLong; ++u) {
    ring.offsets.push_back(u);
    ring.targets.push_back((u + 1) % kLong);
  }
  ring.offsets.push_back(kLong);
  EXPECT_TRUE(has_cycle(ring.offsets, ring.targets));
  EXPECT_EQ(strong_components(ring.offsets, ring.targets).back(), 0U);
}

PixelCount best_of(const Mesh& mesh, const BoundingSphere& sphere, const Viewpoint& view) {
  FragmentBuffer fragments;
  rasterize(mesh, look_at_sphere(sphere, view, 256, 256), {}, fragments);
  return count_incorrect_pixels(fragments, best_ranks(mesh, sphere, view, 256, Facing::duplicated));
}

// Share of pixels that are wrong in the best order of each of some views.
double unavoidable(const Mesh& mesh, std::uint64_t seed) {
  const BoundingSphere sphere = bounding_sphere(mesh);
  PixelCount sum;
  for (const Viewpoint& view : random_viewpoints(12, 2, 5, seed)) {
    const PixelCount count = best_of(mesh, sphere, view);
    sum.foreground += count.foreground;
    sum.incorrect += count.incorrect;
  }
  return static_cast<double>(sum.incorrect) / static_cast<double>(sum.foreground);
}

TEST(SplitUnordered, ThreeSticksInACycle) {
  const Mesh mesh = testing::three_sticks();
  const SplitResult result = split_unordered(mesh, {});
  EXPECT_EQ(result.intersecting_pairs, 0U);
  EXPECT_GT(result.cyclic_before, 0U);
  EXPECT_EQ(result.cyclic_left, 0U);
  EXPECT_EQ(result.viewpoints, 162U);
  EXPECT_EQ(result.added_by_intersections, 0U);
  EXPECT_EQ(mesh.triangles.size() + result.added_by_cycles, result.split.mesh.triangles.size());
  // One of them in two, for all viewpoints: three corners and four.
  EXPECT_LE(result.added_by_cycles, 6U);
  const Viewpoint above{{0, 0, 1}, kInfiniteDistance};
  const BoundingSphere sphere = bounding_sphere(mesh);
  EXPECT_GT(best_of(mesh, sphere, above).incorrect, 50U);
  EXPECT_EQ(best_of(result.split.mesh, sphere, above).incorrect, 0U);
}

TEST(SplitUnordered, SoupsHaveAnOrderAfterwards) {
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    const Mesh mesh = testing::random_soup(60, 0.5, seed);
    const SplitResult result = split_unordered(mesh, {});
    EXPECT_GT(result.intersecting_pairs, 10U);
    EXPECT_EQ(result.pairs_left, 0U);
    EXPECT_LE(result.cyclic_left, result.cyclic_before / 4);
    const double before = unavoidable(mesh, seed);
    const double after = unavoidable(result.split.mesh, seed);
    EXPECT_GT(before, 0.01);
    EXPECT_LT(after, before / 20);
  }
}

TEST(SplitUnordered, KeepsToItsLimit) {
  const Mesh mesh = testing::random_soup(100, 0.6, 5);
  for (const std::uint64_t limit : {0U, 7U, 20U}) {
    CycleOptions options;
    options.max_new_triangles = limit;
    const SplitResult result = split_unordered(mesh, options);
    EXPECT_LE(result.split.mesh.triangles.size(), mesh.triangles.size() + limit);
    EXPECT_FALSE(result.split.complete);
    EXPECT_GT(result.pairs_left, 0U);
  }
}

TEST(SplitUnordered, LeavesAMeshInOrderAlone) {
  const Mesh mesh = testing::nested_spheres(2);
  const SplitResult result = split_unordered(mesh, {});
  EXPECT_EQ(result.cyclic_before, 0U);
  EXPECT_EQ(result.split.mesh.triangles, mesh.triangles);
  EXPECT_TRUE(result.split.new_vertices.empty());
}

TEST(SplitUnordered, IsTheSameForAnyNumberOfThreads) {
  const Mesh mesh = testing::random_soup(80, 0.5, 6);
  const SplitResult first = split_unordered(mesh, {});
  const ThreadLimit one(1);
  const SplitResult second = split_unordered(mesh, {});
  EXPECT_GT(first.added_by_cycles, 0U);
  EXPECT_EQ(first.split.mesh.positions, second.split.mesh.positions);
  EXPECT_EQ(first.split.mesh.triangles, second.split.mesh.triangles);
}

TEST(SplitUnordered, LowersTheErrorOfPartsThatInterpenetrate) {
  const std::string path = std::string(PELLUCID_MODELS) + "/static/teapot_6k.obj";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "development model missing: " << path;
  const Mesh mesh = testing::read_plain_obj(path);
  const SplitResult result = split_unordered(mesh, {});
  EXPECT_GT(result.intersecting_pairs, 100U);
  EXPECT_EQ(result.pairs_left, 0U);
  EXPECT_LT(result.split.mesh.triangles.size(), mesh.triangles.size() * 11 / 10);
  EXPECT_LT(unavoidable(result.split.mesh, 1), unavoidable(mesh, 1) / 5);
}

TEST(BestRanks, AreAnOrderWithoutErrorWhereThereIsOne) {
  const Mesh mesh = testing::nested_spheres(2);
  const BoundingSphere sphere = bounding_sphere(mesh);
  for (const Viewpoint& view : random_viewpoints(4, 1.5, 5, 3)) {
    const std::vector<std::uint32_t> ranks = best_ranks(mesh, sphere, view, 256, Facing::duplicated);
    EXPECT_TRUE(testing::is_permutation_of_all(ranks));
    // Vertices snap to 1/256 pixel: along outlines neighbours may overlap by a sliver.
    const PixelCount count = best_of(mesh, sphere, view);
    EXPECT_LE(count.incorrect, count.foreground / 4000);
  }
}

TEST(BestRanks, ComeCloseToTheBestOfAllOrders) {
  Random random(8);
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    const Mesh mesh = testing::random_soup(5, 1, seed);
    const BoundingSphere sphere = bounding_sphere(mesh);
    const Viewpoint view{random.direction(), 3};
    FragmentBuffer fragments;
    rasterize(mesh, look_at_sphere(sphere, view, 128, 128), {}, fragments);
    std::vector<std::uint32_t> order{0, 1, 2, 3, 4};
    std::uint64_t least = ~std::uint64_t{0};
    do {
      std::vector<std::uint32_t> ranks(10);
      for (std::uint32_t t = 0; t < 5; ++t) ranks[2 * t] = ranks[2 * t + 1] = order[t];
      least = std::min(least, count_incorrect_pixels(fragments, ranks).incorrect);
    } while (std::next_permutation(order.begin(), order.end()));
    const std::vector<std::uint32_t> ranks = best_ranks(mesh, sphere, view, 128, Facing::duplicated);
    const PixelCount count = count_incorrect_pixels(fragments, ranks);
    EXPECT_GE(count.incorrect, least);
    EXPECT_LE(count.incorrect, least + count.foreground / 50);
  }
}

TEST(CyclicCells, AreCountedForBothMethods) {
  OrderOptions options;
  options.partition = {PartitionKind::sampled_triangles, 0, 1};
  options.max_buffers = 2;
  for (const OrderMethod method : {OrderMethod::budget, OrderMethod::acyclic}) {
    options.method = method;
    options.tolerance = 0;
    const Mesh mesh = testing::three_sticks();
    EXPECT_GT(order_mesh(mesh, options).statistics.cyclic_cells, 0U);
    EXPECT_EQ(order_mesh(testing::nested_spheres(1), options).statistics.cyclic_cells, 0U);
  }
}

}  // namespace
}  // namespace pellucid
