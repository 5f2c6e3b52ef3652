// Tests multisampling: every sample has the fragments that the CPU raster finds at its position.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "render_helpers.h"

namespace pellucid {
namespace {

std::vector<std::string> techniques_with_fragments() {
  return testing::techniques_that([](const TechniqueInfo& info) { return !info.blends_only; });
}

// Vulkan's standard places of four samples are pixels of an image that is four times as large.
constexpr std::array<std::array<std::uint32_t, 2>, 4> kPlaces{{{1, 0}, {3, 1}, {0, 2}, {2, 3}}};

bool before(const Fragment& a, const Fragment& b) {
  return a.depth < b.depth || (a.depth == b.depth && a.node < b.node);
}
bool same(const Fragment& a, const Fragment& b) {
  return a.depth == b.depth && a.node == b.node;
}

class Multisampling : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const DeviceInfo& device = testing::test_renderer().info();
    const auto infos = render_techniques();
    info_ = *std::find_if(infos.begin(), infos.end(), [](const auto& i) { return i.name == GetParam(); });
    const std::string missing = missing_for(info_, device);
    if (!missing.empty()) GTEST_SKIP() << "this device has no " << missing;
  }
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }

  TechniqueInfo info_;
};

TEST_P(Multisampling, SamplesAreThoseOfALargerImage) {
  const std::uint32_t side = 24;
  const RenderScene scene = testing::random_stack(31, 60);
  testing::test_renderer().load(scene);
  const RenderOptions options{
      .technique = GetParam(), .k = 2, .samples = 4, .plain_resolve = true, .keep_fragments = true};
  const RenderResult result = testing::test_renderer().draw(testing::unit_camera(side, side), options);
  const FragmentBuffer oracle = testing::cpu_fragments(scene, testing::unit_camera(4 * side, 4 * side));
  ASSERT_EQ(result.pixels.size(), side * side);
  ASSERT_EQ(result.fragments.offsets.size(), 4 * side * side + 1);
  std::size_t wrong = 0;
  for (std::uint32_t p = 0; p < side * side; ++p) {
    for (std::uint32_t s = 0; s < 4; ++s) {
      const std::size_t place =
          (4 * (p / side) + kPlaces.at(s)[1]) * std::size_t{4 * side} + 4 * (p % side) + kPlaces.at(s)[0];
      std::vector<Fragment> captured = testing::pixel_of(result.fragments, 4 * std::size_t{p} + s);
      std::sort(captured.begin(), captured.end(), before);
      const auto expected = oracle.pixel(place);
      const bool right = info_.exact ? std::ranges::equal(captured, expected, same)
                                     : std::includes(expected.begin(), expected.end(), captured.begin(),
                                                     captured.end(), before);
      wrong += right ? 0U : 1U;
    }
  }
  EXPECT_EQ(wrong, 0U);
}

class MultisampledImages : public Multisampling {};

TEST_P(MultisampledImages, AreMeansOfTheirSamples) {
  const std::uint32_t side = 16;
  RenderScene scene = testing::random_boxes(5, 12, 4);
  scene.surfaces[2].opaque = true;
  testing::test_renderer().load(scene);
  RenderOptions options{.technique = GetParam(), .k = 2, .plain_resolve = true};
  const RenderResult large = testing::test_renderer().draw(testing::unit_camera(4 * side, 4 * side), options);
  options.samples = 4;
  const RenderResult drawn = testing::test_renderer().draw(testing::unit_camera(side, side), options);
  float largest = 0;
  for (std::uint32_t p = 0; p < side * side; ++p) {
    Vec3f mean{0, 0, 0};
    for (const auto& [x, y] : kPlaces) {
      const std::size_t place = (4 * (p / side) + y) * std::size_t{4 * side} + 4 * (p % side) + x;
      mean = mean + large.pixels[place] * 0.25F;
    }
    largest = std::max(largest, testing::difference(mean, drawn.pixels[p]));
  }
  // Colours are rounded to 8 bits, whose steps are larger than what else may differ.
  EXPECT_LT(largest, 0.02F);
}

TEST(MultisamplingOption, IsRefusedWhereItCannotBe) {
  Renderer& renderer = testing::test_renderer();
  renderer.load(testing::coplanar_squares(1, 0.5F));
  EXPECT_THROW(renderer.draw(testing::unit_camera(4, 4), {.technique = "sb", .samples = 3}), Error);
}

std::vector<std::string> techniques_that_are_exact() {
  return testing::techniques_that([](const TechniqueInfo& info) { return info.exact; });
}
INSTANTIATE_TEST_SUITE_P(Techniques, MultisampledImages, ::testing::ValuesIn(techniques_that_are_exact()),
                         testing::technique_test_name);
INSTANTIATE_TEST_SUITE_P(Techniques, Multisampling, ::testing::ValuesIn(techniques_with_fragments()),
                         testing::technique_test_name);

}  // namespace
}  // namespace pellucid
