// Tests images: every technique that captures all fragments draws what the S-buffer draws, for every effect.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "render_helpers.h"

namespace pellucid {
namespace {

std::vector<std::string> exact_techniques() {
  return testing::techniques_that(
      [](const TechniqueInfo& info) { return info.exact && !info.blends_only && info.name != "sb"; });
}

// Blended colours and sums of lengths depend on where a technique puts the brackets, and blending stops where
// less than 1 / 16384 of a colour, which is 2 at most, gets through.
float tolerance(Effect effect) {
  if (effect == Effect::thickness) return 1e-5F;
  return effect == Effect::transparency || effect == Effect::wireframe ? 1e-5F + 2.0F / 16384 : 0.0F;
}

// All with the same k: it is a constant of the kernels, and compiling is most of what these tests take.
class Images : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const auto infos = render_techniques();
    const auto info =
        std::find_if(infos.begin(), infos.end(), [](const auto& i) { return i.name == GetParam(); });
    const std::string missing = missing_for(*info, testing::test_renderer().info());
    if (!missing.empty()) GTEST_SKIP() << "this device has no " << missing;
  }
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }

  static void expect_as_s_buffer(const Camera& camera, RenderOptions options) {
    Renderer& renderer = testing::test_renderer();
    // One kernel for lists of all lengths: compiling those that capture_test.cpp tests, for every effect,
    // takes minutes.
    options.plain_resolve = true;
    options.technique = "sb";
    const RenderResult expected = renderer.draw(camera, options);
    options.technique = GetParam();
    const RenderResult result = renderer.draw(camera, options);
    EXPECT_EQ(result.stats.captured, expected.stats.captured);
    EXPECT_EQ(result.stats.overflowed, 0U);
    EXPECT_EQ(result.stats.coplanar, expected.stats.coplanar);
    EXPECT_EQ(result.stats.coplanar_pixels, expected.stats.coplanar_pixels);
    float largest = 0;
    for (std::size_t i = 0; i < expected.pixels.size(); ++i) {
      largest = std::max(largest, testing::difference(result.pixels[i], expected.pixels[i]));
    }
    EXPECT_LE(largest, tolerance(options.effect))
        << GetParam() << ", " << render_effects()[static_cast<std::size_t>(options.effect)].name;
  }
};

TEST_P(Images, OfRandomStacks) {
  testing::test_renderer().load(testing::random_stack(11, 60));
  for (const NamedEffect& effect : render_effects()) {
    // Open surfaces have no inside that a ray could come to from both ends.
    const bool solids = effect.effect == Effect::csg || effect.effect == Effect::self_collision;
    if (solids && GetParam().starts_with("dual")) continue;
    expect_as_s_buffer(testing::unit_camera(40, 40), {.effect = effect.effect, .k = 2});
  }
}

TEST_P(Images, OfOverlappingBoxes) {
  for (const std::uint64_t seed : {1U, 2U}) {
    testing::test_renderer().load(testing::random_boxes(seed, 20, 5));
    for (const NamedEffect& effect : render_effects()) {
      expect_as_s_buffer(testing::unit_camera(40, 40), {.effect = effect.effect, .k = 2});
    }
  }
}

TEST_P(Images, OfAllBooleanOperations) {
  for (const std::uint64_t seed : {3U, 4U, 5U, 6U}) {
    testing::test_renderer().load(testing::random_boxes(seed, 8, 3));
    for (const CsgOperation csg :
         {CsgOperation::union_of_all, CsgOperation::intersection, CsgOperation::difference}) {
      expect_as_s_buffer(testing::unit_camera(40, 40), {.effect = Effect::csg, .csg = csg, .k = 2});
    }
  }
}

// The surface lies in the rear half, in a group of coplanar faces of different colours: techniques that come
// from behind have to choose the same one.
TEST_P(Images, OfAnIntersectionFarBehind) {
  RenderScene scene = testing::closed_box({0, 0, 0.125F}, {1, 1, 0.25F});
  for (const auto& [near, far] : {std::pair{0.375F, 0.5F}, {0.625F, 0.75F}, {0.625F, 0.75F}}) {
    scene = testing::joined(scene, testing::closed_box({0, 0, near}, {1, 1, far}));
  }
  for (std::size_t i = 0; i < scene.objects.size(); ++i) scene.objects[i] = i < 36 ? 0 : 1;
  scene.surfaces.resize(2);
  scene.surfaces[1].color = {0.9F, 0.1F, 0.7F};
  testing::test_renderer().load(scene);
  expect_as_s_buffer(testing::unit_camera(16, 16),
                     {.effect = Effect::csg, .csg = CsgOperation::intersection, .k = 2});
}

// Depths that are anything but dyadic: all passes of a technique have to get the same ones.
TEST_P(Images, InPerspective) {
  Camera camera = testing::unit_camera(57, 43);
  camera.eye = {-0.9, -0.6, -1.7};
  camera.forward = normalized(Vec3d{0.5, 0.5, 0.5} - camera.eye);
  camera.right = normalized(cross(camera.forward, Vec3d{0, -1, 0}));
  camera.up = cross(camera.right, camera.forward);
  camera.perspective = true;
  camera.half_height = 0.4;
  camera.near_plane = 0.7;
  camera.far_plane = 4.1;
  for (const std::uint64_t seed : {7U, 8U, 9U, 10U}) {
    testing::test_renderer().load(testing::random_boxes(seed, 16, 4));
    for (const Effect effect :
         {Effect::transparency, Effect::complexity, Effect::csg, Effect::self_collision}) {
      expect_as_s_buffer(camera, {.effect = effect, .k = 2});
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Techniques, Images, ::testing::ValuesIn(exact_techniques()),
                         testing::technique_test_name);

}  // namespace
}  // namespace pellucid
