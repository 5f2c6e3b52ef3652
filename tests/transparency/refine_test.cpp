// Tests orders that are carried over from a simplified mesh to the full one, and their repair.
#include <gtest/gtest.h>

#include "metric/validation.h"
#include "order_helpers.h"
#include "sequencing/linear_order.h"
#include "transparency/cluster/clustering.h"
#include "transparency/upsample.h"

namespace pellucid {
namespace {

struct Carried {
  Mesh mesh;
  BoundingSphere sphere;
  PartitionSpec spec = parse_partition("S1,1");
  ViewPartition partition;
  std::vector<std::uint32_t> cluster_of;
  std::vector<std::vector<std::uint32_t>> ranks;
};

// Orders by depth with some nodes thrown out of place: nearly right, like a carried order.
Carried nearly_right_orders(double thrown) {
  Carried carried;
  carried.mesh = testing::sample_mesh("torus-knot", 0.2, 1500);
  carried.sphere = bounding_sphere(carried.mesh);
  carried.partition = make_partition(carried.spec);
  Random random(7);
  carried.cluster_of.resize(carried.partition.cell_count());
  for (std::uint32_t cell = 0; cell < carried.cluster_of.size(); ++cell) {
    carried.cluster_of[cell] = cell_direction(carried.partition, cell).z > 0 ? 0 : 1;
  }
  for (std::uint32_t cluster = 0; cluster < 2; ++cluster) {
    std::vector<double> keys = depth_keys(carried.mesh, carried.sphere, carried.partition,
                                          cells_of_cluster(carried.cluster_of, cluster));
    for (double& key : keys) {
      if (random.uniform(0, 1) < thrown) key = random.uniform(-1, 1);
    }
    carried.ranks.push_back(ranks_by_key(keys));
  }
  return carried;
}

double error_of(const Carried& c, const std::vector<std::vector<std::uint32_t>>& ranks) {
  return measure_order_error(c.mesh, c.sphere, c.partition, c.cluster_of, ranks,
                             held_out_viewpoints({1.5, 5}, false, 3, nullptr))
      .ipr;
}

RefineOptions quick_refinement() {
  RefineOptions options;
  options.raster_size = 256;
  options.distances = {1.5, 3.0, kInfiniteDistance};
  return options;
}

TEST(Refine, RepairsWhatIsOutOfPlace) {
  const Carried carried = nearly_right_orders(0.05);
  std::vector<std::vector<std::uint32_t>> ranks = carried.ranks;
  refine_orders(carried.mesh, carried.sphere, carried.spec, carried.cluster_of, quick_refinement(), ranks);
  for (const auto& order : ranks) EXPECT_TRUE(testing::is_permutation_of_all(order));
  EXPECT_LT(error_of(carried, ranks), 0.5 * error_of(carried, carried.ranks));
}

TEST(Refine, NoRoundsLeaveTheOrdersAsTheyAre) {
  const Carried carried = nearly_right_orders(0.05);
  std::vector<std::vector<std::uint32_t>> ranks = carried.ranks;
  RefineOptions options = quick_refinement();
  options.rounds = 0;
  refine_orders(carried.mesh, carried.sphere, carried.spec, carried.cluster_of, options, ranks);
  EXPECT_EQ(ranks, carried.ranks);
}

TEST(Refine, ReturnsEdgesThatAgreeAndSpanLessThanAWindow) {
  const Carried carried = nearly_right_orders(0.02);
  std::vector<std::vector<std::uint32_t>> ranks = carried.ranks;
  const std::vector<EdgeRows> known = refine_orders(carried.mesh, carried.sphere, carried.spec,
                                                    carried.cluster_of, quick_refinement(), ranks);
  ASSERT_EQ(known.size(), 2U);
  for (std::size_t cluster = 0; cluster < 2; ++cluster) {
    const testing::EdgeMap edges = testing::map_of(known[cluster]);
    EXPECT_GT(edges.size(), 100U);
    for (const auto& [pair, weight] : edges) {
      EXPECT_LT(ranks[cluster][pair.first], ranks[cluster][pair.second]);
      EXPECT_LT(ranks[cluster][pair.second] - ranks[cluster][pair.first],
                refine_window(2 * carried.mesh.triangles.size()));
      EXPECT_GT(weight, 0);
    }
  }
}

TEST(Refine, SameForAnyNumberOfThreads) {
  const Carried carried = nearly_right_orders(0.05);
  const auto refined = [&](unsigned threads) {
    const ThreadLimit limit(threads);
    std::vector<std::vector<std::uint32_t>> ranks = carried.ranks;
    refine_orders(carried.mesh, carried.sphere, carried.spec, carried.cluster_of, quick_refinement(), ranks);
    return ranks;
  };
  EXPECT_EQ(refined(1), refined(2));
}

TEST(WindowedSequence, IsARearrangementInsideWindowsThatKeepsTheEdges) {
  const Carried carried = nearly_right_orders(0);
  std::vector<std::vector<std::uint32_t>> ranks = carried.ranks;
  const std::vector<EdgeRows> known = refine_orders(carried.mesh, carried.sphere, carried.spec,
                                                    carried.cluster_of, quick_refinement(), ranks);
  const auto nodes = static_cast<std::uint32_t>(2 * carried.mesh.triangles.size());
  std::vector<std::uint8_t> drawn(nodes, 1);
  Random random(5);
  for (std::uint8_t& flag : drawn) flag = random.uniform(0, 1) < 0.8 ? 1 : 0;
  const NodeSequence sequence = windowed_sequence(carried.mesh, known[0], ranks[0], drawn, {});

  std::vector<std::uint32_t> drawn_ranks;
  for (NodeId node = 0; node < nodes; ++node) {
    if (drawn[node] != 0) drawn_ranks.push_back(ranks[0][node]);
  }
  std::sort(drawn_ranks.begin(), drawn_ranks.end());
  ASSERT_EQ(sequence.size(), drawn_ranks.size());
  const std::uint32_t window = refine_window(nodes);
  for (std::size_t begin = 0; begin < sequence.size(); begin += window) {
    const std::size_t end = std::min<std::size_t>(begin + window, sequence.size());
    std::vector<std::uint32_t> here;
    for (std::size_t i = begin; i < end; ++i) here.push_back(ranks[0][sequence[i]]);
    std::sort(here.begin(), here.end());
    EXPECT_TRUE(
        std::equal(here.begin(), here.end(), drawn_ranks.begin() + static_cast<std::ptrdiff_t>(begin)));
  }
  const std::vector<std::uint32_t> place = ranks_of(sequence, carried.mesh.triangles.size());
  for (const auto& [pair, weight] : testing::map_of(known[0])) {
    if (drawn[pair.first] == 0 || drawn[pair.second] == 0) continue;
    EXPECT_LT(place[pair.first], place[pair.second]);
  }
}

TEST(Upsampling, OrdersTheFullMeshFromASimplerOne) {
  const Mesh mesh = testing::sample_mesh("torus-knot", 0.3, 4000);
  ASSERT_GT(mesh.triangles.size(), 2000U);
  OrderOptions options;
  options.partition = parse_partition("S1,1");
  options.min_buffers = options.max_buffers = 3;
  options.upsample_from = 1000;
  options.refine_rounds = 0;
  const OrderResult carried = order_mesh(mesh, options);
  options.refine_rounds = 1;
  const OrderResult repaired = order_mesh(mesh, options);
  for (const OrderResult* result : {&carried, &repaired}) {
    EXPECT_EQ(result->orders.orders.size(), 3U);
    EXPECT_TRUE(testing::is_permutation_of_all(result->orders.base_sequence));
    EXPECT_EQ(result->orders.base_sequence.size(), mesh.triangles.size());
    EXPECT_GT(result->statistics.seconds.refine, 0);
  }
  EXPECT_LT(repaired.statistics.measured_error, carried.statistics.measured_error);
  EXPECT_LT(repaired.statistics.measured_error, 0.01);
}

}  // namespace
}  // namespace pellucid
