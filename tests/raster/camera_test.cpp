// Tests look_at_sphere(): the sphere fits into the image, and nothing of it is clipped.
#include <gtest/gtest.h>

#include "raster_helpers.h"

namespace pellucid {
namespace {

constexpr std::uint32_t kSide = 100;

struct Frame {
  double x, y, z;  // pixels; z along forward
};
Frame project(const Camera& camera, const Vec3d& p) {
  const Vec3d v = p - camera.eye;
  const double z = dot(v, camera.forward);
  const double scale = camera.height / (2 * camera.half_height) / (camera.perspective ? z : 1.0);
  return {camera.width / 2.0 + dot(v, camera.right) * scale, camera.height / 2.0 - dot(v, camera.up) * scale,
          z};
}

TEST(LookAtSphere, FitsJustInsideTheShorterSide) {
  const BoundingSphere sphere{{3, -2, 7}, 2.5};
  Random random(1);
  for (const auto& [width, height] :
       {std::pair{kSide, kSide}, std::pair{2 * kSide, kSide}, std::pair{kSide, 3 * kSide}}) {
    for (const double distance : {1.1, 2.0, 5.0, 50.0, kInfiniteDistance}) {
      const Camera camera = look_at_sphere(sphere, {random.direction(), distance}, width, height);
      double reach = 0;
      for (int i = 0; i < 20000; ++i) {
        const Frame f = project(camera, sphere.center + random.direction() * sphere.radius);
        reach = std::max({reach, std::hypot(f.x - width / 2.0, f.y - height / 2.0)});
        ASSERT_GE(f.z, camera.near_plane);
        ASSERT_LE(f.z, camera.far_plane);
      }
      EXPECT_LE(reach, 50.0 + 1e-6) << distance;
      EXPECT_GT(reach, 49.5) << distance;
    }
  }
}

TEST(LookAtSphere, AxesAreRightHandedAndOrthonormalFromEverywhere) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Vec3d direction = i == 0 ? Vec3d{0, 1, 0} : (i == 1 ? Vec3d{0, -1, 0} : random.direction());
    const Camera camera = look_at_sphere({{0, 0, 0}, 1}, {direction, 3}, kSide, kSide);
    EXPECT_NEAR(length(camera.right), 1, 1e-12);
    EXPECT_NEAR(length(camera.up), 1, 1e-12);
    EXPECT_NEAR(dot(camera.right, camera.up), 0, 1e-12);
    EXPECT_NEAR(dot(cross(camera.right, camera.up), -camera.forward), 1, 1e-12);
    EXPECT_NEAR(dot(camera.forward, direction), -1, 1e-12);
    EXPECT_NEAR(length(camera.eye - direction * 3.0), 0, 1e-12);
  }
}

TEST(LookAtSphere, AcceptsCamerasInsideAndSpheresWithoutExtent) {
  const Camera inside = look_at_sphere({{0, 0, 0}, 2}, {{0, 0, 1}, 0.5}, kSide, kSide);
  EXPECT_DOUBLE_EQ(inside.half_height, 1.0);
  EXPECT_DOUBLE_EQ(inside.near_plane, 0.002);
  EXPECT_GT(inside.far_plane, 3.0);
  const Camera point = look_at_sphere({{1, 1, 1}, 0}, {{0, 0, 1}, 3}, kSide, kSide);
  EXPECT_TRUE(std::isfinite(point.half_height) && point.near_plane > 0 && point.far_plane > point.near_plane);
}

}  // namespace
}  // namespace pellucid
