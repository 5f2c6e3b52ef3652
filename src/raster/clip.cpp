// clip.cpp - see clip.h.
#include "raster/clip.h"

#include <tuple>

namespace pellucid::raster {
namespace {

// Inside where dot(normal, p) + offset >= 0.
struct ClipPlane {
  Vec3d normal;
  double offset;
  [[nodiscard]] double distance(const Vec3d& p) const { return dot(normal, p) + offset; }
};

std::array<ClipPlane, 6> clip_planes(const Projection& projection) {
  const Camera& camera = projection.camera();
  // Guard band in units of x / z (perspective) or x (orthographic), from the picture's centre.
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

// Where the segment a-b meets the plane. The same bits for b-a: the end points are sorted first.
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
