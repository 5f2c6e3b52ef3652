// Tests regions and switches against their definition, and joins of regions: they are bounded, split nothing,
// and do nothing unless requested.
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "order_helpers.h"
#include "transparency/cluster/clustering.h"

namespace pellucid {
namespace {

const PartitionSpec kTriangles{PartitionKind::sampled_triangles, 1, 0};
const PartitionSpec kPoints{PartitionKind::viewpoints, 1, 0};

std::uint32_t border_count(const ViewPartition& partition, const std::vector<std::uint32_t>& cluster_of) {
  std::uint32_t count = 0;
  for (std::uint32_t cell = 0; cell < partition.cell_count(); ++cell) {
    for (const std::uint32_t neighbor : partition.neighbors_of(cell))
      count += cluster_of[cell] != cluster_of[neighbor] ? 1U : 0U;
  }
  return count / 2;
}

struct Instance {
  ViewPartition partition;
  std::vector<double> costs;  // of three orders
  std::vector<std::uint32_t> cluster_of;

  Instance(const PartitionSpec& spec, Random& random) : partition(make_partition(spec)) {
    for (std::uint32_t cell = 0; cell < partition.cell_count(); ++cell) {
      std::uint32_t best = 0;
      for (std::uint32_t order = 0; order < 3; ++order) {
        costs.push_back(random.uniform(1, 1.2));
        if (costs.back() < costs[3 * cell + best]) best = order;
      }
      cluster_of.push_back(best);
    }
  }
};

TEST(JoinNeighbors, CostsNoMoreThanAllowedAndMakesFewerBordersAndRegions) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    for (const PartitionSpec& spec : {kTriangles, kPoints}) {
      Instance instance(spec, random);
      const std::vector<std::uint32_t> before = instance.cluster_of;
      const double violated =
          join_neighbors(instance.partition, instance.costs, 3, {0.1, 0}, instance.cluster_of);
      double sum = 0;
      for (std::size_t cell = 0; cell < before.size(); ++cell) {
        const double cost = instance.costs[3 * cell + instance.cluster_of[cell]];
        EXPECT_LE(cost, 1.1 * instance.costs[3 * cell + before[cell]] + 1e-12);
        sum += cost;
      }
      EXPECT_NEAR(violated, sum, 1e-9);
      EXPECT_LT(border_count(instance.partition, instance.cluster_of),
                border_count(instance.partition, before));
      EXPECT_LT(find_regions(instance.partition, instance.cluster_of).count,
                find_regions(instance.partition, before).count);
    }
  }
}

TEST(JoinNeighbors, SplitsNoRegion) {
  // Each cell may go where most neighbours are, but for those that hold their region together.
  Random random(2);
  std::uint32_t moved = 0;
  for (int trial = 0; trial < 30; ++trial) {
    Instance instance(kPoints, random);
    const std::vector<std::uint32_t> before = instance.cluster_of;
    const Regions regions = find_regions(instance.partition, before);
    join_neighbors(instance.partition, instance.costs, 3, {0.05, 0}, instance.cluster_of);
    // Cells of one region that kept its order are still connected.
    const Regions after = find_regions(instance.partition, instance.cluster_of);
    std::vector<std::set<std::uint32_t>> parts(regions.count);
    for (std::size_t cell = 0; cell < before.size(); ++cell) {
      if (instance.cluster_of[cell] == before[cell])
        parts[regions.region_of[cell]].insert(after.region_of[cell]);
      else
        ++moved;
    }
    for (const auto& part : parts) EXPECT_LE(part.size(), 1U);
  }
  EXPECT_GT(moved, 30U);
}

TEST(JoinNeighbors, EqualCostsJoinAndAShareOfNothingDoesNothing) {
  const ViewPartition partition = make_partition(kTriangles);
  std::vector<std::uint32_t> cluster_of(partition.cell_count());
  for (std::uint32_t cell = 0; cell < cluster_of.size(); ++cell) cluster_of[cell] = cell % 3;
  const std::vector<double> costs(3 * cluster_of.size(), 0.5);
  const std::vector<std::uint32_t> before = cluster_of;
  EXPECT_EQ(join_neighbors(partition, costs, 3, {0, 1}, cluster_of), 0.5 * 80);
  EXPECT_EQ(cluster_of, before);
  join_neighbors(partition, costs, 3, {1e-9, 0}, cluster_of);
  // No order loses its last cells.
  EXPECT_EQ(find_regions(partition, cluster_of).count, 3U);
  EXPECT_EQ(std::set<std::uint32_t>(cluster_of.begin(), cluster_of.end()).size(), 3U);
}

TEST(JoinNeighbors, AnIslandOfSeveralCellsGoesAsAWhole) {
  // No cell of the island has more neighbours outside than inside.
  const ViewPartition partition = make_partition({PartitionKind::sampled_triangles, 2, 0});
  std::vector<std::uint32_t> cluster_of(partition.cell_count(), 0);
  std::vector<double> costs(2 * cluster_of.size());
  for (std::uint32_t cell = 0; cell < cluster_of.size(); ++cell) {
    // Triangles of the icosahedron: an island, and a continent that needs the same order.
    const bool island = cell < 16;
    const bool continent = cell >= 160 && cell < 176;
    cluster_of[cell] = island || continent ? 1 : 0;
    costs[2 * cell] = island ? 1.01 : continent ? 5 : 1;
    costs[2 * cell + 1] = island || continent ? 1 : 2;
  }
  std::vector<std::uint32_t> strict = cluster_of;
  join_neighbors(partition, costs, 2, {0.005, 0}, strict);
  EXPECT_EQ(strict, cluster_of);
  EXPECT_EQ(find_regions(partition, strict).count, 3U);
  join_neighbors(partition, costs, 2, {0.02, 0}, cluster_of);
  EXPECT_EQ(find_regions(partition, cluster_of).count, 2U);
  EXPECT_EQ(cluster_of[0], 0U);
}

TEST(Regions, TwoHalvesAreTwoRegionsAndTwoSwitchesATurn) {
  const ViewPartition partition = make_partition({PartitionKind::sampled_triangles, 3, 0});
  std::vector<std::uint32_t> cluster_of(partition.cell_count());
  const Vec3d axis = normalized(Vec3d{1, 2, 3});
  for (std::uint32_t cell = 0; cell < cluster_of.size(); ++cell)
    cluster_of[cell] = dot(cell_direction(partition, cell), axis) > 0 ? 1 : 0;
  const Regions regions = find_regions(partition, cluster_of);
  EXPECT_EQ(regions.count, 2U);
  for (std::size_t cell = 0; cell < cluster_of.size(); ++cell)
    EXPECT_EQ(regions.region_of[cell] == regions.region_of[0], cluster_of[cell] == cluster_of[0]);
  EXPECT_EQ(switches_per_turn(partition, std::vector<std::uint32_t>(cluster_of.size(), 0)), 0.0);
  // Along the jagged border a circle crosses a few times more.
  EXPECT_GE(switches_per_turn(partition, cluster_of), 2.0);
  EXPECT_LT(switches_per_turn(partition, cluster_of), 3.5);
  // Two equal caps at opposite ends: three regions.
  for (std::uint32_t cell = 0; cell < cluster_of.size(); ++cell)
    cluster_of[cell] = std::abs(dot(cell_direction(partition, cell), axis)) > 0.8 ? 1 : 0;
  EXPECT_EQ(find_regions(partition, cluster_of).count, 3U);
}

}  // namespace
}  // namespace pellucid
