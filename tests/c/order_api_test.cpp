// Tests the C interface with arrays: orders, their contents, and their measures.
#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <thread>

#include "api_helpers.h"

namespace pellucid {
namespace {

using testing::Arrays;
using ::testing::HasSubstr;
using testing::indices_of;
using testing::ordered;
using testing::OrderSetHandle;
using testing::quick_options;
using testing::torus;

constexpr std::array<double, 16> kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

TEST(COrder, OrdersBlendBetterThanTheStoredOrder) {
  const Arrays arrays = torus();
  const PellucidMesh mesh = arrays.mesh();
  PellucidOrderOptions budget = quick_options();
  budget.method = pellucid_method_budget;
  const OrderSetHandle set = ordered(mesh, budget);
  PellucidOrderStatistics statistics{};
  ASSERT_EQ(pellucid_order_statistics(set.get(), &statistics, sizeof statistics), pellucid_ok);
  EXPECT_GE(statistics.measured_error, 0);

  PellucidMeasureOptions options;
  pellucid_measure_options_init(&options, sizeof options);
  options.viewpoints = 20;
  options.size = 128;
  PellucidBlendQuality presorted{}, stored{};
  ASSERT_EQ(pellucid_measure_blending(&mesh, set.get(), &options, &presorted), pellucid_ok);
  ASSERT_EQ(pellucid_measure_blending(&mesh, nullptr, &options, &stored), pellucid_ok);
  EXPECT_LT(presorted.ipr_mean, 0.1 * stored.ipr_mean);
  EXPECT_GT(presorted.psnr_mean, stored.psnr_mean);
}

TEST(COrder, EveryOrderIsInRangeAndReversible) {
  const Arrays arrays = torus();
  const OrderSetHandle set = ordered(arrays.mesh(), quick_options());
  std::vector<std::uint32_t> all(pellucid_order_count(set.get()));
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  all.push_back(PELLUCID_NO_ORDER);
  for (const std::uint32_t order : all) {
    const std::vector<std::uint32_t> front = indices_of(set.get(), order);
    const std::vector<std::uint32_t> back = indices_of(set.get(), order, pellucid_back_to_front);
    ASSERT_GE(front.size(), arrays.indices.size() / 2);
    ASSERT_EQ(front.size(), back.size());
    EXPECT_LT(*std::max_element(front.begin(), front.end()), arrays.positions.size() / 3);
    for (std::size_t i = 0; i < front.size(); ++i)
      ASSERT_EQ(front[i], back[back.size() - 3 - i / 3 * 3 + i % 3]);
    std::vector<std::uint16_t> narrow(front.size());
    ASSERT_EQ(pellucid_copy_order_indices(set.get(), order, pellucid_front_to_back, 2, narrow.data()),
              pellucid_ok);
    EXPECT_TRUE(std::equal(front.begin(), front.end(), narrow.begin()));
  }
  EXPECT_EQ(indices_of(set.get(), PELLUCID_NO_ORDER).size(), arrays.indices.size());
}

TEST(COrder, SelectsAnOrderForEveryEye) {
  const Arrays arrays = torus();
  for (const char* views : {"S1,1", "P1"}) {
    PellucidOrderOptions options = quick_options();
    options.views = views;
    const OrderSetHandle set = ordered(arrays.mesh(), options);
    PellucidOrders selector{};
    ASSERT_EQ(pellucid_order_selector(set.get(), &selector), pellucid_ok);
    for (int i = 0; i < 50; ++i) {
      const std::array<double, 3> eye{5 * std::sin(1.0 * i), 5 * std::cos(1.0 * i), 5 * std::sin(0.3 * i)};
      EXPECT_LT(pellucid_select_perspective(&selector, kIdentity.data(), eye.data()),
                pellucid_order_count(set.get()));
    }
    const std::array<double, 3> inside{0.1, 0, 0};
    EXPECT_EQ(pellucid_select_perspective(&selector, kIdentity.data(), inside.data()), PELLUCID_NO_ORDER);
  }
}

TEST(COrder, StridesAndShortIndicesChangeNothing) {
  const Arrays arrays = torus();
  const OrderSetHandle packed = ordered(arrays.mesh(), quick_options());
  std::vector<float> interleaved;
  for (std::size_t v = 0; v < arrays.positions.size() / 3; ++v) {
    interleaved.insert(interleaved.end(), {arrays.positions[3 * v], arrays.positions[3 * v + 1],
                                           arrays.positions[3 * v + 2], 7, 8});
  }
  const std::vector<std::uint16_t> narrow(arrays.indices.begin(), arrays.indices.end());
  PellucidMesh mesh = arrays.mesh();
  mesh.positions = interleaved.data();
  mesh.position_stride = 5 * sizeof(float);
  mesh.indices = narrow.data();
  mesh.index_bytes = 2;
  const OrderSetHandle strided = ordered(mesh, quick_options());
  EXPECT_EQ(indices_of(packed.get(), 0), indices_of(strided.get(), 0));
}

TEST(COrder, LeavesOutTrianglesThatDrawNothing) {
  Arrays arrays = torus();
  const std::vector<std::uint32_t> useless{0, 0, 1, 5, 6, 1'000'000};
  arrays.indices.insert(arrays.indices.begin(), useless.begin(), useless.end());
  const OrderSetHandle set = ordered(arrays.mesh(), quick_options());
  PellucidOrderStatistics statistics{};
  ASSERT_EQ(pellucid_order_statistics(set.get(), &statistics, sizeof statistics), pellucid_ok);
  EXPECT_EQ(statistics.dropped_triangles, 2U);
  EXPECT_EQ(statistics.triangles, arrays.indices.size() / 3);
  EXPECT_EQ(indices_of(set.get(), PELLUCID_NO_ORDER).size(), arrays.indices.size() - useless.size());
  const std::vector<std::uint32_t> drawn = indices_of(set.get(), 0);
  EXPECT_LT(*std::max_element(drawn.begin(), drawn.end()), arrays.positions.size() / 3);
}

TEST(COrder, ErrorsSayWhatIsWrong) {
  const Arrays arrays = torus();
  PellucidMesh mesh = arrays.mesh();
  PellucidOrderSet* set = nullptr;
  EXPECT_EQ(pellucid_order_mesh(&mesh, nullptr, nullptr), pellucid_bad_argument);
  EXPECT_EQ(pellucid_order_mesh(nullptr, nullptr, &set), pellucid_bad_argument);
  EXPECT_THAT(pellucid_last_error(), HasSubstr("mesh is null"));

  PellucidOrderOptions options{};
  EXPECT_EQ(pellucid_order_mesh(&mesh, &options, &set), pellucid_bad_argument);
  EXPECT_THAT(pellucid_last_error(), HasSubstr("call init first"));
  options = quick_options();
  options.struct_size += 8;
  EXPECT_EQ(pellucid_order_mesh(&mesh, &options, &set), pellucid_bad_argument);
  EXPECT_THAT(pellucid_last_error(), HasSubstr("later version"));
  options = quick_options();
  options.views = "X9";
  EXPECT_EQ(pellucid_order_mesh(&mesh, &options, &set), pellucid_bad_argument);
  EXPECT_THAT(pellucid_last_error(), HasSubstr("X9"));

  mesh.index_bytes = 1;
  EXPECT_EQ(pellucid_order_mesh(&mesh, nullptr, &set), pellucid_bad_argument);
  mesh = arrays.mesh();
  mesh.position_stride = 13;
  EXPECT_EQ(pellucid_order_mesh(&mesh, nullptr, &set), pellucid_bad_argument);
  mesh = arrays.mesh();
  mesh.triangle_count = 0;
  EXPECT_EQ(pellucid_order_mesh(&mesh, nullptr, &set), pellucid_nothing_to_do);
  EXPECT_EQ(set, nullptr);
}

TEST(COrder, OptionsOfAnEarlierHeaderKeepTheDefaultsOfTheRest) {
  const Arrays arrays = torus();
  const PellucidMesh mesh = arrays.mesh();
  PellucidOrderOptions options = quick_options();
  options.struct_size = offsetof(PellucidOrderOptions, max_buffers);
  options.max_buffers = 0;  // not there, for the library
  PellucidOrderSet* set = nullptr;
  EXPECT_EQ(pellucid_order_mesh(&mesh, &options, &set), pellucid_ok) << pellucid_last_error();
  pellucid_free_order_set(set);
}

TEST(COrder, ErrorsAreOfTheirThread) {
  EXPECT_EQ(pellucid_order_mesh(nullptr, nullptr, nullptr), pellucid_bad_argument);
  std::string elsewhere = "unset";
  std::thread([&] { elsewhere = pellucid_last_error(); }).join();
  EXPECT_EQ(elsewhere, "");
  EXPECT_STRNE(pellucid_last_error(), "");
}

struct Reports {
  int calls = 0;
  std::string first_stage;
  int stop_after = 1'000'000;
};

int report(void* user, const char* stage, std::uint64_t /*done*/, std::uint64_t /*total*/) {
  auto& reports = *static_cast<Reports*>(user);
  if (reports.calls == 0) reports.first_stage = stage;
  return ++reports.calls >= reports.stop_after ? 1 : 0;
}

TEST(COrder, ReportsProgressAndCanBeCancelled) {
  const Arrays arrays = torus();
  const PellucidMesh mesh = arrays.mesh();
  PellucidOrderOptions options = quick_options();
  Reports reports;
  options.run = {report, &reports, 1};
  EXPECT_NE(ordered(mesh, options), nullptr);
  EXPECT_GT(reports.calls, 1);
  EXPECT_NE(reports.first_stage, "");

  Reports impatient{0, "", 1};
  options.run.user = &impatient;
  PellucidOrderSet* set = nullptr;
  EXPECT_EQ(pellucid_order_mesh(&mesh, &options, &set), pellucid_cancelled);
  EXPECT_EQ(set, nullptr);
  EXPECT_EQ(impatient.calls, 1);
}

PellucidOverdrawOptions quick_overdraw() {
  PellucidOverdrawOptions options;
  pellucid_overdraw_options_init(&options, sizeof options);
  options.buffers = 2;
  options.view_level = 1;
  options.size = 64;
  return options;
}

PellucidMeasureOptions quick_measure() {
  PellucidMeasureOptions options;
  pellucid_measure_options_init(&options, sizeof options);
  options.viewpoints = 20;
  options.min_distance = 1.5;
  options.max_distance = 3;
  options.size = 128;
  options.facing = pellucid_facing_single;
  return options;
}

TEST(COverdraw, StaticOrdersReduceOverdraw) {
  const Arrays arrays = torus(24, 12);
  const PellucidMesh mesh = arrays.mesh();
  PellucidOverdrawOptions options = quick_overdraw();
  options.lambda = 3;
  PellucidOrderSet* raw = nullptr;
  ASSERT_EQ(pellucid_overdraw_mesh(&mesh, nullptr, &options, &raw), pellucid_ok) << pellucid_last_error();
  const OrderSetHandle set(raw);
  EXPECT_EQ(indices_of(set.get(), 0).size(), arrays.indices.size());

  const PellucidMeasureOptions measure = quick_measure();
  PellucidOverdrawQuality made{}, stored{};
  ASSERT_EQ(pellucid_measure_overdraw(&mesh, nullptr, set.get(), &measure, &made), pellucid_ok)
      << pellucid_last_error();
  ASSERT_EQ(pellucid_measure_overdraw(&mesh, nullptr, nullptr, &measure, &stored), pellucid_ok);
  EXPECT_GE(made.mean, 1);
  EXPECT_LT(made.mean, stored.mean);

  PellucidBlendQuality blended{};
  EXPECT_EQ(pellucid_measure_blending(&mesh, set.get(), nullptr, &blended), pellucid_bad_argument);
  std::vector<std::uint32_t> indices(arrays.indices.size());
  EXPECT_EQ(pellucid_copy_order_indices(set.get(), 0, pellucid_back_to_front, 4, indices.data()),
            pellucid_bad_argument);
}

TEST(COverdraw, PosesBecomeKeyFrames) {
  const Arrays arrays = torus();
  const PellucidMesh mesh = arrays.mesh();
  std::vector<float> stretched = arrays.positions;
  for (std::size_t v = 0; v < stretched.size(); v += 3) stretched[v] *= 3;
  const std::array<const float*, 2> frames{arrays.positions.data(), stretched.data()};
  const std::array<float, 2> times{0, 1.5F};
  const PellucidPoses poses{frames.data(), times.data(), 2};
  const PellucidOverdrawOptions options = quick_overdraw();
  PellucidOrderSet* raw = nullptr;
  ASSERT_EQ(pellucid_overdraw_mesh(&mesh, &poses, &options, &raw), pellucid_ok) << pellucid_last_error();
  const OrderSetHandle set(raw);

  PellucidOrders selector{};
  PellucidKeyframes keyframes{};
  ASSERT_EQ(pellucid_order_selector(set.get(), &selector), pellucid_ok);
  ASSERT_EQ(pellucid_order_keyframes(set.get(), &keyframes), pellucid_ok);
  ASSERT_EQ(keyframes.count, 2U);
  EXPECT_GT(keyframes.spheres[7], 2 * keyframes.spheres[3]);
  const std::array<double, 3> eye{4, 3, 2};
  for (const double time : {-1.0, 0.0, 1.0, 9.0}) {
    EXPECT_LT(pellucid_select_animated(&selector, &keyframes, time, kIdentity.data(), eye.data()),
              pellucid_order_count(set.get()));
  }
  const PellucidMeasureOptions measure = quick_measure();
  PellucidOverdrawQuality quality{};
  ASSERT_EQ(pellucid_measure_overdraw(&mesh, &poses, set.get(), &measure, &quality), pellucid_ok);
  EXPECT_GE(quality.mean, 1);

  const std::array<float, 2> backwards{1, 0};
  const PellucidPoses wrong{frames.data(), backwards.data(), 2};
  EXPECT_EQ(pellucid_overdraw_mesh(&mesh, &wrong, &options, &raw), pellucid_bad_argument);
  const std::array<float, 2> not_a_time{1, std::numeric_limits<float>::quiet_NaN()};
  for (const float* bad_times : {backwards.data(), not_a_time.data()}) {
    const PellucidPoses bad{frames.data(), bad_times, 2};
    EXPECT_EQ(pellucid_measure_overdraw(&mesh, &bad, nullptr, &measure, &quality), pellucid_bad_argument);
  }
}

TEST(CMeasure, CacheCountsMisses) {
  const std::array<std::uint16_t, 6> square{0, 1, 2, 0, 2, 3};
  PellucidCacheQuality quality{};
  ASSERT_EQ(pellucid_measure_cache(square.data(), 2, 6, 4, pellucid_cache_fifo, 16, &quality), pellucid_ok);
  EXPECT_EQ(quality.misses, 4U);
  EXPECT_EQ(quality.acmr, 2);
  EXPECT_EQ(quality.atvr, 1);
  EXPECT_EQ(pellucid_measure_cache(square.data(), 2, 6, 3, pellucid_cache_lru, 16, &quality),
            pellucid_bad_argument);
  EXPECT_EQ(pellucid_measure_cache(square.data(), 2, 5, 4, pellucid_cache_lru, 16, &quality),
            pellucid_bad_argument);
}

}  // namespace
}  // namespace pellucid
