// Tests baselines and cache statistics against hand counts and simple properties.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "baseline/measured_method.h"
#include "pellucid/baseline.h"
#include "report/handmade.h"

namespace pellucid {
namespace {

Mesh random_mesh(std::uint64_t seed, std::uint32_t vertices, std::uint32_t triangles) {
  Random random(seed);
  Mesh mesh;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    mesh.positions.push_back(to_float(Vec3d{random.uniform(), random.uniform(), random.uniform()}));
  }
  while (mesh.triangles.size() < triangles) {
    const auto corner = [&] { return static_cast<std::uint32_t>(random.below(vertices)); };
    const Triangle t{corner(), corner(), corner()};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  }
  return mesh;
}

TEST(Baselines, CacheStatisticsOfTwoTriangles) {
  const Mesh mesh = testing::two_triangles();
  const NodeSequence front{node_of(0, false), node_of(1, false)};
  const BufferStatistics single = sequence_statistics(mesh, front, CacheModel::fifo, 20);
  EXPECT_EQ(single.triangles, 2U);
  EXPECT_EQ(single.misses, 4U);
  EXPECT_DOUBLE_EQ(single.acmr, 2.0);
  EXPECT_DOUBLE_EQ(single.acmr_drawn, 2.0);

  // Both facings of a triangle share all vertices. So there are half as many misses per listed triangle, and
  // the same number per drawn one.
  const NodeSequence both_facings{0, 1, 2, 3};
  const BufferStatistics both = sequence_statistics(mesh, both_facings, CacheModel::fifo, 20);
  EXPECT_EQ(both.misses, 4U);
  EXPECT_DOUBLE_EQ(both.acmr, 1.0);
  EXPECT_DOUBLE_EQ(both.acmr_drawn, 2.0);

  const BufferStatistics pool = pooled(std::vector{single, both});
  EXPECT_EQ(pool.triangles, 6U);
  EXPECT_EQ(pool.misses, 8U);
  EXPECT_DOUBLE_EQ(pool.acmr, 8.0 / 6.0);
  EXPECT_DOUBLE_EQ(pool.acmr_drawn, 2.0);
}

TEST(Baselines, EmptyOrderHasNoMisses) {
  const BufferStatistics none = sequence_statistics(testing::two_triangles(), {}, CacheModel::fifo, 20);
  EXPECT_EQ(none.misses, 0U);
  EXPECT_EQ(none.acmr, 0.0);
}

TEST(Baselines, CacheOrderIsAPermutationEvenWithDuplicates) {
  Mesh mesh = random_mesh(7, 60, 300);
  mesh.triangles.push_back(mesh.triangles[3]);
  mesh.triangles.push_back(mesh.triangles[3]);
  std::vector<std::uint32_t> sequence = cache_optimized_order(mesh);
  std::sort(sequence.begin(), sequence.end());
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0U);
  EXPECT_EQ(sequence, all);
  EXPECT_TRUE(cache_optimized_order(Mesh{}).empty());
}

TEST(Baselines, CacheOrderOfNodesHoldsTheSameNodes) {
  const Mesh mesh = random_mesh(11, 60, 300);
  NodeSequence nodes;
  for (NodeId node = 0; node < 2 * mesh.triangles.size(); ++node) {
    if (node % 3 != 0) nodes.push_back(node);
  }
  NodeSequence optimized = cache_optimized_nodes(mesh, nodes);
  EXPECT_LT(sequence_statistics(mesh, optimized, CacheModel::fifo, 20).misses,
            sequence_statistics(mesh, nodes, CacheModel::fifo, 20).misses);
  std::sort(optimized.begin(), optimized.end());
  EXPECT_EQ(optimized, nodes);
  EXPECT_TRUE(cache_optimized_nodes(mesh, {}).empty());
}

TEST(Baselines, RanksHoldBothFacings) {
  const std::vector<std::uint32_t> ranks = ranks_of_triangles(std::vector<std::uint32_t>{2, 0}, 3);
  ASSERT_EQ(ranks.size(), 6U);
  EXPECT_LT(std::max(ranks[4], ranks[5]), std::min(ranks[0], ranks[1]));
  EXPECT_EQ(ranks[2], kNoRank);
  EXPECT_EQ(ranks[3], kNoRank);
}

TEST(Baselines, ViewersBlendTheLastTriangleOnTop) {
  const std::vector<std::uint32_t> ranks = ranks_as_stored(3);
  EXPECT_LT(ranks[node_of(2, false)], ranks[node_of(1, false)]);
  EXPECT_LT(ranks[node_of(1, false)], ranks[node_of(0, false)]);
}

TEST(Baselines, InsideValidFromTheBaseOrderIsDrawn) {
  const Mesh mesh = testing::two_triangles();
  const OrderSet orders = testing::two_orders();
  const std::vector<std::uint32_t> inside = ranks_from(mesh, orders, {{0, 0, 1}, 1.1});
  EXPECT_EQ(std::count(inside.begin(), inside.end(), kNoRank), 0);
  const std::vector<std::uint32_t> outside = ranks_from(mesh, orders, {{0, 0, 1}, 2});
  EXPECT_EQ(std::count(outside.begin(), outside.end(), kNoRank), 2);  // only one facing is listed
}

TEST(Baselines, MeasureListsOrdersBeforeBaselines) {
  const Mesh mesh = testing::two_triangles();
  OrderSet orders = testing::two_orders();
  orders.orders = {{0, 1, 2, 3}};  // a flat mesh is right in any order that holds both facings
  orders.cell_orders.assign(20, 0);
  MeasureSettings settings;
  settings.viewpoints = 8;
  settings.size = 48;
  const MeasureSubject subject{"mine", &mesh, &orders};
  const PrimitiveMeasureReport report =
      measure_subjects(std::span(&subject, 1), &mesh, "quad", settings, nullptr);
  std::vector<std::string> names;
  for (const MethodReport& method : report.methods) names.push_back(method.quality.name);
  EXPECT_EQ(names, (std::vector<std::string>{"mine", "original", "base", "cache_optimized",
                                             "cache_optimized_twins", "centroid_sort"}));
  for (const MethodReport& method : report.methods) {
    for (std::size_t i = 0; i < kReportedCaches.size(); ++i) {
      if (kReportedCaches[i].name == "fifo20") {
        EXPECT_EQ(method.acmr_by_cache[i], method.fifo.acmr);
      }
      EXPECT_GE(method.acmr_by_cache[i], 0.5) << kReportedCaches[i].name;
    }
    EXPECT_EQ(method.quality.ipr_mean, 0.0) << method.quality.name;
    EXPECT_EQ(method.quality.frames.size(), 8U) << method.quality.name;
  }
  EXPECT_EQ(report.methods.front().kind, MethodKind::orders);
  EXPECT_GT(report.methods.back().nanoseconds_per_frame, 0.0);
  EXPECT_GT(report.methods.front().nanoseconds_per_frame, 0.0);  // choosing an order
}

TEST(Baselines, AllBaselinesDrawAFlatMeshRight) {
  const Mesh mesh = testing::two_triangles();
  const OrderSet orders = testing::two_orders();
  MeasureSettings settings;
  settings.viewpoints = 8;
  settings.size = 48;
  settings.baselines = parse_baselines("all");
  const MeasureSubject subject{"mine", &mesh, &orders};
  const PrimitiveMeasureReport report =
      measure_subjects(std::span(&subject, 1), nullptr, "quad", settings, nullptr);
  EXPECT_TRUE(report.notes.empty());
  ASSERT_EQ(report.methods.size(), 7U);
  const MethodReport& lists = report.methods[5];
  EXPECT_EQ(lists.quality.name, "dptl");
  EXPECT_EQ(lists.quality.ipr_mean, 0.0);
  EXPECT_EQ(lists.buffers, 6U);
  // Both facings of both triangles in most lists, a plane with each, and the table of the cells.
  EXPECT_EQ(lists.auxiliary_bytes, lists.fifo.triangles * 16 + 20);
  EXPECT_EQ(lists.memory_bytes, lists.fifo.triangles * 6);
  EXPECT_GE(lists.build_seconds, 0.0);
  const MethodReport& walk = report.methods[6];
  EXPECT_EQ(walk.quality.name, "bsp");
  EXPECT_EQ(walk.quality.ipr_mean, 0.0);
  EXPECT_EQ(walk.splits, 0U);
  EXPECT_EQ(walk.triangles_submitted, 2.0);
  EXPECT_EQ(walk.plane_tests, 1.0);  // one plane holds both
}

TEST(Baselines, NamesAreChosenOrRefused) {
  const Baselines chosen = parse_baselines("bsp,base");
  EXPECT_TRUE(chosen.bsp && chosen.base);
  EXPECT_FALSE(chosen.dptl || chosen.centroid_sort || chosen.cache_optimized);
  const Baselines all = parse_baselines("all");
  EXPECT_TRUE(all.bsp && all.dptl && all.base && all.centroid_sort && all.cache_optimized);
  const Baselines none = parse_baselines("none");
  EXPECT_FALSE(none.bsp || none.dptl || none.base || none.centroid_sort || none.cache_optimized);
  EXPECT_THROW(parse_baselines("original"), Error);
}

TEST(RunTime, TheTimedSelectionIsTheOneThatIsMeasured) {
  Random random(4);
  for (const char* text : {"S0,0", "S2,1", "P1"}) {
    OrderSet orders = testing::two_orders();
    orders.partition = parse_partition(text);
    orders.cell_orders.clear();
    for (std::uint32_t c = 0; c < make_partition(orders.partition).cell_count(); ++c)
      orders.cell_orders.push_back(1000 + c);
    const auto work = selection_work(orders);
    for (int k = 0; k < 200; ++k) {
      const Viewpoint view{random.direction(), k % 3 == 0 ? kInfiniteDistance : random.uniform(2, 5)};
      EXPECT_EQ(work(view), select_order(orders, view.direction)) << text;
    }
  }
  EXPECT_EQ(cell_table_bytes(parse_partition("S2,1"), 6), 320U);
  EXPECT_EQ(cell_table_bytes(parse_partition("P1"), 300), 2 * 3 * 80U);
}

TEST(RunTime, IsAboutTheWorkThatIsDone) {
  const std::vector<Viewpoint> views = random_viewpoints(4, 2, 5, 1);
  const auto spin = [](std::uint64_t turns) {
    return [turns](const Viewpoint&) {
      Random random(1);
      std::uint64_t sum = 0;
      for (std::uint64_t k = 0; k < turns; ++k) sum += random.next();
      return sum;
    };
  };
  const double once = nanoseconds_per_frame(spin(2000), views);
  const double tenfold = nanoseconds_per_frame(spin(20000), views);
  EXPECT_GT(once, 100);
  EXPECT_GT(tenfold, 4 * once);
  EXPECT_LT(tenfold, 25 * once);
  EXPECT_EQ(nanoseconds_per_frame({}, views), 0);
  EXPECT_EQ(nanoseconds_per_frame(spin(10), {}), 0);
}

TEST(Baselines, MissingBackFacesAreWrongPixels) {
  const Mesh mesh = testing::two_triangles();
  OrderSet orders = testing::two_orders();
  orders.orders = {{0, 2}};  // front facings only, drawn from everywhere
  orders.cell_orders.assign(20, 0);
  MeasureSettings settings;
  settings.viewpoints = 40;
  settings.size = 32;
  settings.baselines = parse_baselines("none");
  const MeasureSubject subject{"mine", &mesh, &orders};
  const PrimitiveMeasureReport report =
      measure_subjects(std::span(&subject, 1), nullptr, "quad", settings, nullptr);
  ASSERT_EQ(report.methods.size(), 1U);
  EXPECT_GT(report.methods[0].quality.ipr_mean, 0.2);
  EXPECT_LT(report.methods[0].quality.ipr_mean, 0.8);
}

}  // namespace
}  // namespace pellucid
