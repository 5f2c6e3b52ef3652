// From where does one face hide a part of another: see hiding_viewpoints.h.
#include "transparency/graph/hiding_viewpoints.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pellucid {
namespace {

// Parts of a face that are nearer to the other's plane than this lie in it: positions are rounded to 6e-8.
constexpr double kApart = 1e-7;
// A plane through an edge and a point that are nearer to each other than this is too uncertain to cut by.
constexpr double kCloseToEdge = 1e-7;
// So far on the wrong side a corner still touches a separating plane.
constexpr double kOnPlane = 1e-10;

// What is left of a triangle on one side of a plane.
struct FacePart {
  std::array<Vec3d, 4> points;
  std::size_t count = 0;
  void push(const Vec3d& p) { points[count++] = p; }
};

// The part where the signed distance is positive; empty where it is never above kApart.
FacePart part_in_front(const std::array<Vec3d, 3>& corners, const std::array<double, 3>& distances) {
  FacePart part;
  if (std::ranges::max(distances) <= kApart) return part;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (distances[i] >= 0) part.push(corners[i]);
    if ((distances[i] < 0) != (distances[j] < 0)) {
      part.push(corners[i] + (corners[j] - corners[i]) * (distances[i] / (distances[i] - distances[j])));
    }
  }
  return part;
}

// Signed distances of a face's corners before (sign = 1) or behind (-1) a plane.
std::array<double, 3> distances_from(const HalfSpace& plane, const std::array<Vec3d, 3>& corners,
                                     double sign) {
  std::array<double, 3> distances{};
  for (std::size_t i = 0; i < 3; ++i) distances[i] = sign * plane.value({corners[i], 1});
  return distances;
}

struct Extent {
  double low, high;
};
Extent extent_along(const FacePart& part, const Vec3d& normal, const Vec3d& origin) {
  Extent extent{HUGE_VAL, -HUGE_VAL};
  for (std::size_t i = 0; i < part.count; ++i) {
    const double d = dot(normal, part.points[i] - origin);
    extent = {std::min(extent.low, d), std::max(extent.high, d)};
  }
  return extent;
}

// The half-space of the plane through p, q and r, if it separates the parts and has `front` inside.
std::optional<HalfSpace> separating(const FacePart& front, const FacePart& back, const Vec3d& p,
                                    const Vec3d& q, const Vec3d& r) {
  const Vec3d edge = q - p;
  Vec3d normal = cross(edge, r - p);
  const double size = length(normal);
  if (size <= kCloseToEdge * length(edge)) return std::nullopt;
  normal = normal / size;
  const Extent a = extent_along(front, normal, p);
  const Extent b = extent_along(back, normal, p);
  const bool upright = a.low >= -kOnPlane && b.high <= kOnPlane;
  const bool reversed = a.high <= kOnPlane && b.low >= -kOnPlane;
  if (upright == reversed) return std::nullopt;
  if (reversed) normal = -normal;
  return HalfSpace{normal, -dot(normal, p)};
}

// Cut by every separating plane through an edge of one part and a corner of the other.
void cut_by_tangents(ViewPolytope& viewpoints, const FacePart& front, const FacePart& back,
                     bool edges_of_front) {
  const FacePart& with_edge = edges_of_front ? front : back;
  const FacePart& with_corner = edges_of_front ? back : front;
  for (std::size_t i = 0; i < with_edge.count; ++i) {
    const Vec3d& p = with_edge.points[i];
    const Vec3d& q = with_edge.points[(i + 1) % with_edge.count];
    for (std::size_t k = 0; k < with_corner.count; ++k) {
      const auto half_space = separating(front, back, p, q, with_corner.points[k]);
      if (!half_space) continue;
      viewpoints.cut(*half_space);
      if (viewpoints.empty()) return;
    }
  }
}

// In front of a face by more than its edge-on angle, seen from the solid.
HalfSpace clearly_in_front(const SolidFace& face, const ViewSolid& solid) {
  return {face.front.normal - solid.axis * face.edge_on, face.front.offset};
}

}  // namespace

void find_hiding_viewpoints(const ViewSolid& solid, const SolidFace& front, const SolidFace& back,
                            ViewPolytope& viewpoints) {
  viewpoints.clear();
  const FacePart hiding = part_in_front(front.corners, distances_from(back.front, front.corners, 1));
  if (hiding.count == 0) return;
  const FacePart hidden = part_in_front(back.corners, distances_from(front.front, back.corners, -1));
  if (hidden.count == 0) return;

  viewpoints.copy(solid.frustum);
  viewpoints.cut(clearly_in_front(front, solid));
  viewpoints.cut(clearly_in_front(back, solid));
  if (!viewpoints.empty()) cut_by_tangents(viewpoints, hiding, hidden, true);
  if (!viewpoints.empty()) cut_by_tangents(viewpoints, hiding, hidden, false);
}

}  // namespace pellucid
