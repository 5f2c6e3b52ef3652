// Tests that all forms of a technique with a budget keep the same fragments and draw the same image.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numeric>
#include <ostream>

#include "budget_helpers.h"

namespace pellucid {
namespace {

using testing::BudgetImage;

constexpr std::uint64_t kFormPixels = testing::kBudgetSide * testing::kBudgetSide;
constexpr std::uint32_t kNeverAHeap = 1'000'000;

struct Form {
  const char* name;
  std::string technique;
  Sync sync;
  std::uint32_t heap_from;
};
std::ostream& operator<<(std::ostream& out, const Form& form) {
  return out << form.name;
}

class BudgetForms : public ::testing::TestWithParam<Form> {
 protected:
  void SetUp() override {
    const DeviceInfo& device = testing::test_renderer().info();
    const auto infos = render_techniques();
    const auto info = std::find_if(infos.begin(), infos.end(),
                                   [](const TechniqueInfo& i) { return i.name == GetParam().technique; });
    std::string missing = missing_for(*info, device);
    if (missing.empty()) missing = missing_for(GetParam().sync, device);
    if (!missing.empty()) GTEST_SKIP() << "this device has no " << missing;
    options_.technique = GetParam().technique;
    options_.k_buffer.sync = GetParam().sync;
    options_.k_buffer.heap_from = GetParam().heap_from;
    options_.budget.maps = true;
    options_.keep_fragments = true;
  }
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }

  BudgetImage draw(const RenderScene& scene, std::uint64_t memory) {
    options_.budget.bytes = memory;
    return testing::draw_budget(scene, options_);
  }
  // The chain of 64-bit minima with the same k.
  BudgetImage draw_chain(const RenderScene& scene, const BudgetImage& drawn) {
    RenderOptions chain = options_;
    chain.k_buffer.sync = Sync::atomics;
    if (is_ordered())
      chain.budget.bytes = 8 * (drawn.result.stats.k_most.value() + tail_slots()) * kFormPixels;
    return testing::draw_budget(scene, chain);
  }
  static bool is_ordered() { return GetParam().sync == Sync::ordered; }
  static std::uint32_t tail_slots() { return GetParam().technique == "hybrid" ? 2 : 1; }
  static std::uint32_t passes() {
    if (GetParam().technique == "k-plus" || GetParam().technique == "variable-k") return 4;
    return is_ordered() ? 1 : GetParam().sync == Sync::atomics32 ? 4 : 3;
  }

  RenderOptions options_;
};

TEST_P(BudgetForms, KeepTheNearestWithinTheBytes) {
  const RenderScene scene = testing::random_stack(41, 220);
  for (const std::uint64_t bytes_of_a_pixel : {33U, 90U}) {
    const BudgetImage drawn = draw(scene, bytes_of_a_pixel * kFormPixels);
    testing::expect_nearest(drawn);
    EXPECT_EQ(drawn.result.stats.sync, GetParam().sync);
    EXPECT_EQ(drawn.result.stats.geometry_passes, passes());
    EXPECT_EQ(drawn.result.stats.overflowed, 0U);
    EXPECT_LE(drawn.result.stats.bytes, bytes_of_a_pixel * kFormPixels);
    EXPECT_LT(drawn.result.stats.captured, drawn.oracle.fragments.size());
  }
}

// Tails in attachments are summed up in finer units.
TEST_P(BudgetForms, DrawTheImageOfTheChain) {
  if (!testing::test_renderer().info().atomics64) GTEST_SKIP() << "this device has no 64-bit atomics";
  const RenderScene scene = testing::random_stack(46, 150);
  for (const Effect effect : {Effect::transparency, Effect::wireframe}) {
    options_.effect = effect;
    const BudgetImage drawn = draw(scene, 48 * kFormPixels);
    const BudgetImage chain = draw_chain(scene, drawn);
    EXPECT_EQ(drawn.result.maps.k, chain.result.maps.k);
    EXPECT_EQ(drawn.result.stats.coplanar, chain.result.stats.coplanar);
    float largest = 0;
    for (std::size_t p = 0; p < drawn.pixels(); ++p) {
      const float difference = testing::difference(drawn.result.pixels[p], chain.result.pixels[p]);
      if (drawn.result.maps.lost[p] == 0) {
        ASSERT_EQ(difference, 0.0F) << p;
      }
      largest = std::max(largest, difference);
    }
    if (is_ordered()) {
      EXPECT_LT(largest, 0.03F);
    } else {
      EXPECT_EQ(largest, 0.0F);
    }
  }
}

// More at one depth than have a slot, in front and at the end of what is kept, from the last id to the first.
TEST_P(BudgetForms, FragmentsAtOneDepthAreKeptByTheirIds) {
  RenderScene scene =
      testing::joined(testing::coplanar_squares(5, 0.5F), testing::coplanar_squares(4, 0.25F));
  for (const bool reversed : {false, true}) {
    scene.draw_order.resize(scene.triangles.size());
    std::iota(scene.draw_order.begin(), scene.draw_order.end(), 0U);
    if (reversed) std::reverse(scene.draw_order.begin(), scene.draw_order.end());
    for (const std::uint64_t slots : {3U, 5U, 7U})
      testing::expect_nearest(draw(scene, (8 * slots + 5) * kFormPixels));
  }
}

TEST_P(BudgetForms, DrawOrderDoesNotMatter) {
  RenderScene scene = testing::random_stack(43, 120);
  const BudgetImage straight = draw(scene, 40 * kFormPixels);
  scene.draw_order.resize(scene.triangles.size());
  std::iota(scene.draw_order.begin(), scene.draw_order.end(), 0U);
  Random random(9);
  for (std::size_t i = scene.draw_order.size(); i > 1; --i)
    std::swap(scene.draw_order[i - 1], scene.draw_order[random.below(i)]);
  const BudgetImage shuffled = draw(scene, 40 * kFormPixels);
  EXPECT_EQ(straight.result.pixels, shuffled.result.pixels);
  EXPECT_EQ(straight.result.maps.k, shuffled.result.maps.k);
}

// From tails of blocks on, in an image whose rows are no multiple of anything.
TEST_P(BudgetForms, AnyNumberOfBytesIsKept) {
  const RenderScene scene = testing::random_stack(47, 60);
  testing::test_renderer().load(scene);
  const Camera camera = testing::unit_camera(37, 29);
  const std::uint64_t pixels = std::uint64_t{camera.width} * camera.height;
  std::uint64_t kept = 0;
  for (const std::uint64_t memory :
       {std::uint64_t{16}, std::uint64_t{300}, 9 * pixels, 17 * pixels, 33 * pixels, 140 * pixels}) {
    options_.budget.bytes = memory;
    const RenderResult drawn = testing::test_renderer().draw(camera, options_);
    EXPECT_LE(drawn.stats.bytes, memory);
    EXPECT_GE(drawn.stats.captured, kept) << memory;
    kept = drawn.stats.captured;
  }
  EXPECT_GT(kept, 0U);
}

TEST_P(BudgetForms, EachSampleIsAPixelOfItsOwn) {
  const RenderScene scene = testing::random_stack(48, 40);
  testing::test_renderer().load(scene);
  const std::uint32_t side = 16;
  options_.samples = 4;
  options_.budget.bytes = std::uint64_t{4} * side * side * 40;
  const RenderResult drawn = testing::test_renderer().draw(testing::unit_camera(side, side), options_);
  EXPECT_LE(drawn.stats.bytes, options_.budget.bytes);
  const FragmentBuffer oracle = testing::cpu_fragments(scene, testing::unit_camera(4 * side, 4 * side));
  constexpr std::array<std::array<std::uint32_t, 2>, 4> kPlaces{{{1, 0}, {3, 1}, {0, 2}, {2, 3}}};
  for (std::uint32_t p = 0; p < side * side; ++p) {
    for (std::uint32_t s = 0; s < 4; ++s) {
      const std::size_t place =
          (4 * (p / side) + kPlaces.at(s)[1]) * std::size_t{4 * side} + 4 * (p % side) + kPlaces.at(s)[0];
      const auto all = oracle.pixel(place);
      const std::size_t sample = 4 * std::size_t{p} + s;
      const auto nearest = all.first(std::min<std::size_t>(all.size(), drawn.maps.k[sample]));
      ASSERT_TRUE(testing::same_fragments(testing::pixel_of(drawn.fragments, sample), nearest)) << sample;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Techniques, BudgetForms,
                         ::testing::Values(Form{"fixed_k_atomics32", "fixed-k", Sync::atomics32, 16},
                                           Form{"fixed_k_ordered", "fixed-k", Sync::ordered, 16},
                                           Form{"hybrid_atomics32", "hybrid", Sync::atomics32, 16},
                                           Form{"hybrid_ordered", "hybrid", Sync::ordered, 16},
                                           Form{"k_plus_array", "k-plus", Sync::spinlock, kNeverAHeap},
                                           Form{"k_plus_heap", "k-plus", Sync::spinlock, 1},
                                           Form{"k_plus_interlock", "k-plus", Sync::interlock, 4},
                                           Form{"variable_k_heap", "variable-k", Sync::spinlock, 5}),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

// ------------------------------------------------------------------------------------- what forms do not do

class BudgetForm : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!testing::test_renderer().info().atomics64) GTEST_SKIP() << "this device has no 64-bit atomics";
  }
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }
};

// What never gets the lock is counted, and seen in the tail; where all have a slot nobody needs it.
TEST_F(BudgetForm, FragmentsWithoutTheLockGoToTheTail) {
  const BudgetImage drawn = testing::draw_budget(testing::random_stack(41, 220),
                                                 {.technique = "k-plus",
                                                  .budget = {.bytes = 40 * kFormPixels, .maps = true},
                                                  .k_buffer = {.sync = Sync::spinlock, .lock_turns = 0}});
  std::uint64_t outside = 0;
  for (std::size_t p = 0; p < drawn.pixels(); ++p)
    if (drawn.result.maps.k[p] < drawn.n(p)) outside += drawn.n(p);
  EXPECT_GT(outside, 0U);
  EXPECT_EQ(drawn.result.stats.overflowed, outside);
  EXPECT_EQ(drawn.result.stats.captured, drawn.oracle.fragments.size() - outside);
  EXPECT_GT(drawn.result.stats.captured, 0U);
  testing::expect_no_holes(drawn);
}

TEST_F(BudgetForm, OthersAreRefused) {
  Renderer& renderer = testing::test_renderer();
  renderer.load(testing::coplanar_squares(3, 0.5F));
  const auto refusal = [&](const RenderOptions& options) -> std::string {
    try {
      renderer.draw(testing::unit_camera(8, 8), options);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_argument);
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal({.technique = "kb", .k_buffer = {.sync = Sync::spinlock}}),
              ::testing::HasSubstr("kb has only ordered, interlock, atomics"));
  EXPECT_THAT(refusal({.technique = "fixed-k", .k_buffer = {.sync = Sync::spinlock}}),
              ::testing::HasSubstr("has only atomics, atomics32, ordered"));
  EXPECT_THAT(refusal({.technique = "hybrid", .k = 64, .k_buffer = {.sync = Sync::ordered}}),
              ::testing::HasSubstr("attachments for k = 64"));
  // One invocation sorts what is kept of a pixel.
  renderer.load(testing::coplanar_squares(2100, 0.5F));
  EXPECT_EQ(refusal({.technique = "k-plus", .k_buffer = {.sync = Sync::spinlock}}), "");
  if (renderer.info().cpu) {
    EXPECT_THAT(
        refusal(
            {.technique = "k-plus", .budget = {.bytes = 2'000'000}, .k_buffer = {.sync = Sync::spinlock}}),
        ::testing::HasSubstr("2048"));
  }
}

TEST_F(BudgetForm, PreferredIsTheOneThatKeepsTheMost) {
  Renderer& renderer = testing::test_renderer();
  renderer.load(testing::coplanar_squares(3, 0.5F));
  for (const char* technique : {"fixed-k", "hybrid", "k-plus", "variable-k"}) {
    const CaptureStats stats = renderer.draw(testing::unit_camera(8, 8), {.technique = technique}).stats;
    EXPECT_EQ(stats.sync, Sync::atomics) << technique;
  }
}

// ------------------------------------------------------------------------------------------ hybrid

TEST_F(BudgetForm, HybridKeepsKWhereNoBudgetIsGiven) {
  for (const Sync sync : {Sync::atomics, Sync::ordered}) {
    if (!missing_for(sync, testing::test_renderer().info()).empty()) continue;
    for (const std::uint32_t k : {1U, 6U}) {
      const BudgetImage drawn =
          testing::draw_budget(testing::random_stack(41, 220), {.technique = "hybrid",
                                                                .k = k,
                                                                .budget = {.maps = true},
                                                                .k_buffer = {.sync = sync},
                                                                .keep_fragments = true});
      testing::expect_nearest(drawn);
      EXPECT_EQ(drawn.result.stats.k_least, k);
      EXPECT_EQ(drawn.result.stats.k_most, k);
      if (sync == Sync::atomics) {
        EXPECT_EQ(drawn.result.stats.bytes, 8 * (k + 2) * kFormPixels);
      }
    }
  }
}

// Colours of the tail weighted by opacity, of layers that single ones show before black.
TEST_F(BudgetForm, HybridIsTheFormulaOfThePaper) {
  Renderer& renderer = testing::test_renderer();
  const Camera camera = testing::unit_camera(8, 8);
  constexpr std::array<float, 4> kAlphas{0.4F, 0.2F, 0.8F, 0.6F};  // from the front
  std::vector<Vec3f> layers;                                       // times opacity
  RenderScene scene;
  for (std::size_t i = 0; i < kAlphas.size(); ++i) {
    RenderScene layer = testing::coplanar_squares(1, 0.2F + 0.125F * static_cast<float>(i));
    layer.surfaces[0] = {.color = {0.3F * static_cast<float>(i), 0.9F - 0.2F * static_cast<float>(i), 0.5F},
                         .alpha = kAlphas.at(i)};
    renderer.load(layer);
    layers.push_back(renderer.draw(camera, {.technique = "sb", .background = {0, 0, 0}}).pixels[0]);
    scene = i == 0 ? layer : testing::joined(layer, scene);
  }
  renderer.load(scene);
  for (const Sync sync : {Sync::atomics, Sync::atomics32, Sync::ordered}) {
    if (!missing_for(sync, renderer.info()).empty()) continue;
    const RenderResult drawn = renderer.draw(
        camera, {.technique = "hybrid", .background = {0, 0, 0}, .k = 1, .k_buffer = {.sync = sync}});
    Vec3f sum{0, 0, 0};
    float weights = 0;
    float light = 1;
    for (std::size_t i = 1; i < layers.size(); ++i) {
      sum = sum + layers[i];
      weights += kAlphas.at(i);
      light *= 1 - kAlphas.at(i);
    }
    const Vec3f expected = layers[0] + sum * ((1 - kAlphas[0]) * (1 - light) / weights);
    EXPECT_LT(testing::difference(drawn.pixels[0], expected), 0.004F) << static_cast<int>(sync);
  }
}

}  // namespace
}  // namespace pellucid
