// Tests the CPU reference on hand-made cases, and the images of the device against it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render_helpers.h"

namespace pellucid {
namespace {

constexpr Vec3f kWhite{1, 1, 1};

Vec3f pixel_at(const RenderResult& result, std::uint32_t x, std::uint32_t y) {
  return result.pixels.at(y * result.width + x);
}

RenderOptions of(Effect effect, CsgOperation csg = CsgOperation::union_of_all) {
  RenderOptions options;
  options.effect = effect;
  options.csg = csg;
  return options;
}

bool is_red(const Vec3f& color) {
  return color.x > 0.2F && color.y < 0.05F && color.z < 0.05F;
}

// --------------------------------------------------------------------------------------- made by hand

TEST(Reference, BlendsFrontToBack) {
  RenderScene scene =
      testing::joined(testing::coplanar_squares(1, 0.25F), testing::coplanar_squares(1, 0.5F));
  scene.surfaces[0].alpha = 1;
  const RenderResult opaque_first =
      draw_reference(scene, testing::unit_camera(4, 4), of(Effect::transparency));
  scene.surfaces[1].color = {9, 9, 9};
  const RenderResult changed_behind =
      draw_reference(scene, testing::unit_camera(4, 4), of(Effect::transparency));
  EXPECT_EQ(opaque_first.pixels, changed_behind.pixels);
  EXPECT_EQ(opaque_first.stats.fragments, 32U);
  EXPECT_EQ(opaque_first.stats.coplanar, 0U);
}

// Two boxes that share the plane x = 0.5, and a third inside the first that shares its front.
TEST(Reference, DifferenceLeavesNoSkinWhereFacesCoincide) {
  const RenderScene scene =
      testing::joined(testing::closed_box({0.125F, 0.125F, 0.25F}, {0.875F, 0.875F, 0.75F}),
                      testing::closed_box({0.375F, 0.375F, 0.25F}, {0.625F, 0.625F, 0.75F}));
  const Camera camera = testing::unit_camera(32, 32);
  const RenderResult difference = draw_reference(scene, camera, of(Effect::csg, CsgOperation::difference));
  EXPECT_EQ(pixel_at(difference, 16, 16), kWhite);  // drilled through: nothing is left
  EXPECT_NE(pixel_at(difference, 8, 8), kWhite);
  EXPECT_EQ(pixel_at(difference, 1, 1), kWhite);
  const RenderResult intersection =
      draw_reference(scene, camera, of(Effect::csg, CsgOperation::intersection));
  EXPECT_NE(pixel_at(intersection, 16, 16), kWhite);
  EXPECT_EQ(pixel_at(intersection, 8, 8), kWhite);
}

TEST(Reference, CollisionNeedsTwoInsidesOfOneObject) {
  RenderScene touching = testing::joined(testing::closed_box({0.25F, 0.25F, 0.125F}, {0.75F, 0.75F, 0.5F}),
                                         testing::closed_box({0.25F, 0.25F, 0.5F}, {0.75F, 0.75F, 0.875F}));
  RenderScene overlapping =
      testing::joined(testing::closed_box({0.25F, 0.25F, 0.125F}, {0.75F, 0.75F, 0.625F}),
                      testing::closed_box({0.25F, 0.25F, 0.5F}, {0.75F, 0.75F, 0.875F}));
  const Camera camera = testing::unit_camera(16, 16);
  EXPECT_FALSE(is_red(pixel_at(draw_reference(overlapping, camera, of(Effect::self_collision)), 8, 8)));
  for (RenderScene* scene : {&touching, &overlapping}) scene->objects.assign(scene->objects.size(), 0);
  EXPECT_FALSE(is_red(pixel_at(draw_reference(touching, camera, of(Effect::self_collision)), 8, 8)));
  EXPECT_TRUE(is_red(pixel_at(draw_reference(overlapping, camera, of(Effect::self_collision)), 8, 8)));
}

TEST(Reference, CoplanarGroupsAreCounted) {
  const RenderScene scene =
      testing::joined(testing::coplanar_squares(3, 0.5F), testing::coplanar_squares(2, 0.75F));
  const RenderResult result = draw_reference(scene, testing::unit_camera(8, 8), of(Effect::coplanarity));
  EXPECT_EQ(result.stats.coplanar, 5U * 64);
  EXPECT_EQ(result.stats.coplanar_pixels, 64U);
  const Vec3f blue{0.02F, 0.05F, 0.8F};
  EXPECT_EQ(pixel_at(result, 3, 3), blue);
}

TEST(Reference, ThicknessIsThatOfTheSolid) {
  const RenderScene scene = testing::closed_box({0.25F, 0.25F, 0.25F}, {0.75F, 0.75F, 0.75F});
  const RenderResult result = draw_reference(scene, testing::unit_camera(16, 16), of(Effect::thickness));
  EXPECT_NEAR(pixel_at(result, 8, 8).x, std::exp(-4.5), 1e-6);
  EXPECT_EQ(pixel_at(result, 0, 0), kWhite);
}

TEST(Reference, TooManyObjectsAreRefused) {
  RenderScene scene = testing::coplanar_squares(33, 0.5F);
  EXPECT_THROW(draw_reference(scene, testing::unit_camera(4, 4), of(Effect::csg)), Error);
  EXPECT_THROW(draw_reference(scene, testing::unit_camera(4, 4), of(Effect::self_collision)), Error);
}

// ------------------------------------------------------------------------------- the device against it

class OnDevice : public ::testing::TestWithParam<NamedEffect> {
 protected:
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }
};

// Colours of fragments are rounded on the device; a pixel in a thousand may have an edge that falls the other
// way.
void expect_as_reference(const RenderScene& scene, const Camera& camera, const RenderOptions& options) {
  const RenderResult expected = draw_reference(scene, camera, options);
  testing::test_renderer().load(scene);
  // Sorting networks are tested with one effect (Capture); compiling them for each takes seconds.
  RenderOptions plain = options;
  plain.plain_resolve = true;
  const RenderResult drawn = testing::test_renderer().draw(camera, plain);
  ASSERT_EQ(drawn.pixels.size(), expected.pixels.size());
  std::size_t far = 0;
  for (std::size_t p = 0; p < drawn.pixels.size(); ++p) {
    if (testing::difference(drawn.pixels[p], expected.pixels[p]) > 0.02F) ++far;
  }
  EXPECT_LE(far, 1 + drawn.pixels.size() / 1000);
}

TEST_P(OnDevice, StackOfCoplanarTriangles) {
  expect_as_reference(testing::random_stack(11, 50), testing::unit_camera(64, 64), of(GetParam().effect));
}

TEST_P(OnDevice, BoxesInPerspective) {
  const RenderScene scene = testing::joined(testing::closed_box({0, 0, 0}, {1, 1, 1}),
                                            testing::closed_box({0.5F, 0.25F, 0.1F}, {1.5F, 0.75F, 0.9F}));
  const Camera camera = look_at_sphere({{0.7, 0.5, 0.5}, 1.1}, {normalized(Vec3d{0.4, 0.5, 1}), 3}, 80, 60);
  for (const CsgOperation csg :
       {CsgOperation::union_of_all, CsgOperation::intersection, CsgOperation::difference}) {
    expect_as_reference(scene, camera, of(GetParam().effect, csg));
    if (GetParam().effect != Effect::csg) break;
  }
}

TEST_P(OnDevice, SingleSidedSurfaces) {
  RenderScene scene = testing::joined(testing::closed_box({0, 0, 0}, {1, 1, 1}),
                                      testing::closed_box({0.5F, 0.25F, 0.1F}, {1.5F, 0.75F, 0.9F}));
  scene.surfaces[1].double_sided = false;
  const Camera camera = look_at_sphere({{0.7, 0.5, 0.5}, 1.1}, {normalized(Vec3d{0.4, 0.5, 1}), 3}, 80, 60);
  expect_as_reference(scene, camera, of(GetParam().effect));
}

std::vector<NamedEffect> all_effects() {
  return {render_effects().begin(), render_effects().end()};
}

INSTANTIATE_TEST_SUITE_P(Effects, OnDevice, ::testing::ValuesIn(all_effects()), [](const auto& parameter) {
  std::string name = parameter.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace pellucid
