// Tests `auto`: which technique it chooses for which frame, that its images are those of that technique, and
// that it keeps to a budget.
#include "render/capture/automatic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "render_helpers.h"

namespace pellucid {
namespace {

using render::AutomaticDemand;
using render::choose_technique;
using render::DrawOrderHistory;
using render::Repairs;
using ::testing::HasSubstr;
using testing::kFoldRounding;
using testing::largest_difference;

// Of a frame that takes 100, 60, 40 and 30 bytes.
AutomaticDemand demand_for(std::uint64_t memory) {
  AutomaticDemand demand;
  demand.memory = memory;
  demand.fragments = 1000;
  demand.triangles = 100;
  demand.verified_bytes = 100;
  demand.lists_bytes = 60;
  demand.ranges_bytes = 40;
  demand.slots_bytes = 30;
  return demand;
}

std::string chosen_for(const AutomaticDemand& demand) {
  const render::AutomaticChoice choice = choose_technique(demand);
  EXPECT_FALSE(choice.reason.empty());
  return choice.technique;
}

TEST(AutomaticChoice, TriesTheSequenceFirst) {
  EXPECT_EQ(chosen_for(demand_for(0)), "verified");
  EXPECT_EQ(chosen_for(demand_for(100)), "verified");
}

TEST(AutomaticChoice, GoesByWhatTheSequenceGotWrong) {
  AutomaticDemand demand = demand_for(0);
  demand.repairs = {0.01, 0.1};
  EXPECT_EQ(chosen_for(demand), "verified");
  EXPECT_THAT(choose_technique(demand).reason, HasSubstr("1 %"));
  demand.repairs = {0.95, 1};
  EXPECT_EQ(chosen_for(demand), "ll");
  EXPECT_THAT(choose_technique(demand).reason, HasSubstr("95 %"));
}

TEST(AutomaticChoice, TakesTheFirstThatFits) {
  EXPECT_EQ(chosen_for(demand_for(99)), "ll");
  EXPECT_EQ(chosen_for(demand_for(60)), "ll");
  EXPECT_EQ(chosen_for(demand_for(59)), "sb");
  EXPECT_EQ(chosen_for(demand_for(40)), "sb");
  EXPECT_EQ(chosen_for(demand_for(39)), "k-plus");
  EXPECT_EQ(chosen_for(demand_for(30)), "k-plus");
  EXPECT_EQ(chosen_for(demand_for(29)), "variable-k");
  AutomaticDemand exact = demand_for(29);
  exact.overflow = Overflow::exact;
  EXPECT_EQ(chosen_for(exact), "bounded");
}

TEST(AutomaticChoice, KeepsFragmentsForEffectsThatNeedThem) {
  AutomaticDemand demand = demand_for(0);
  demand.blends = false;
  EXPECT_EQ(chosen_for(demand), "ll");
  demand.memory = 39;
  EXPECT_EQ(chosen_for(demand), "bounded");
}

TEST(AutomaticChoice, SaysWhatASmallBudgetNeeds) {
  AutomaticDemand demand = demand_for(29);
  demand.atomics64 = false;
  EXPECT_EQ(chosen_for(demand), "fixed-k");
  demand.overflow = Overflow::exact;
  EXPECT_THROW(choose_technique(demand), Error);
  demand.memory = 40;
  EXPECT_EQ(chosen_for(demand), "sb");
}

// Whatever it takes can be drawn there.
TEST(AutomaticChoice, TakesWhatADeviceWithoutLongAtomicsHas) {
  const DeviceInfo device;
  ASSERT_FALSE(device.atomics64);
  for (const std::uint64_t memory : {0U, 99U, 50U, 35U, 10U}) {
    AutomaticDemand demand = demand_for(memory);
    demand.atomics64 = false;
    const std::string chosen = chosen_for(demand);
    const auto infos = render_techniques();
    const auto info =
        std::find_if(infos.begin(), infos.end(), [&](const auto& i) { return i.name == chosen; });
    ASSERT_NE(info, infos.end());
    EXPECT_EQ(missing_for(*info, device), "") << memory;
  }
}

TEST(AutomaticChoice, TakesRoundsWhereChainsWouldBeLong) {
  AutomaticDemand demand = demand_for(30);
  demand.overflow = Overflow::exact;
  demand.deepest = render::kMostChained;
  EXPECT_EQ(chosen_for(demand), "k-plus");
  ++demand.deepest;
  EXPECT_EQ(chosen_for(demand), "bounded");
}

// The more triangles for a fragment, the less repairs pay, which draw them again.
TEST(AutomaticChoice, WeighsTrianglesThatAreDrawnAgain) {
  AutomaticDemand demand = demand_for(0);
  demand.repairs = {0.3, 1};
  EXPECT_EQ(chosen_for(demand), "verified");
  demand.triangles = 1000;
  EXPECT_EQ(chosen_for(demand), "ll");
  demand.repairs->triangles = 0.1;
  EXPECT_EQ(chosen_for(demand), "verified");
  EXPECT_LT(render::verified_by_lists(demand, {0.1, 0.1}), render::verified_by_lists(demand, {0.2, 0.1}));
  EXPECT_LT(render::verified_by_lists(demand, {0.1, 0.1}), render::verified_by_lists(demand, {0.1, 0.2}));
}

TEST(DrawOrderHistory, AsksForATrialAfterSomeFrames) {
  DrawOrderHistory history;
  EXPECT_FALSE(history.repairs());
  history.add_frame("verified", {0.75, 1});
  ASSERT_TRUE(history.repairs());
  EXPECT_EQ(history.repairs()->pixels, 0.75);
  for (std::uint32_t frame = 0; frame < render::kFramesUntilTrial; ++frame) {
    EXPECT_TRUE(history.repairs()) << frame;
    history.add_frame("ll", {});
  }
  EXPECT_FALSE(history.repairs());
}

TEST(DrawOrderHistory, TellsWhatAFrameAdded) {
  AutomaticDemand demand = demand_for(0);
  demand.covered = 200;
  CaptureStats before;
  before.repaired_pixels = 10;
  before.repaired_triangles = 5;
  CaptureStats after = before;
  after.repaired_pixels += 50;
  after.repaired_triangles += 10;
  EXPECT_EQ(render::repairs_between(before, after, demand).pixels, 0.25);
  EXPECT_EQ(render::repairs_between(before, after, demand).triangles, 0.1);
  EXPECT_EQ(render::repairs_between(before, before, {}).pixels, 0);  // nothing is there
  after.pool_exceeded = true;
  EXPECT_EQ(render::repairs_between(before, after, demand).pixels, 1);
}

std::vector<std::uint32_t> reversed(std::size_t count) {
  std::vector<std::uint32_t> sequence(count);
  std::iota(sequence.rbegin(), sequence.rend(), 0U);
  return sequence;
}

// Sheets from the nearest to the farthest, so the stored order is right.
RenderScene ordered_sheets() {
  RenderScene scene = testing::coplanar_squares(1, 0.125F);
  for (int i = 2; i <= 7; ++i)
    scene = testing::joined(scene, testing::coplanar_squares(1, 0.125F * static_cast<float>(i)));
  return scene;
}

TEST(Automatic, StaysWithASequenceThatIsRight) {
  Renderer& renderer = testing::test_renderer();
  const Camera camera = testing::unit_camera(40, 24);
  renderer.load(ordered_sheets());
  const RenderResult exact = renderer.draw(camera, {.technique = "sb"});
  EXPECT_EQ(exact.stats.chosen, "");
  for (std::uint32_t frame = 0; frame < 3; ++frame) {
    const RenderResult result = renderer.draw(camera, {.technique = "auto"});
    EXPECT_EQ(result.stats.chosen, "verified");
    EXPECT_NE(result.stats.reason, "");
    EXPECT_LE(largest_difference(exact, result), kFoldRounding);
  }
  EXPECT_EQ(testing::first_validation_message(), "");
}

TEST(Automatic, LeavesASequenceThatIsWrongAndComesBackToSee) {
  Renderer& renderer = testing::test_renderer();
  const Camera camera = testing::unit_camera(40, 24);
  RenderScene scene = ordered_sheets();
  scene.draw_order = reversed(scene.triangles.size());
  renderer.load(scene);
  const RenderResult exact = renderer.draw(camera, {.technique = "sb"});
  for (std::uint32_t frame = 0; frame < render::kFramesUntilTrial + 2; ++frame) {
    const RenderResult result = renderer.draw(camera, {.technique = "auto"});
    const bool tries = frame % (render::kFramesUntilTrial + 1) == 0;
    EXPECT_EQ(result.stats.chosen, tries ? "verified" : "ll") << frame;
    EXPECT_LE(largest_difference(exact, result), kFoldRounding);
  }
  // What was learned is of the scene that was loaded.
  scene.draw_order = {};
  renderer.load(scene);
  EXPECT_EQ(renderer.draw(camera, {.technique = "auto"}).stats.chosen, "verified");
}

// Also where images are padded, and with a pool, which is not its own.
TEST(Automatic, KeepsToEveryBudget) {
  Renderer& renderer = testing::test_renderer();
  if (!renderer.info().atomics64) GTEST_SKIP() << "this device has no 64-bit atomics";
  const RenderScene scene = testing::random_stack(3, 200);
  for (const std::uint32_t samples : {1U, 4U}) {
    const Camera camera = testing::unit_camera(samples == 1 ? 67 : 37, samples == 1 ? 45 : 29);
    renderer.load(scene);
    const RenderResult exact = renderer.draw(camera, {.technique = "sb", .samples = samples});
    std::vector<std::string> taken;
    std::uint64_t captured = exact.stats.captured;
    const std::uint64_t suffices = 2 * exact.stats.bytes;
    for (std::uint64_t memory = suffices; memory >= suffices / 16; memory = memory * 15 / 16) {
      renderer.load(scene);
      const RenderResult result = renderer.draw(
          camera,
          {.technique = "auto", .samples = samples, .pool = {.nodes = 100}, .budget = {.bytes = memory}});
      EXPECT_LE(result.stats.bytes, memory) << result.stats.chosen;
      EXPECT_LE(result.stats.captured, captured) << memory;
      captured = result.stats.captured;
      if (taken.empty() || taken.back() != result.stats.chosen) taken.push_back(result.stats.chosen);
      if (result.stats.captured == exact.stats.captured) {
        EXPECT_LE(largest_difference(exact, result), kFoldRounding);
      }
    }
    EXPECT_THAT(taken, ::testing::ElementsAre("verified", "sb", "k-plus", "variable-k"));
  }
  EXPECT_EQ(testing::first_validation_message(), "");
}

// Lists that a driver's loops would not get through are captured again, which takes more.
TEST(Automatic, KeepsToABudgetWhereListsAreLong) {
  Renderer& renderer = testing::test_renderer();
  if (!renderer.info().atomics64) GTEST_SKIP() << "this device has no 64-bit atomics";
  const Camera camera = testing::unit_camera(8, 8);
  renderer.load(testing::coplanar_squares(1400, 0.5F));
  const std::uint64_t needed =
      renderer.draw(camera, {.technique = "k-plus", .budget = {.bytes = 100'000'000}}).stats.bytes;
  const RenderResult result = renderer.draw(camera, {.technique = "auto", .budget = {.bytes = 4 * needed}});
  EXPECT_LE(result.stats.bytes, 4 * needed);
  EXPECT_EQ(result.stats.captured, result.stats.fragments);
  if (renderer.info().cpu) {
    EXPECT_EQ(result.stats.chosen, "k-plus");
  }
}

// The pass that counts is one of its passes, once.
TEST(Automatic, CountsThePassThatItChoosesBy) {
  Renderer& renderer = testing::test_renderer();
  const Camera camera = testing::unit_camera(40, 24);
  RenderScene scene = ordered_sheets();
  scene.draw_order = reversed(scene.triangles.size());
  renderer.load(scene);
  const auto passes = [&](std::uint64_t memory) {
    return renderer.draw(camera, {.technique = "auto", .budget = {.bytes = memory}}).stats.geometry_passes;
  };
  passes(0);
  EXPECT_EQ(passes(0), 1U);
  EXPECT_EQ(passes(1'000'000), 2U);
}

TEST(Automatic, IsExactInABudgetWhereThatIsAskedFor) {
  Renderer& renderer = testing::test_renderer();
  if (!renderer.info().atomics64) GTEST_SKIP() << "this device has no 64-bit atomics";
  const Camera camera = testing::unit_camera(64, 48);
  renderer.load(testing::random_stack(3, 200));
  const RenderResult exact = renderer.draw(camera, {.technique = "sb"});
  const RenderResult result = renderer.draw(
      camera, {.technique = "auto", .pool = {.overflow = Overflow::exact}, .budget = {.bytes = 120'000}});
  EXPECT_THAT(result.stats.chosen, HasSubstr("bounded"));
  EXPECT_LE(result.stats.bytes, 120'000U);
  EXPECT_EQ(result.stats.captured, exact.stats.captured);
  EXPECT_LE(largest_difference(exact, result), kFoldRounding);
}

TEST(Automatic, DrawsEffectsThatNeedFragments) {
  Renderer& renderer = testing::test_renderer();
  const Camera camera = testing::unit_camera(40, 24);
  renderer.load(testing::random_stack(5, 60));
  const RenderResult exact = renderer.draw(camera, {.technique = "sb", .effect = Effect::complexity});
  const RenderResult result = renderer.draw(camera, {.technique = "auto", .effect = Effect::complexity});
  EXPECT_EQ(result.stats.chosen, "ll");
  EXPECT_EQ(largest_difference(exact, result), 0);
}

}  // namespace
}  // namespace pellucid
