// camera.cpp - cameras that look at a bounding sphere.
#include <algorithm>
#include <cmath>

#include "pellucid/raster.h"

namespace pellucid {
namespace {

// Near and far planes keep this share of a distance between them and the sphere, so that rounding clips
// nothing.
constexpr double kPlaneSlack = 1e-3;
// At or below this many radii the camera counts as inside the sphere, which then has no outline to fit.
constexpr double kInsideDistance = 1.01;
// Beyond this |cosine| between view direction and +y, +z is "up".
constexpr double kParallelCosine = 0.99;

void aim(Camera& camera, const Vec3d& forward) {
  const Vec3d world_up = std::abs(forward.y) < kParallelCosine ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
  camera.forward = forward;
  camera.right = normalized(cross(forward, world_up));
  camera.up = cross(camera.right, forward);
}

}  // namespace

Camera look_at_sphere(const BoundingSphere& sphere, const Viewpoint& viewpoint, std::uint32_t width,
                      std::uint32_t height) {
  const double radius = sphere.radius > 0 ? sphere.radius : 1.0;
  const double distance = viewpoint.distance;
  const Vec3d direction = normalized(viewpoint.direction);
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.perspective = std::isfinite(distance);
  aim(camera, -direction);

  if (camera.perspective) {
    const bool inside = distance <= kInsideDistance;
    camera.eye = sphere.center + direction * (distance * radius);
    camera.half_height = inside ? 1.0 : 1.0 / std::sqrt(distance * distance - 1.0);
    camera.near_plane =
        radius * (inside ? kPlaneSlack : std::max((distance - 1.0) * (1.0 - kPlaneSlack), kPlaneSlack));
    camera.far_plane = radius * (std::abs(distance) + 1.0) * (1.0 + kPlaneSlack);
  } else {
    camera.eye = sphere.center + direction * (radius * (1.0 + kPlaneSlack));
    camera.half_height = radius;
    camera.near_plane = 0;
    camera.far_plane = 2.0 * radius * (1.0 + kPlaneSlack);
  }
  // half_height spans the shorter side.
  if (width < height) camera.half_height *= static_cast<double>(height) / static_cast<double>(width);
  return camera;
}

}  // namespace pellucid
