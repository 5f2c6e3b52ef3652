// Tests error against number of buffers: each point is what a single run gives. Also tests PSNR as a target.
#include <gtest/gtest.h>

#include "metric/validation.h"
#include "order_helpers.h"
#include "pellucid/metric.h"
#include "transparency/cluster/error_target.h"

namespace pellucid {
namespace {

std::vector<FrontierPoint> points_of(const std::vector<double>& iprs) {
  std::vector<FrontierPoint> points;
  for (const double ipr : iprs) {
    FrontierPoint point;
    point.limit = point.request = point.buffers = static_cast<std::uint32_t>(points.size() + 1);
    point.ipr = ipr;
    point.psnr = 50;
    points.push_back(point);
  }
  return points;
}

TEST(Frontier, APointThatCameOutWorseBecomesTheOneBeforeIt) {
  std::vector<FrontierPoint> points = points_of({0.1, 0.01, 0.02, 0.015, 0.001});
  keep_best(points, {0.012, {}});
  const std::vector<std::uint32_t> requests{1, 2, 2, 2, 5};
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points[i].limit, i + 1);
    EXPECT_EQ(points[i].request, requests[i]);
    EXPECT_EQ(points[i].buffers, requests[i]);
    EXPECT_EQ(points[i].meets_target, i > 0);
  }
}

TEST(Frontier, IsJudgedByTheMeasureOfTheTarget) {
  std::vector<FrontierPoint> points = points_of({0.1, 0.01});
  points[0].psnr = 60;
  keep_best(points, {0.001, 59.0});
  EXPECT_EQ(points[1].request, 1U);
  EXPECT_TRUE(points[1].meets_target);
}

TEST(Frontier, ChoosesTheFewestThatMeetTheTarget) {
  std::vector<FrontierPoint> points = points_of({0.1, 0.01, 0.002, 0.0019, 0.00185});
  for (const auto& [target, chosen] : {std::pair{0.5, 1U}, {0.01, 2U}, {0.0019, 4U}}) {
    keep_best(points, {target, {}});
    EXPECT_EQ(chosen_limit(points, {target, {}}), chosen) << target;
  }
  // Out of reach: 4 and 5 buffers lower the error of 3 by less than a tenth.
  keep_best(points, {0, {}});
  EXPECT_EQ(chosen_limit(points, {0, {}}), 3U);
}

TEST(Frontier, FrameTimesChooseTheFewestThatAreHardlySlower) {
  ErrorTarget target;
  target.least_frame_time = true;
  std::vector<FrontierPoint> points = points_of({0.1, 0.01, 0.001, 0.0005, 0.0004});
  const std::vector<double> repaired{0.2, 0.02, 0.005, 0.0001, 0.0001};
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].repaired = repaired[i];
    points[i].frame_time = verified_frame_time(repaired[i]);
  }
  keep_best(points, target);
  EXPECT_EQ(chosen_limit(points, target), 4U);
  EXPECT_FALSE(points[2].meets_target);
  EXPECT_TRUE(points[3].meets_target);
  EXPECT_EQ(points[4].request, 4U);  // no better
}

TEST(Frontier, FrameTimesGrowWithWhatIsRepaired) {
  EXPECT_GT(verified_frame_time(0), 1);
  for (const double share : {0.0, 0.001, 0.1, 0.5}) {
    EXPECT_LT(verified_frame_time(share), verified_frame_time(share + 0.1));
  }
}

TEST(Frontier, TheKneeIsWhereTheCurveBends) {
  const ErrorTarget target{};
  EXPECT_EQ(knee_limit(points_of({0.1, 0.01, 0.001, 0.0009, 0.0008, 0.0007}), target), 3U);
  EXPECT_EQ(knee_limit(points_of({0.1, 0.01, 0.001, 0.0001}), target), 0U);  // straight
  EXPECT_EQ(knee_limit(points_of({0.1, 0.09, 0.08, 0.0001}), target), 0U);   // bends the other way
  EXPECT_EQ(knee_limit(points_of({0.1, 0, 0}), target), 2U);
  EXPECT_EQ(knee_limit(points_of({0.1}), target), 0U);
}

OrderOptions frontier_options();

TEST(Frontier, FrameTimesGiveTheOrdersOfTheChosenNumber) {
  const Mesh mesh = testing::sample_mesh("torus-knot", 0.1, 200);
  OrderOptions options = frontier_options();
  options.max_buffers = 3;
  options.least_frame_time = true;
  const OrderFrontier frontier = order_frontier(mesh, options, true);
  const OrderResult result = order_mesh(mesh, options);
  EXPECT_EQ(result.orders.orders, frontier.result->orders.orders);
  EXPECT_EQ(result.orders.orders.size(), frontier.points[frontier.chosen - 1].buffers);
  for (const FrontierPoint& point : frontier.points) {
    EXPECT_GE(point.repaired, point.ipr);
    EXPECT_EQ(point.frame_time, verified_frame_time(point.repaired));
  }
  options.method = OrderMethod::acyclic;
  EXPECT_THROW(order_mesh(mesh, options), Error);
}

OrderOptions frontier_options() {
  OrderOptions options;
  options.partition = parse_partition("S0,1");
  options.distances = {2, kInfiniteDistance};
  options.cache_size = 0;
  return options;
}

void expect_single_runs(const Mesh& mesh, OrderOptions options, std::uint32_t most) {
  options.max_buffers = most;
  const OrderFrontier frontier = order_frontier(mesh, options, true);
  ASSERT_EQ(frontier.points.size(), most);
  // The PSNR of a single run is measured where it is the target; no count is left to choose.
  OrderOptions single = options;
  single.min_psnr = 1;
  for (const FrontierPoint& point : frontier.points) {
    EXPECT_LE(point.request, point.limit);
    if (point.request < point.limit) continue;  // the same order set again
    single.min_buffers = single.max_buffers = point.request;
    const OrderResult result = order_mesh(mesh, single);
    EXPECT_EQ(point.ipr, result.statistics.measured_error) << point.limit;
    EXPECT_EQ(point.psnr, result.statistics.measured_psnr) << point.limit;
    EXPECT_EQ(point.violated_weight, result.statistics.violated_weight) << point.limit;
    EXPECT_EQ(point.buffers, result.orders.orders.size()) << point.limit;
    std::uint64_t nodes = 0;
    for (const NodeSequence& order : result.orders.orders) nodes += order.size();
    EXPECT_EQ(point.memory_bytes, 3 * 2 * nodes) << point.limit;
    if (point.request != frontier.points[frontier.chosen - 1].request) continue;
    ASSERT_TRUE(frontier.result.has_value());
    EXPECT_EQ(frontier.result->orders.orders, result.orders.orders);
    EXPECT_EQ(frontier.result->orders.cell_orders, result.orders.cell_orders);
    EXPECT_EQ(frontier.result->orders.base_sequence, result.orders.base_sequence);
  }
  for (std::size_t i = 1; i < frontier.points.size(); ++i)
    EXPECT_LE(frontier.points[i].ipr, frontier.points[i - 1].ipr);
}

TEST(Frontier, EveryPointIsWhatASingleRunGives) {
  OrderOptions options = frontier_options();
  options.max_error = 0.01;
  expect_single_runs(testing::sample_mesh("torus-knot", 0.1, 200), options, 3);
}

TEST(Frontier, AlsoWithWeightsTheCacheAndASearchOnASimplerMesh) {
  OrderOptions options = frontier_options();
  options.alpha = 0.6;
  options.cache_size = 16;
  expect_single_runs(testing::sample_mesh("goblet", 0.6, 1600), options, 2);
}

TEST(Frontier, AlsoWithUpsampling) {
  OrderOptions options = frontier_options();
  options.partition = parse_partition("P0");
  options.distances = {2};
  options.upsample_from = 150;
  expect_single_runs(testing::sample_mesh("torus-knot", 0.1, 300), options, 2);
}

TEST(Frontier, HasNoOrdersUnlessAskedFor) {
  OrderOptions options = frontier_options();
  options.max_buffers = 2;
  const OrderFrontier frontier = order_frontier(testing::sample_mesh("goblet", 0.1, 200), options);
  EXPECT_FALSE(frontier.result.has_value());
  const FrontierPoint& chosen = frontier.points[frontier.chosen - 1];
  EXPECT_EQ(frontier.statistics.measured_error, chosen.ipr);
  EXPECT_EQ(frontier.statistics.violated_weight, chosen.violated_weight);
}

TEST(Frontier, RefusesWhatMakesNoSense) {
  const Mesh mesh = testing::sample_mesh("goblet", 0.1, 200);
  OrderOptions options = frontier_options();
  options.method = OrderMethod::acyclic;
  EXPECT_THROW(order_frontier(mesh, options), Error);
  options = frontier_options();
  options.alpha = 1.5;
  EXPECT_THROW(order_mesh(mesh, options), Error);
  options.alpha = 0;
  options.min_psnr = 101;
  EXPECT_THROW(order_mesh(mesh, options), Error);
}

// ---------------------------------------------------------------------------------------------- PSNR

TEST(OrderError, AgreesWithTheRoomMetric) {
  const Mesh mesh = testing::sample_mesh("torus-knot", 0.1, 400);
  ASSERT_TRUE(mesh.normals.empty());
  OrderOptions options = frontier_options();
  options.min_buffers = options.max_buffers = 2;
  const OrderResult result = order_mesh(mesh, options);
  const OrderSet& set = result.orders;
  const ViewPartition partition = make_partition(set.partition);
  std::vector<std::vector<std::uint32_t>> ranks;
  for (const NodeSequence& order : set.orders) ranks.push_back(ranks_of(order, mesh.triangles.size()));

  for (const double alpha : {0.3, 0.8}) {
    ValidationOptions validation;
    validation.viewpoints = 12;
    validation.size = 200;
    validation.seed = 77;
    validation.image_alpha = alpha;
    const OrderError error =
        measure_order_error(mesh, set.sphere, partition, set.cell_orders, ranks, validation);

    MeasureOptions measure;
    measure.viewpoints = 12;
    measure.size = 200;
    measure.seed = 77;
    measure.shading.alpha = alpha;
    const DrawingMethod method{"orders",
                               [&](const Viewpoint& v) { return ranks[select_order(set, v.direction)]; }};
    const MethodQuality quality = measure_order_quality(mesh, std::span(&method, 1), measure).front();
    EXPECT_GT(error.ipr, 0);
    EXPECT_LT(error.psnr, kPerfectPsnr);
    EXPECT_DOUBLE_EQ(error.ipr, quality.ipr_mean);
    EXPECT_DOUBLE_EQ(error.psnr, quality.psnr_mean);
  }
}

TEST(OrderError, ThePsnrAskedForIsReachedWithFewBuffers) {
  const Mesh mesh = testing::sample_mesh("torus-knot", 0.1, 200);
  OrderOptions options = frontier_options();
  options.max_error = 0.5;
  options.max_buffers = 8;
  const OrderResult by_ipr = order_mesh(mesh, options);
  EXPECT_EQ(by_ipr.orders.orders.size(), 1U);
  EXPECT_LT(by_ipr.statistics.measured_psnr, 0);  // not measured unless asked for
  options.min_psnr = 40;
  const OrderResult by_psnr = order_mesh(mesh, options);
  EXPECT_GE(by_psnr.statistics.measured_psnr, 40);
  EXPECT_GT(by_psnr.orders.orders.size(), 1U);
  EXPECT_LT(by_psnr.orders.orders.size(), 8U);
}

}  // namespace
}  // namespace pellucid
