// Implements cameras that look at a sphere, the projection to the fixed-point grid, and clipping.
//
// Clipping is based on: Sutherland, Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974.
#include "raster/projection.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace pellucid {

// --------------------------------------------------------------------------------------------------- cameras

namespace {

// The near and far planes keep a gap of this share of the distance to the sphere, so that rounding clips
// nothing.
constexpr double kPlaneSlack = 1e-3;
// At this distance in radii or below, the camera counts as inside the sphere, which then has no outline to
// fit.
constexpr double kInsideDistance = 1.01;
// If the |cosine| between the view direction and +y is larger, +z is the up direction instead of +y.
constexpr double kParallelCosine = 0.99;

void aim(Camera& camera, const Vec3d& forward) {
  const Vec3d world_up = std::abs(forward.y) < kParallelCosine ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
  camera.forward = forward;
  camera.right = normalized(cross(forward, world_up));
  camera.up = cross(camera.right, forward);
}

}  // namespace

Eye eye_of(const BoundingSphere& sphere, const Viewpoint& viewpoint) {
  if (std::isinf(viewpoint.distance)) return {viewpoint.direction, 0};
  return {sphere.center + viewpoint.direction * (viewpoint.distance * sphere.radius), 1};
}

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
  // So far half_height belongs to the shorter side.
  if (width < height) camera.half_height *= static_cast<double>(height) / static_cast<double>(width);
  return camera;
}

}  // namespace pellucid

namespace pellucid::raster {

// ------------------------------------------------------------------------------------------------ projection

Projection::Projection(const Camera& camera)
    : camera_(camera),
      scale_(0.5 * camera.height / camera.half_height),
      center_x_(0.5 * camera.width),
      center_y_(0.5 * camera.height) {
  if (camera.perspective) {
    inverse_near_ = 1.0 / camera.near_plane;
    depth_scale_ = 1.0 / (inverse_near_ - 1.0 / camera.far_plane);
  } else {
    depth_scale_ = 1.0 / (camera.far_plane - camera.near_plane);
  }
}

ScreenVertex Projection::unsnapped(const Vec3d& view) const {
  ScreenVertex v;
  const double inverse_z = camera_.perspective ? 1.0 / view.z : 1.0;
  v.x = center_x_ + view.x * inverse_z * scale_;
  v.y = center_y_ - view.y * inverse_z * scale_;
  v.depth = camera_.perspective ? (inverse_near_ - inverse_z) * depth_scale_
                                : (view.z - camera_.near_plane) * depth_scale_;
  return v;
}

ScreenVertex Projection::screen(const Vec3d& view) const {
  ScreenVertex v = unsnapped(view);
  v.fixed_x = snap(v.x);
  v.fixed_y = snap(v.y);
  return v;
}

ScreenVertex Projection::classified(const Vec3d& view) const {
  ScreenVertex v;
  if (!std::isfinite(view.x + view.y + view.z)) {
    v.outside = kNotFinite;
    return v;
  }
  if (view.z < camera_.near_plane) {
    v.outside = kOutsideNear;
    return v;
  }
  v = unsnapped(view);
  unsigned outside = 0;
  if (view.z > camera_.far_plane) outside |= kOutsideFar;
  if (v.x < -kGuardBand) outside |= kOutsideLeft;
  if (v.x > camera_.width + kGuardBand) outside |= kOutsideRight;
  if (v.y < -kGuardBand) outside |= kOutsideTop;
  if (v.y > camera_.height + kGuardBand) outside |= kOutsideBottom;
  v.outside = static_cast<std::uint8_t>(outside);
  if (outside == 0) {
    v.fixed_x = snap(v.x);
    v.fixed_y = snap(v.y);
  }
  return v;
}

Projection::Plane Projection::depth_plane(const Vec3d& a, const Vec3d& b, const Vec3d& c) const {
  // The plane is the set of points p with dot(normal, p) = offset.
  const Vec3d normal = cross(b - a, c - a);
  const double offset = dot(normal, a);
  Plane plane;
  if (camera_.perspective) {
    // With p = z (X, Y, 1): 1 / z = dot(normal, (X, Y, 1)) / offset.
    const double k = -depth_scale_ / offset;
    plane.gradient_x = k * normal.x / scale_;
    plane.gradient_y = -k * normal.y / scale_;
    plane.offset = inverse_near_ * depth_scale_ + k * normal.z;
  } else {
    // With p = (X, Y, z): z = (offset - normal.x X - normal.y Y) / normal.z.
    const double k = depth_scale_ / normal.z;
    plane.gradient_x = -k * normal.x / scale_;
    plane.gradient_y = k * normal.y / scale_;
    plane.offset = k * offset - camera_.near_plane * depth_scale_;
  }
  plane.offset -= plane.gradient_x * center_x_ + plane.gradient_y * center_y_;
  return plane;
}

void project(const Projection& projection, std::span<const Vec3f> positions,
             std::span<ScreenVertex> vertices) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    vertices[i] = projection.classified(projection.view(positions[i]));
  }
}

// -------------------------------------------------------------------------------------------------- clipping

namespace {

// A point p is inside if dot(normal, p) + offset >= 0.
struct ClipPlane {
  Vec3d normal;
  double offset;
  [[nodiscard]] double distance(const Vec3d& p) const { return dot(normal, p) + offset; }
};

std::array<ClipPlane, 6> clip_planes(const Projection& projection) {
  const Camera& camera = projection.camera();
  // The guard band in units of x / z (perspective) or x (orthographic), from the centre of the image.
  const double half_width = (0.5 * camera.width + kGuardBand) / projection.scale();
  const double half_height = (0.5 * camera.height + kGuardBand) / projection.scale();
  const double z = camera.perspective ? 1 : 0;
  const double w = camera.perspective ? 0 : 1;
  return {{{{0, 0, 1}, -camera.near_plane},
           {{0, 0, -1}, camera.far_plane},
           {{1, 0, z * half_width}, w * half_width},
           {{-1, 0, z * half_width}, w * half_width},
           {{0, 1, z * half_height}, w * half_height},
           {{0, -1, z * half_height}, w * half_height}}};
}

// Returns the point where the segment a-b meets the plane. Sorts the end points first, so that b-a gives the
// same bits.
Vec3d cut(const Vec3d& a, const Vec3d& b, const ClipPlane& plane) {
  const bool swapped = std::tie(b.x, b.y, b.z) < std::tie(a.x, a.y, a.z);
  const Vec3d& first = swapped ? b : a;
  const Vec3d& second = swapped ? a : b;
  const double from = plane.distance(first);
  const double to = plane.distance(second);
  return first + (second - first) * (from / (from - to));
}

ClippedPolygon clip(const ClippedPolygon& polygon, const ClipPlane& plane) {
  ClippedPolygon result;
  const std::span<const Vec3d> corners = polygon.corners();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d& a = corners[i];
    const Vec3d& b = corners[(i + 1) % corners.size()];
    const bool a_inside = plane.distance(a) >= 0;
    const bool b_inside = plane.distance(b) >= 0;
    if (a_inside) result.add(a);
    if (a_inside != b_inside) result.add(cut(a, b, plane));
  }
  return result;
}

}  // namespace

ClippedPolygon clip_triangle(const Projection& projection, const std::array<Vec3d, 3>& triangle) {
  ClippedPolygon polygon;
  for (const Vec3d& corner : triangle) polygon.add(corner);
  for (const ClipPlane& plane : clip_planes(projection)) polygon = clip(polygon, plane);
  return polygon;
}

}  // namespace pellucid::raster
