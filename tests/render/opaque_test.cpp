// Tests opaque surfaces: they are drawn before anything is captured, and what lies behind them is no
// fragment, for every technique.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render_helpers.h"

namespace pellucid {
namespace {

// Squares over the whole image, the second one opaque.
RenderScene squares_around_opaque() {
  RenderScene scene = testing::coplanar_squares(1, 0.25F);
  for (const float depth : {0.5F, 0.5F, 0.75F})
    scene = testing::joined(scene, testing::coplanar_squares(1, depth));
  scene.surfaces[1].opaque = true;
  return scene;
}

// Coplanar triangles in layers; one surface of them is opaque and shows both sides, one only its front.
RenderScene mixed_stack(std::uint64_t seed) {
  RenderScene scene = testing::random_stack(seed, 60);
  const RenderScene more = testing::random_stack(seed + 100, 12);
  scene = testing::joined(scene, more);
  for (const std::size_t opaque : {4U, 5U, 6U, 7U}) scene.surfaces[opaque].opaque = true;
  scene.surfaces[5].double_sided = false;
  scene.surfaces[2].double_sided = false;
  return scene;
}

TEST(OpaqueReference, HidesWhatIsAtItsDepthOrBehind) {
  const RenderScene scene = squares_around_opaque();
  RenderOptions options;
  options.keep_fragments = true;
  const RenderResult result = draw_reference(scene, testing::unit_camera(4, 4), options);
  EXPECT_EQ(result.stats.fragments, 16U);
  for (const Fragment& f : result.fragments.fragments) EXPECT_EQ(f.depth, 0.25F);
  // What is behind has no part in the image, nor has the background.
  RenderScene changed = scene;
  changed.surfaces[2].color = changed.surfaces[3].color = {5, 5, 5};
  options.background = {0, 0, 0};
  EXPECT_EQ(draw_reference(changed, testing::unit_camera(4, 4), options).pixels, result.pixels);
}

TEST(OpaqueReference, IsAsIfAlphaWereOne) {
  RenderScene scene = mixed_stack(3);
  RenderOptions options;
  const Camera camera = testing::unit_camera(32, 32);
  const RenderResult hidden = draw_reference(scene, camera, options);
  for (Surface& s : scene.surfaces) {
    if (s.opaque) s.alpha = 1;
    s.opaque = false;
  }
  const RenderResult all = draw_reference(scene, camera, options);
  EXPECT_LT(hidden.stats.fragments, all.stats.fragments);
  // A translucent surface at the same depth may come first there.
  std::size_t differ = 0;
  for (std::size_t p = 0; p < all.pixels.size(); ++p) differ += all.pixels[p] == hidden.pixels[p] ? 0U : 1U;
  EXPECT_LT(differ, all.pixels.size() / 8);
}

TEST(OpaqueReference, OtherEffectsCaptureAll) {
  RenderOptions options;
  options.effect = Effect::complexity;
  EXPECT_EQ(draw_reference(squares_around_opaque(), testing::unit_camera(4, 4), options).stats.fragments,
            64U);
}

class Opaque : public ::testing::TestWithParam<TechniqueInfo> {
 protected:
  void SetUp() override {
    const std::string missing = missing_for(GetParam(), testing::test_renderer().info());
    if (!missing.empty()) GTEST_SKIP() << "this device has no " << missing;
  }
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }
};

// The same number of fragments in every pixel or, where a technique keeps only some, none that is not there.
void expect_fragments(const CapturedFragments& captured, const CapturedFragments& expected, bool all) {
  ASSERT_EQ(captured.offsets.size(), expected.offsets.size());
  const auto before = [](const Fragment& a, const Fragment& b) {
    return std::make_pair(a.depth, a.node) < std::make_pair(b.depth, b.node);
  };
  std::size_t wrong = 0;
  for (std::size_t p = 0; p + 1 < expected.offsets.size(); ++p) {
    std::vector<Fragment> here = testing::pixel_of(captured, p);
    const std::vector<Fragment> there = testing::pixel_of(expected, p);
    std::sort(here.begin(), here.end(), before);
    const bool right = std::includes(there.begin(), there.end(), here.begin(), here.end(), before);
    if (!right || (all && here.size() != there.size()) || here.empty() != there.empty()) ++wrong;
  }
  EXPECT_EQ(wrong, 0U);
}

TEST_P(Opaque, StacksAsOnTheCpu) {
  RenderOptions options;
  options.technique = GetParam().name;
  options.plain_resolve = true;
  options.keep_fragments = true;
  const Camera camera = testing::unit_camera(40, 40);
  for (const std::uint64_t seed : {3U, 4U}) {
    const RenderScene scene = mixed_stack(seed);
    testing::test_renderer().load(scene);
    const RenderResult drawn = testing::test_renderer().draw(camera, options);
    const RenderResult expected = draw_reference(scene, camera, options);
    EXPECT_EQ(drawn.stats.fragments, expected.stats.fragments);
    const bool all = GetParam().exact && drawn.stats.overflowed == 0;
    expect_fragments(drawn.fragments, expected.fragments, all);
    if (!all) continue;
    std::size_t far = 0;
    for (std::size_t p = 0; p < drawn.pixels.size(); ++p)
      far += testing::difference(drawn.pixels[p], expected.pixels[p]) > 0.02F ? 1U : 0U;
    EXPECT_LE(far, 1U);
  }
}

std::vector<TechniqueInfo> capturing_techniques() {
  std::vector<TechniqueInfo> infos;
  for (const TechniqueInfo& info : render_techniques()) {
    if (!info.blends_only) infos.push_back(info);
  }
  return infos;
}

INSTANTIATE_TEST_SUITE_P(Techniques, Opaque, ::testing::ValuesIn(capturing_techniques()),
                         [](const auto& parameter) {
                           std::string name = parameter.param.name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

class OpaqueImages : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }
};

TEST_F(OpaqueImages, DoNotDependOnTheDrawOrder) {
  RenderScene scene = mixed_stack(5);
  RenderOptions options;
  options.plain_resolve = true;
  testing::test_renderer().load(scene);
  const RenderResult straight = testing::test_renderer().draw(testing::unit_camera(40, 40), options);
  for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) scene.draw_order.push_back(i);
  std::reverse(scene.draw_order.begin(), scene.draw_order.end());
  testing::test_renderer().load(scene);
  EXPECT_EQ(testing::test_renderer().draw(testing::unit_camera(40, 40), options).pixels, straight.pixels);
}

// Nothing is left to capture: edges and colours are those of the opaque surfaces.
TEST_F(OpaqueImages, OfNothingElse) {
  RenderScene scene = testing::joined(testing::closed_box({0, 0, 0}, {1, 1, 1}),
                                      testing::closed_box({0.5F, 0.25F, 0.1F}, {1.5F, 0.75F, 0.9F}));
  for (Surface& s : scene.surfaces) s.opaque = true;
  const Camera camera = look_at_sphere({{0.7, 0.5, 0.5}, 1.1}, {normalized(Vec3d{0.4, 0.5, 1}), 3}, 80, 60);
  RenderOptions options;
  options.plain_resolve = true;
  options.effect = Effect::wireframe;
  testing::test_renderer().load(scene);
  const RenderResult drawn = testing::test_renderer().draw(camera, options);
  const RenderResult expected = draw_reference(scene, camera, options);
  EXPECT_EQ(drawn.stats.fragments, 0U);
  std::size_t far = 0;
  for (std::size_t p = 0; p < drawn.pixels.size(); ++p)
    far += testing::difference(drawn.pixels[p], expected.pixels[p]) > 0.02F ? 1U : 0U;
  EXPECT_LE(far, 5U);
}

}  // namespace
}  // namespace pellucid
