// Tests culling of peeled triangles: the same fragments in the same rounds, with fewer triangles drawn.
#include <gtest/gtest.h>

#include <algorithm>

#include "render_helpers.h"

namespace pellucid {
namespace {

std::vector<std::string> culling_techniques() {
  return testing::techniques_that([](const TechniqueInfo& info) { return info.uses(OptionGroup::culling); });
}

class Culling : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const DeviceInfo& device = testing::test_renderer().info();
    const auto infos = render_techniques();
    const auto info =
        std::find_if(infos.begin(), infos.end(), [](const auto& i) { return i.name == GetParam(); });
    const std::string missing = missing_for(*info, device);
    if (!missing.empty()) GTEST_SKIP() << "this device has no " << missing;
    if (!device.conditional) GTEST_SKIP() << "this device has no conditional rendering";
  }
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }

  // Returns the share of triangles that was drawn.
  static double expect_the_same(const RenderScene& scene, const Camera& camera) {
    Renderer& renderer = testing::test_renderer();
    renderer.load(scene);
    RenderOptions options{.technique = GetParam(), .k = 2, .keep_fragments = true};
    const RenderResult all = renderer.draw(camera, options);
    options.peeling.cull = true;
    const RenderResult culled = renderer.draw(camera, options);
    EXPECT_EQ(all.pixels, culled.pixels) << GetParam();
    EXPECT_EQ(all.stats.rounds, culled.stats.rounds) << GetParam();
    EXPECT_EQ(all.stats.captured, culled.stats.captured) << GetParam();
    EXPECT_TRUE(std::ranges::equal(
        all.fragments.fragments, culled.fragments.fragments,
        [](const Fragment& a, const Fragment& b) { return a.depth == b.depth && a.node == b.node; }));
    EXPECT_EQ(all.stats.drawn_share, 1.0);
    return culled.stats.drawn_share;
  }
};

// The eye in the midst of the scene: boxes behind it, around it and before it.
Camera inside() {
  Camera camera = testing::unit_camera(45, 33);
  camera.eye = {0.45, 0.55, 0.3};
  camera.forward = normalized(Vec3d{0.3, -0.2, 0.9});
  camera.right = normalized(cross(camera.forward, Vec3d{0, -1, 0}));
  camera.up = cross(camera.right, camera.forward);
  camera.perspective = true;
  camera.half_height = 0.8;
  camera.near_plane = 0.01;
  camera.far_plane = 0.6;  // cuts through the scene
  return camera;
}

TEST_P(Culling, BoxesOfManyObjects) {
  for (const std::uint64_t seed : {1U, 2U}) {
    EXPECT_LT(expect_the_same(testing::random_boxes(seed, 40, 8), testing::unit_camera(40, 40)), 0.95);
  }
}

TEST_P(Culling, WithTheEyeInsideTheScene) {
  for (const std::uint64_t seed : {3U, 4U}) {
    EXPECT_LT(expect_the_same(testing::random_boxes(seed, 40, 8), inside()), 0.95);
  }
}

TEST_P(Culling, CoplanarTrianglesAreResumed) {
  expect_the_same(testing::random_stack(23, 200), testing::unit_camera(40, 40));
}

TEST(CullingOption, IsForTechniquesThatPeel) {
  Renderer& renderer = testing::test_renderer();
  renderer.load(testing::coplanar_squares(1, 0.5F));
  EXPECT_THROW(renderer.draw(testing::unit_camera(4, 4), {.technique = "sb", .peeling = {.cull = true}}),
               Error);
}

INSTANTIATE_TEST_SUITE_P(Techniques, Culling, ::testing::ValuesIn(culling_techniques()),
                         testing::technique_test_name);

}  // namespace
}  // namespace pellucid
