// Tests how devices are chosen, refused and described.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render_helpers.h"

namespace pellucid {
namespace {

using ::testing::HasSubstr;

TEST(Device, IsDescribed) {
  const DeviceInfo& info = testing::test_renderer().info();
  EXPECT_FALSE(info.name.empty());
  EXPECT_GE(info.max_buffer_bytes, 1ULL << 27U);
  EXPECT_GE(info.max_side, 4096U);
}

TEST(Device, OfAnotherNameIsRefusedWithTheNamesOfThoseThere) {
  try {
    const Renderer renderer({.device = "no such device"});
    FAIL() << "a device was found";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_argument);
    EXPECT_THAT(error.what(), HasSubstr("no such device"));
    EXPECT_THAT(error.what(), HasSubstr(testing::test_renderer().info().name));
  }
}

TEST(Device, UnknownTechniqueIsRefusedWithTheNamesOfThoseThere) {
  Renderer& renderer = testing::test_renderer();
  renderer.load(testing::coplanar_squares(1, 0.5F));
  RenderOptions options;
  options.technique = "magic";
  try {
    renderer.draw(testing::unit_camera(8, 8), options);
    FAIL() << "it was drawn";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_argument);
    EXPECT_THAT(error.what(), HasSubstr("magic"));
    EXPECT_THAT(error.what(), HasSubstr("sb"));
  }
}

TEST(Device, SceneThatDoesNotFitTogetherIsRefused) {
  RenderScene scene = testing::coplanar_squares(1, 0.5F);
  scene.triangles[1][2] = 99;
  EXPECT_THROW(testing::test_renderer().load(scene), Error);
  scene = testing::coplanar_squares(1, 0.5F);
  scene.draw_order = {0, 0};
  EXPECT_THROW(testing::test_renderer().load(scene), Error);
}

}  // namespace
}  // namespace pellucid
