// Tests the whole module: every mesh gets an order set that draws every visible face, deterministically.
#include <gtest/gtest.h>

#include <atomic>

#include "order_helpers.h"

namespace pellucid {
namespace {

OrderOptions quick(const std::string& partition = "S1,1") {
  OrderOptions options;
  options.partition = parse_partition(partition);
  options.max_buffers = 2;  // measuring many counts takes most of the time
  return options;
}

TEST(OrderMesh, AMemoryLimitDoesNotChangeTheResult) {
  const Mesh mesh = testing::nested_spheres(2);
  for (const OrderMethod method : {OrderMethod::budget, OrderMethod::acyclic}) {
    OrderOptions options = quick("S0,1");
    options.method = method;
    const OrderSet whole = order_mesh(mesh, options).orders;
    options.memory = 1;
    const OrderSet spilled = order_mesh(mesh, options).orders;
    EXPECT_EQ(whole.orders, spilled.orders);
    EXPECT_EQ(whole.cell_orders, spilled.cell_orders);
    EXPECT_EQ(whole.base_sequence, spilled.base_sequence);
  }
}

std::vector<Viewpoint> viewpoints_of(const OrderSet& set, std::uint32_t count) {
  Random random(99);
  std::vector<Viewpoint> viewpoints;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double far = std::isinf(set.valid_to) ? 20.0 : set.valid_to;
    const double choices[4] = {std::max(set.valid_from, 1.0001),
                               random.uniform(std::max(set.valid_from, 1.0001), std::max(far, 1.001)), far,
                               set.valid_to};
    viewpoints.push_back({random.direction(), choices[i % 4]});
  }
  return viewpoints;
}

// Every fragment that any viewpoint of the valid range shows belongs to a node of the order selected there.
void expect_nothing_is_missing(const Mesh& mesh, const OrderSet& set, std::uint32_t viewpoints = 24) {
  FragmentBuffer fragments;
  std::uint64_t seen = 0;
  for (const Viewpoint& viewpoint : viewpoints_of(set, viewpoints)) {
    const RasterOptions raster{set.facing == Facing::single ? Culling::back : Culling::none};
    rasterize(mesh, look_at_sphere(set.sphere, viewpoint, 128, 128), raster, fragments);
    const NodeSequence& order = set.orders[select_order(set, viewpoint.direction)];
    const std::vector<std::uint32_t> ranks = ranks_of(order, mesh.triangles.size());
    for (const Fragment& fragment : fragments.fragments) {
      ++seen;
      ASSERT_NE(ranks[fragment.node], kNoRank)
          << "node " << fragment.node << " from distance " << viewpoint.distance;
    }
  }
  EXPECT_GT(seen, 0U);
}

void expect_sound(const Mesh& mesh, const OrderResult& result, const OrderOptions& options) {
  const OrderSet& set = result.orders;
  const std::uint64_t triangles = mesh.triangles.size();
  EXPECT_EQ(set.partition, options.partition);
  EXPECT_EQ(set.facing, options.facing);
  EXPECT_EQ(set.cell_orders.size(), make_partition(set.partition).cell_count());
  ASSERT_FALSE(set.orders.empty());
  std::vector<int> users(set.orders.size(), 0);
  for (const std::uint32_t order : set.cell_orders) {
    ASSERT_LT(order, set.orders.size());
    ++users[order];
  }
  for (const int count : users) EXPECT_GT(count, 0) << "an order that no cell uses";
  for (const NodeSequence& order : set.orders) {
    std::vector<std::uint8_t> once(2 * triangles, 0);
    for (const NodeId node : order) {
      ASSERT_LT(node, 2 * triangles);
      EXPECT_EQ(once[node], 0);
      once[node] = 1;
      if (options.facing == Facing::single) {
        EXPECT_FALSE(is_flipped(node));
      }
    }
  }
  EXPECT_EQ(set.base_sequence.size(), triangles);
  EXPECT_TRUE(testing::is_permutation_of_all(set.base_sequence));
  EXPECT_EQ(result.statistics.triangles, triangles);
  EXPECT_GE(result.statistics.violated_weight, 0.0);
  EXPECT_LE(result.statistics.violated_weight, 1.0);
  EXPECT_GE(result.statistics.violated_floor, 0.0);
  EXPECT_LE(result.statistics.violated_floor, result.statistics.violated_bound);
  EXPECT_LE(result.statistics.violated_bound, result.statistics.violated_weight + 1e-6);
  EXPECT_GE(result.statistics.regions, set.orders.size());
  EXPECT_EQ(result.statistics.switches_per_turn > 0, set.orders.size() > 1);
  EXPECT_LE(result.statistics.clusters_lower_bound, set.orders.size());
  expect_nothing_is_missing(mesh, set);
}

OrderResult order_soundly(const Mesh& mesh, const OrderOptions& options) {
  OrderResult result = order_mesh(mesh, options);
  expect_sound(mesh, result, options);
  return result;
}

bool same(const OrderSet& a, const OrderSet& b) {
  return a.orders == b.orders && a.cell_orders == b.cell_orders && a.base_sequence == b.base_sequence;
}

// ----------------------------------------------------------------------------------- meshes of all kinds

struct NamedMesh {
  std::string name;
  Mesh mesh;
};

std::vector<NamedMesh> odd_meshes() {
  Mesh two = testing::icosphere_mesh(1);
  testing::append(two, testing::icosphere_mesh(1, 0.5, {3, 0.5, 0}));
  Mesh flat{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {}, {{0, 1, 2}, {0, 2, 3}}};
  // Three sheets on one edge.
  const Mesh fan{{{0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {-0.5F, 0.8F, 0}, {-0.5F, -0.8F, 0}},
                 {},
                 {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}};
  Mesh duplicates = testing::icosphere_mesh(0);
  testing::append(duplicates, testing::icosphere_mesh(0));
  duplicates.triangles.push_back(duplicates.triangles[3]);
  return {{"one triangle", testing::one_triangle()},
          {"two components", two},
          {"flat square", flat},
          {"non-manifold fan", fan},
          {"duplicates", duplicates},
          {"sticks in a cycle", testing::three_sticks()},
          {"open sheets", testing::sample_mesh("coplanar-stack", 0.02, 200)},
          {"crossing soup", testing::random_soup(40, 0.8, 1)}};
}

TEST(OrderMesh, MeshesOfAllKindsWithEitherMethod) {
  for (const NamedMesh& named : odd_meshes()) {
    for (const OrderMethod method : {OrderMethod::budget, OrderMethod::acyclic}) {
      SCOPED_TRACE(named.name + (method == OrderMethod::budget ? " budget" : " acyclic"));
      OrderOptions options = quick();
      options.method = method;
      order_soundly(named.mesh, options);
    }
  }
}

TEST(OrderMesh, EveryPartition) {
  const Mesh mesh = testing::sample_mesh("nested-shells", 0.05, 100);
  for (const char* partition : {"P0", "P1", "S0,2", "S2,0", "T0", "R0"}) {
    for (const OrderMethod method : {OrderMethod::budget, OrderMethod::acyclic}) {
      SCOPED_TRACE(partition);
      OrderOptions options = quick(partition);
      options.method = method;
      order_soundly(mesh, options);
    }
  }
}

TEST(OrderMesh, DistancesSayWhereOrdersHold) {
  const Mesh mesh = testing::sample_mesh("goblet", 0.1, 300);
  OrderOptions options = quick();
  const OrderSet spread = order_soundly(mesh, options).orders;
  EXPECT_EQ(spread.valid_from, 1.0);
  EXPECT_EQ(spread.valid_to, kInfiniteDistance);
  options.distances = {3.0};
  const OrderSet paper = order_soundly(mesh, options).orders;
  EXPECT_EQ(paper.valid_from, 2.0);
  EXPECT_EQ(paper.valid_to, 5.0);
  options.distances = {2.0};
  const OrderSet single = order_soundly(mesh, options).orders;
  EXPECT_LT(single.valid_from, 2.0);
  EXPECT_GT(single.valid_to, 2.0);
  EXPECT_TRUE(std::isfinite(single.valid_to));
  options.distances = {kInfiniteDistance};
  const OrderSet orthographic = order_soundly(mesh, options).orders;
  EXPECT_GT(orthographic.valid_from, 2.0);
  EXPECT_EQ(orthographic.valid_to, kInfiniteDistance);
  options.distances = {1.2};
  order_soundly(mesh, options);
}

TEST(OrderMesh, TrianglesHoldBetweenTheirDistancesAndRegionsToInfinity) {
  const Mesh mesh = testing::sample_mesh("goblet", 0.1, 100);
  const auto range = [&](const char* partition, const std::vector<double>& distances) {
    OrderOptions options = quick(partition);
    options.distances = distances;
    const OrderSet set = order_soundly(mesh, options).orders;
    return std::pair(set.valid_from, set.valid_to);
  };
  EXPECT_EQ(range("T0", {5, 2}), std::pair(2.0, 5.0));
  EXPECT_EQ(range("T0", {1.5, kInfiniteDistance}), std::pair(1.5, kInfiniteDistance));
  EXPECT_EQ(range("T0", {3}), range("S0,2", {3}));
  EXPECT_EQ(range("R0", {3}), std::pair(2.0, kInfiniteDistance));
  EXPECT_EQ(range("R0", {}), std::pair(1.0, kInfiniteDistance));
}

// Pixels in a wrong order over viewpoints of the whole valid range, with the acyclic method and no tolerance.
std::uint64_t wrong_pixels(const Mesh& mesh, const char* partition) {
  OrderOptions options = quick(partition);
  options.method = OrderMethod::acyclic;
  options.tolerance = 0;
  options.distances = {1.5, 4};
  const OrderResult result = order_mesh(mesh, options);
  EXPECT_EQ(result.statistics.dropped_edges, 0U) << "a cell has a cycle: choose another mesh";
  EXPECT_GT(result.orders.orders.size(), 1U);
  FragmentBuffer fragments;
  Random random(7);
  std::uint64_t wrong = 0;
  for (int i = 0; i < 150; ++i) {
    const Viewpoint viewpoint{random.direction(), random.uniform(1.5, 4)};
    rasterize(mesh, look_at_sphere(result.orders.sphere, viewpoint, 128, 128), {}, fragments);
    const NodeSequence& order = result.orders.orders[select_order(result.orders, viewpoint.direction)];
    wrong += count_incorrect_pixels(fragments, ranks_of(order, mesh.triangles.size())).incorrect;
  }
  return wrong;
}

TEST(OrderMesh, NoViewpointOfTrianglesAndRegionsSeesAWrongOrder) {
  const Mesh mesh = testing::random_soup(30, 0.15, 4);  // nothing intersects, no cell has a cycle
  EXPECT_GT(wrong_pixels(mesh, "S1,0"), 0U);
  EXPECT_EQ(wrong_pixels(mesh, "T1"), 0U);
  EXPECT_EQ(wrong_pixels(mesh, "R1"), 0U);
}

TEST(OrderMesh, SingleFacingHoldsNoTwin) {
  OrderOptions options = quick();
  options.facing = Facing::single;
  const Mesh mesh = testing::sample_mesh("goblet", 0.1, 300);
  const OrderSet culled = order_soundly(mesh, options).orders;
  options.facing = Facing::duplicated;
  const OrderSet both = order_soundly(mesh, options).orders;
  EXPECT_LT(culled.orders[0].size(), both.orders[0].size());
  options.facing = Facing::single;
  order_soundly(testing::sample_mesh("coplanar-stack", 0.02, 100), options);
}

TEST(OrderMesh, RasterOcclusionOrdersToo) {
  OrderOptions options = quick();
  options.occlusion = OcclusionSource::raster;
  options.raster_size = 256;
  options.min_buffers = options.max_buffers = 8;
  const OrderResult result = order_soundly(testing::sample_mesh("torus-knot", 0.1, 400), options);
  EXPECT_LT(result.statistics.measured_error, 0.02);
}

// ------------------------------------------------------------------------------------------------ budget

TEST(OrderMesh, ExactlyAsManyBuffersAsAskedFor) {
  const Mesh mesh = testing::sample_mesh("torus-knot", 0.1, 300);
  double last = 1;
  for (const std::uint32_t count : {1U, 3U, 9U}) {
    OrderOptions options = quick();
    options.min_buffers = options.max_buffers = count;
    const OrderResult result = order_soundly(mesh, options);
    EXPECT_EQ(result.orders.orders.size(), count);
    EXPECT_LT(result.statistics.measured_error, last);
    EXPECT_GT(result.statistics.violated_weight, 0.0);
    last = result.statistics.measured_error;
  }
}

TEST(OrderMesh, NoMoreBuffersThanCellsCanUse) {
  OrderOptions options = quick("P0");
  options.min_buffers = options.max_buffers = 16;  // 12 cells
  const OrderResult result = order_soundly(testing::sample_mesh("torus-knot", 0.05, 150), options);
  EXPECT_LE(result.orders.orders.size(), 12U);
}

TEST(OrderMesh, LargerMeshesAreSearchedOnASimplerOne) {
  const Mesh mesh = testing::sample_mesh("torus-knot", 0.6, 2500);
  ASSERT_GT(mesh.triangles.size(), 2000U);
  OrderOptions options = quick("S1,0");
  options.max_buffers = options.min_buffers = 6;
  const OrderResult result = order_soundly(mesh, options);
  EXPECT_LE(result.orders.orders.size(), 6U);
  EXPECT_LT(result.statistics.measured_error, 0.05);
}

TEST(OrderMesh, StatisticsAddUp) {
  const OrderResult result = order_mesh(testing::random_soup(60, 0.5, 3), quick("S0,1"));
  const OrderStatistics& s = result.statistics;
  EXPECT_EQ(s.viewpoints, 42U);  // the vertices of the once divided icosahedron
  EXPECT_GT(s.edges_per_viewpoint, 0U);
  EXPECT_GT(s.edges_total, s.edges_per_viewpoint);
  EXPECT_GT(s.intersecting_pairs, 0U);
  EXPECT_GE(s.measured_error, 0.0);
  EXPECT_GT(s.seconds.total, 0.0);
  EXPECT_GT(s.peak_rss_bytes, 0U);
}

// ------------------------------------------------------------------------------------------- determinism

TEST(OrderMesh, SameSeedSameBytesForAnyThreads) {
  const Mesh mesh = testing::sample_mesh("goblet", 0.1, 400);
  for (const OrderMethod method : {OrderMethod::budget, OrderMethod::acyclic}) {
    OrderOptions options = quick();
    options.method = method;
    options.min_buffers = options.max_buffers = 3;
    const OrderSet first = order_mesh(mesh, options).orders;
    EXPECT_TRUE(same(first, order_mesh(mesh, options).orders));
    for (const unsigned threads : {1U, 2U, 4U}) {
      const ThreadLimit limit(threads);
      EXPECT_TRUE(same(first, order_mesh(mesh, options).orders)) << threads << " threads";
    }
  }
}

TEST(OrderMesh, AnotherSeedSearchesElsewhere) {
  const Mesh mesh = testing::sample_mesh("torus-knot", 0.1, 300);
  OrderOptions options = quick();
  options.min_buffers = options.max_buffers = 5;
  const OrderSet first = order_mesh(mesh, options).orders;
  options.seed = 2;
  EXPECT_FALSE(same(first, order_mesh(mesh, options).orders));
}

// ------------------------------------------------------------------------------------- stops and refusals

class StopAfter : public Progress {
 public:
  explicit StopAfter(int steps) : left_(steps) {}
  void begin(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override { --left_; }
  [[nodiscard]] bool stop_requested() const override { return left_ <= 0; }

 private:
  std::atomic<int> left_;
};

ErrorKind kind_of_failure(const Mesh& mesh, const OrderOptions& options, std::string& message) {
  try {
    order_mesh(mesh, options);
  } catch (const Error& error) {
    message = error.what();
    return error.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::internal;
}

TEST(OrderMesh, StopsWhenAsked) {
  const Mesh mesh = testing::sample_mesh("goblet", 0.1, 300);
  for (const OrderMethod method : {OrderMethod::budget, OrderMethod::acyclic}) {
    // At once, early in the graph, and at its end.
    for (const int steps : {0, 30, 160}) {
      StopAfter stop(steps);
      OrderOptions options = quick();
      options.method = method;
      options.progress = &stop;
      std::string message;
      EXPECT_EQ(kind_of_failure(mesh, options, message), ErrorKind::interrupted) << steps;
    }
  }
}

TEST(OrderMesh, RefusesBadOptionsWithAReason) {
  struct Bad {
    std::string expected;  // in the message
    void (*spoil)(OrderOptions&);
  };
  const Bad cases[] = {
      {"distances",
       [](OrderOptions& o) {
         o.distances = {3, 1.0};
       }},
      {"distances", [](OrderOptions& o) { o.distances = {std::nan("")}; }},
      {"distances", [](OrderOptions& o) { o.distances = {-kInfiniteDistance}; }},
      {"error", [](OrderOptions& o) { o.max_error = -0.1; }},
      {"error", [](OrderOptions& o) { o.max_error = std::nan(""); }},
      {"buffer", [](OrderOptions& o) { o.max_buffers = 0; }},
      {"buffer", [](OrderOptions& o) { o.min_buffers = 0; }},
      {"buffers", [](OrderOptions& o) { o.min_buffers = 3; }},
      {"raster", [](OrderOptions& o) { o.raster_size = 0; }},
      {"tolerance", [](OrderOptions& o) { o.tolerance = 1.5; }},
      {"tolerance", [](OrderOptions& o) { o.tolerance = std::nan(""); }},
      {"view partition", [](OrderOptions& o) { o.partition.level = 40; }},
  };
  for (const Bad& bad : cases) {
    OrderOptions options = quick();
    bad.spoil(options);
    std::string message;
    EXPECT_EQ(kind_of_failure(testing::one_triangle(), options, message), ErrorKind::bad_argument);
    EXPECT_NE(message.find(bad.expected), std::string::npos) << message;
  }
  std::string message;
  EXPECT_EQ(kind_of_failure(Mesh{}, quick(), message), ErrorKind::nothing_to_do);
  EXPECT_NE(message.find("no triangles"), std::string::npos) << message;
}

}  // namespace
}  // namespace pellucid
