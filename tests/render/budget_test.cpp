// Tests what techniques with a budget of bytes keep, against the CPU raster.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "budget_helpers.h"

namespace pellucid {
namespace {

using Drawn = testing::BudgetImage;
using testing::expect_nearest;
using testing::expect_no_holes;
constexpr std::uint32_t kSide = testing::kBudgetSide;

// Slots that are left of a budget beside the map and what all share.
std::uint64_t slots_of(std::uint64_t memory) {
  const std::uint64_t pixels = kSide * kSide;
  return (memory - 4 * (pixels + 1) - 1088 - 8 * ((pixels + 1023) / 1024)) / 8;
}

class Budget : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (!testing::test_renderer().info().atomics64) GTEST_SKIP() << "this device has no 64-bit atomics";
    options_.technique = GetParam();
    options_.budget.maps = true;
    options_.keep_fragments = true;
  }
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }

  Drawn draw(std::uint64_t memory) { return draw(testing::random_stack(41, 220), memory); }
  Drawn draw(const RenderScene& scene, std::uint64_t memory) {
    options_.budget.bytes = memory;
    return testing::draw_budget(scene, options_);
  }

  RenderOptions options_;
};

TEST_P(Budget, KeepsTheNearestOfEveryPixel) {
  for (const std::uint64_t bytes_of_a_pixel : {24U, 36U, 60U}) {
    const Drawn drawn = draw(bytes_of_a_pixel * kSide * kSide);
    expect_nearest(drawn);
    EXPECT_LT(drawn.result.stats.captured, drawn.oracle.fragments.size());
    EXPECT_LE(drawn.result.stats.bytes, bytes_of_a_pixel * kSide * kSide);
    EXPECT_GT(drawn.result.stats.captured, 0U);
  }
}

TEST_P(Budget, MoreBytesNeverLoseMore) {
  std::uint64_t kept = 0;
  for (std::uint64_t memory = 12; memory < 4'000'000; memory = memory * 3 / 2 + 8) {
    if (memory < 16) continue;
    const Drawn drawn = draw(memory);
    EXPECT_LE(drawn.result.stats.bytes, memory);
    EXPECT_GE(drawn.result.stats.captured, kept) << memory;
    kept = drawn.result.stats.captured;
    expect_no_holes(drawn);
  }
  EXPECT_EQ(kept, draw(16).oracle.fragments.size());
}

// From blocks of pixels to a slot for each, and on to what else is surveyed.
TEST_P(Budget, MoreBytesNeverLoseMoreWhereTheSurveyBeginsToFit) {
  options_.budget.maps = false;
  options_.keep_fragments = false;
  std::uint64_t kept = 0;
  for (std::uint64_t memory = 7U * kSide * kSide; memory < 15U * kSide * kSide; memory += kSide * kSide / 3) {
    const std::uint64_t captured = draw(memory).result.stats.captured;
    EXPECT_GE(captured, kept) << memory;
    kept = captured;
  }
}

// Only fixed-point rounding and the order of blending may differ.
TEST_P(Budget, EnoughBytesGiveTheExactImage) {
  const Drawn drawn = draw(4'000'000);
  RenderOptions exact;
  exact.plain_resolve = true;
  const RenderResult expected = testing::test_renderer().draw(testing::unit_camera(kSide, kSide), exact);
  float largest = 0;
  for (std::size_t p = 0; p < expected.pixels.size(); ++p)
    largest = std::max(largest, testing::difference(expected.pixels[p], drawn.result.pixels[p]));
  EXPECT_LE(largest, 1e-5F + 2.0F / 16384);
  EXPECT_EQ(drawn.result.stats.captured_share(), 1.0);
}

// If all surfaces look the same, their order does not matter, so a tail of them is exact.
TEST_P(Budget, TailsHaveTheRightTransmittance) {
  RenderScene scene = testing::random_stack(42, 220);
  for (Surface& surface : scene.surfaces) surface = {.color = {0.3F, 0.6F, 0.1F}, .alpha = 0.15F};
  testing::test_renderer().load(scene);
  const Camera camera = testing::unit_camera(kSide, kSide);
  const RenderResult expected = testing::test_renderer().draw(camera, {.plain_resolve = true});
  const RenderResult expected_on_black =
      testing::test_renderer().draw(camera, {.background = {0, 0, 0}, .plain_resolve = true});
  // Without a survey the range of the sums is that of the most fragments that there may be.
  const bool surveyed = GetParam() != "fixed-k" && GetParam() != "hybrid";
  const std::uint64_t more = GetParam() == "hybrid" ? 8 : 0;  // its tail has two slots
  for (const std::uint64_t bytes_of_a_pixel : {14 + more, 30 + more}) {
    options_.background = {1, 1, 1};
    const Drawn drawn = draw(scene, bytes_of_a_pixel * kSide * kSide);
    options_.background = {0, 0, 0};
    const RenderResult on_black = draw(scene, bytes_of_a_pixel * kSide * kSide).result;
    ASSERT_LT(drawn.result.stats.captured, drawn.result.stats.fragments);
    float largest = 0;
    float transmittance = 0;
    for (std::size_t p = 0; p < expected.pixels.size(); ++p) {
      largest = std::max(largest, testing::difference(expected.pixels[p], drawn.result.pixels[p]));
      const float light = drawn.result.pixels[p].x - on_black.pixels[p].x;
      transmittance =
          std::max(transmittance, std::abs(light - (expected.pixels[p].x - expected_on_black.pixels[p].x)));
    }
    EXPECT_LT(largest, surveyed ? 0.025F : 0.06F) << bytes_of_a_pixel;
    EXPECT_LT(transmittance, surveyed ? 0.005F : 0.06F) << bytes_of_a_pixel;
  }
}

// What is spread evenly behind the last fragment that was kept is seen by the light that gets to it: dark
// sheets in front of bright ones, two slots a pixel.
TEST_P(Budget, TailsKnowWhatIsInFrontOfThem) {
  RenderScene scene;
  for (int i = 0; i < 16; ++i) {
    RenderScene sheet = testing::coplanar_squares(1, static_cast<float>(i) / 16);
    sheet.surfaces[0] = {.color = Vec3f{1, 1, 1} * (i < 8 ? 0.1F : 0.9F), .alpha = 0.25F};
    scene = i == 0 ? sheet : testing::joined(scene, sheet);
  }
  options_.keep_fragments = false;
  const Drawn drawn = draw(scene, (4U + 16U) * kSide * kSide + 4096);
  const RenderResult exact =
      testing::test_renderer().draw(testing::unit_camera(kSide, kSide), {.plain_resolve = true});
  EXPECT_LE(drawn.result.stats.k_most.value_or(0), 2U);
  const float error = testing::difference(drawn.result.pixels[0], exact.pixels[0]);
  // A mean of all colours alike is off by 0.2.
  if (GetParam() == "fixed-k" || GetParam() == "hybrid") {
    EXPECT_GT(error, 0.1F);
  } else {
    EXPECT_LT(error, 0.05F);
  }
}

// Sums of the most that there can be do not run over.
TEST_P(Budget, TailsOfManyOpaqueFragmentsAreOpaque) {
  RenderScene scene = testing::random_stack(45, 300);
  for (Surface& surface : scene.surfaces) surface = {.color = {0.3F, 0.6F, 0.1F}, .alpha = 0.998F};
  testing::test_renderer().load(scene);
  const Camera camera = testing::unit_camera(kSide, kSide);
  const RenderResult expected = testing::test_renderer().draw(camera, {.plain_resolve = true});
  for (const std::uint64_t memory : {64U, 14U * kSide * kSide, 20U * kSide * kSide}) {
    const Drawn drawn = draw(scene, memory);
    for (std::size_t p = 0; p < expected.pixels.size(); ++p) {
      if (memory == 64 && drawn.n(p) == 0) continue;  // has a part of its block's tail
      ASSERT_LT(testing::difference(expected.pixels[p], drawn.result.pixels[p]), 0.06F) << memory;
    }
  }
}

TEST_P(Budget, DrawOrderDoesNotMatter) {
  RenderScene scene = testing::random_stack(43, 90);
  for (const std::uint64_t memory : {100U, 3000U, 30U * kSide * kSide}) {
    scene.draw_order.clear();
    const Drawn straight = draw(scene, memory);
    for (std::uint32_t i = 0; i < scene.triangles.size(); ++i)
      scene.draw_order.insert(scene.draw_order.begin(), i);
    const Drawn reversed = draw(scene, memory);
    EXPECT_EQ(straight.result.pixels, reversed.result.pixels) << memory;
    EXPECT_EQ(straight.result.maps.k, reversed.result.maps.k) << memory;
  }
}

TEST_P(Budget, CoplanarFragmentsKeepTheirColors) {
  RenderScene scene =
      testing::joined(testing::coplanar_squares(9, 0.25F), testing::coplanar_squares(9, 0.5F));
  // From the last id to the first: none finds its slot at once.
  for (std::uint32_t i = 0; i < scene.triangles.size(); ++i)
    scene.draw_order.insert(scene.draw_order.begin(), i);
  const Drawn drawn = draw(scene, 8U * 19 * kSide * kSide + 20'000);
  expect_nearest(drawn);
  const RenderResult expected =
      testing::test_renderer().draw(testing::unit_camera(kSide, kSide), {.plain_resolve = true});
  for (std::size_t p = 0; p < expected.pixels.size(); ++p)
    EXPECT_LE(testing::difference(expected.pixels[p], drawn.result.pixels[p]), 1e-5F + 2.0F / 16384);
}

TEST_P(Budget, LessThanATailIsAnError) {
  testing::test_renderer().load(testing::coplanar_squares(1, 0.5F));
  options_.budget.bytes = 15;
  EXPECT_THROW(testing::test_renderer().draw(testing::unit_camera(8, 8), options_), Error);
}

TEST_P(Budget, EffectsThatDoNotBlendAreRefused) {
  testing::test_renderer().load(testing::coplanar_squares(1, 0.5F));
  options_.effect = Effect::csg;
  EXPECT_THROW(testing::test_renderer().draw(testing::unit_camera(8, 8), options_), Error);
}

INSTANTIATE_TEST_SUITE_P(Techniques, Budget, ::testing::Values("fixed-k", "hybrid", "k-plus", "variable-k"),
                         testing::technique_test_name);

// -------------------------------------------------------------------------------------- how slots are given
// out

class GivenOut : public Budget {};

TEST_P(GivenOut, FixedKIsTheLargestThatFits) {
  options_.technique = "fixed-k";
  for (const std::uint64_t k : {1U, 3U, 5U}) {
    const std::uint64_t memory = 8 * (k + 1) * kSide * kSide;
    EXPECT_EQ(draw(memory).result.stats.k_most, k);
    EXPECT_EQ(draw(memory).result.stats.k_least, k);
    EXPECT_EQ(draw(memory + 8 * kSide * kSide - 1).result.stats.k_most, k);
  }
}

TEST_P(GivenOut, KPlusIsTheLargestThatFits) {
  options_.technique = "k-plus";
  for (const std::uint64_t bytes_of_a_pixel : {20U, 30U, 50U}) {
    const std::uint64_t memory = bytes_of_a_pixel * kSide * kSide;
    const Drawn drawn = draw(memory);
    const auto sum_with = [&](std::uint64_t most) {
      std::uint64_t sum = 0;
      for (std::size_t p = 0; p < drawn.pixels(); ++p) sum += std::min(drawn.n(p), most);
      return sum;
    };
    std::uint64_t most = 1;
    while (most < 200 && sum_with(most + 1) <= slots_of(memory)) ++most;
    for (std::size_t p = 0; p < drawn.pixels(); ++p) EXPECT_EQ(drawn.used(p), std::min(drawn.n(p), most));
  }
}

TEST_P(GivenOut, WaterUsesEverySlot) {
  for (const std::vector<ImportanceTerm>& terms :
       {std::vector<ImportanceTerm>{}, {ImportanceTerm::opacity}, {ImportanceTerm::complexity}}) {
    options_.budget.importance.terms = terms;
    for (const std::uint64_t bytes_of_a_pixel : {20U, 25U, 45U}) {
      const std::uint64_t memory = bytes_of_a_pixel * kSide * kSide;
      const Drawn drawn = draw(memory);
      EXPECT_EQ(drawn.used(), std::min<std::uint64_t>(slots_of(memory), drawn.oracle.fragments.size()));
      // A level that explains all of them.
      double at_least = 0;
      double below = 1e30;
      for (std::size_t p = 0; p < drawn.pixels(); ++p) {
        if (drawn.n(p) == 0) continue;
        const auto slots = static_cast<double>(drawn.used(p));
        const double importance = double{drawn.result.maps.importance[p]};
        ASSERT_GE(slots, 1);
        if (slots > 3) at_least = std::max(at_least, (slots - 3) / importance);
        if (drawn.used(p) < drawn.n(p)) below = std::min(below, (slots - 1) / importance);
      }
      EXPECT_LE(at_least, below * (1 + 1e-6));
    }
  }
}

TEST_P(GivenOut, PrintedIsTheFormulaOfThePaper) {
  options_.budget.allocation = Allocation::printed;
  options_.budget.importance.terms = {ImportanceTerm::complexity, ImportanceTerm::periphery};
  const std::uint64_t memory = 100U * kSide * kSide;
  const Drawn drawn = draw(memory);
  double sum = 0;
  for (const float importance : drawn.result.maps.importance) sum += std::floor(65536.0 * double{importance});
  const double slots = static_cast<double>(slots_of(memory) - drawn.oracle.covered_pixels());
  std::size_t wasted = 0;
  for (std::size_t p = 0; p < drawn.pixels(); ++p) {
    const double share = std::floor(65536.0 * double{drawn.result.maps.importance[p]}) / sum;
    EXPECT_NEAR(drawn.result.maps.k[p], std::floor(share * slots), 1e-9);
    wasted += drawn.n(p) > 0 && drawn.result.maps.k[p] > drawn.n(p) ? 1U : 0U;
  }
  EXPECT_GT(wasted, 0U);
  expect_nearest(drawn);
  expect_no_holes(drawn);
}

TEST_P(GivenOut, TermsOfImportance) {
  const std::uint64_t memory = 60U * kSide * kSide;
  const auto importance_by = [&](const std::vector<ImportanceTerm>& terms) {
    options_.budget.importance.terms = terms;
    return draw(memory);
  };
  const double alpha = options_.budget.importance.alpha;
  options_.budget.importance.noise = 0;
  const Drawn complexity = importance_by({ImportanceTerm::complexity});
  options_.budget.importance.focus_x = 0.25;
  options_.budget.importance.focus_y = 1.5;
  const Drawn both = importance_by({ImportanceTerm::complexity, ImportanceTerm::periphery});
  const Drawn face_on = importance_by({ImportanceTerm::fresnel});
  options_.budget.importance.image = {2, 1, {51, 255}};
  const Drawn image = importance_by({ImportanceTerm::image});
  for (std::size_t p = 0; p < complexity.pixels(); ++p) {
    const auto n = static_cast<double>(complexity.n(p));
    const double by_number = n == 0 ? 0 : alpha + (1 - alpha) * std::min(1.0, n / 25);
    EXPECT_NEAR(complexity.result.maps.importance[p], by_number, 1e-5);
    const double dx = static_cast<double>(p % kSide) + 0.5 - 0.25 * kSide;
    const std::size_t row = p / kSide;
    const double dy = static_cast<double>(row) + 0.5 - 1.5 * kSide;
    const double away = 2 * std::hypot(dx, dy) / (1.1 * std::hypot(kSide, kSide));
    const double by_place = std::max(1 - std::pow(away, 3), 0.0);
    const double product = n == 0 ? 0 : std::max(by_number * by_place, 1.0 / 1024);
    EXPECT_NEAR(both.result.maps.importance[p], product, 1e-4);
    EXPECT_NEAR(face_on.result.maps.importance[p], n == 0 ? 0 : 1, 1e-5);
    EXPECT_NEAR(image.result.maps.importance[p], n == 0 ? 0 : p % kSide < kSide / 2 ? 0.2 : 1, 1e-5);
  }
}

TEST_P(GivenOut, FresnelIsOfTheNearestSurface) {
  // Steep in front of one that is seen head-on.
  RenderScene steep = testing::coplanar_squares(1, 0);
  for (Vec3f& p : steep.positions) p = {p.x / 8, p.y, p.x / 2};
  options_.budget.importance.terms = {ImportanceTerm::fresnel};
  options_.budget.importance.noise = 0;
  const Drawn drawn = draw(testing::joined(testing::coplanar_squares(1, 0.75F), steep), 60U * kSide * kSide);
  const double steep_importance = 1 - 0.5 * std::pow(1 - 1 / std::sqrt(17.0), 5);
  for (std::size_t p = 0; p < drawn.pixels(); ++p) {
    EXPECT_NEAR(drawn.result.maps.importance[p], p % kSide < kSide / 8 ? steep_importance : 1, 5e-3) << p;
  }
}

// Half of the pixels get one more; no line divides them from the others.
TEST_P(GivenOut, WhatALevelLeavesIsSpread) {
  RenderScene scene = testing::coplanar_squares(1, 0);
  for (int i = 1; i < 8; ++i)
    scene = testing::joined(scene, testing::coplanar_squares(1, static_cast<float>(i) / 8));
  const std::uint64_t pixels = kSide * kSide;
  const Drawn drawn =
      draw(scene, 4 * (pixels + 1) + 1088 + 8 * ((pixels + 1023) / 1024) + 8 * (pixels * 9 / 2));
  std::array<std::uint64_t, 4> more{};
  for (std::size_t p = 0; p < drawn.pixels(); ++p) {
    EXPECT_EQ(drawn.used(p) / 2, 2U);
    more.at(2 * (p / kSide / (kSide / 2)) + p % kSide / (kSide / 2)) += drawn.used(p) - 4;
  }
  for (const std::uint64_t quarter : more)
    EXPECT_NEAR(static_cast<double>(quarter), pixels / 8.0, pixels / 200.0);
}

// The first frame is drawn twice, and each goes by what the last one left.
TEST_P(GivenOut, ResidueIsOfTheLastFrame) {
  options_.budget.importance.terms = {ImportanceTerm::residue};
  options_.keep_fragments = false;
  options_.budget.bytes = 30U * kSide * kSide;
  testing::test_renderer().load(testing::random_stack(44, 220));
  const Camera camera = testing::unit_camera(kSide, kSide);
  const auto next = [&] { return testing::test_renderer().draw(camera, options_); };
  const RenderResult first = next();
  EXPECT_EQ(first.stats.geometry_passes, 7U);
  EXPECT_LE(first.stats.bytes, options_.budget.bytes);
  EXPECT_LT(first.stats.captured, first.stats.fragments);
  const RenderResult second = next();
  EXPECT_EQ(second.stats.geometry_passes, 4U);
  EXPECT_NE(first.maps.importance, second.maps.importance);
  for (std::size_t p = 0; p < first.maps.k.size(); ++p) {
    // Where nothing was left to a tail, no more is asked for.
    if (first.maps.lost[p] > 0 || first.maps.importance[p] == 0) continue;
    EXPECT_LT(second.maps.importance[p], first.maps.importance[p]);
  }
  testing::test_renderer().load(testing::random_stack(44, 220));
  EXPECT_EQ(next().pixels, first.pixels);
}

INSTANTIATE_TEST_SUITE_P(VariableK, GivenOut, ::testing::Values("variable-k"), testing::technique_test_name);

}  // namespace
}  // namespace pellucid
