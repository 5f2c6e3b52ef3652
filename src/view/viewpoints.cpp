// Implements the viewpoints of a cell: the conservative test of whether a plane faces any of them, and random
// viewpoints for measurements.
#include <algorithm>
#include <array>
#include <cmath>

#include "pellucid/view.h"

namespace pellucid {
namespace {

// Added to computed cosines, which are accurate to a few units in the last place of 1, to keep the test
// conservative.
constexpr double kCosineSlack = 4e-15;

// Returns the largest dot(normal, d) over the arc from a to b (unit vectors), which is shorter than half a
// circle.
double max_cosine_on_arc(const Vec3d& a, const Vec3d& b, const Vec3d& normal) {
  const Vec3d axis = normalized(cross(a, b));
  // The nearest point of the great circle is the projection of the normal onto its plane, if it is on the
  // arc.
  const Vec3d projection = normal - axis * dot(axis, normal);
  if (dot(cross(axis, a), projection) >= 0 && dot(cross(b, axis), projection) >= 0) return length(projection);
  return std::max(dot(a, normal), dot(b, normal));
}

double max_cosine_on_triangle(const std::array<Vec3d, 3>& corners, const Vec3d& normal) {
  bool inside = true;
  double largest = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d& a = corners[k];
    const Vec3d& b = corners[(k + 1) % 3];
    inside = inside && dot(cross(a, b), normal) >= 0;
    largest = std::max(largest, max_cosine_on_arc(a, b, normal));
  }
  return inside ? 1 : largest;
}

double max_cosine_on_cap(const Vec3d& direction, double cap_cosine, const Vec3d& normal) {
  const double cosine = std::clamp(dot(direction, normal), -1.0, 1.0);
  if (cosine >= cap_cosine) return 1;
  // This is cos(angle - cap).
  return cosine * cap_cosine + std::sqrt((1 - cosine * cosine) * (1 - cap_cosine * cap_cosine));
}

}  // namespace

double max_cosine(const ViewPartition& partition, std::uint32_t cell, const Vec3d& normal) {
  const double largest =
      has_triangle_cells(partition.spec)
          ? max_cosine_on_triangle(partition.corners[cell], normal)
          : max_cosine_on_cap(partition.samples[cell], partition.cap_cosines[cell], normal);
  return std::min(1.0, largest + kCosineSlack);
}

// The camera is at r * radius * d relative to the centre. It is in front of the plane if r * radius *
// dot(normal, d) > offset. For a given r the left side is largest where dot(normal, d) has its maximum M. It
// grows with r for M > 0 and falls for M < 0, so one end of the range of distances decides. At infinity only
// the sign of M counts.
bool front_visible(const ViewPartition& partition, std::uint32_t cell, const Vec3d& normal, double offset,
                   double radius, double min_distance, double max_distance) {
  const double cosine = max_cosine(partition, cell, normal);
  // Normals are rounded, too, so a plane seen edge-on within this angle counts as visible.
  constexpr double kEdgeOn = 1e-12;
  if (std::isinf(max_distance) && cosine > -kEdgeOn) return true;
  const double distance = cosine > 0 ? max_distance : min_distance;
  if (std::isinf(distance)) return false;
  const double reach = distance * radius * cosine;
  const double slack = kEdgeOn * (distance * radius + std::fabs(offset));
  return !(reach + slack < offset);
}

std::vector<Viewpoint> random_viewpoints(std::uint32_t count, double min_distance, double max_distance,
                                         std::uint64_t seed) {
  const bool fixed = min_distance == max_distance;
  if (!(min_distance > 0 && min_distance <= max_distance) || (std::isinf(max_distance) && !fixed)) {
    throw Error(ErrorKind::bad_argument, "distances of viewpoints from " + std::to_string(min_distance) +
                                             " to " + std::to_string(max_distance) +
                                             " radii: give a positive, finite range, or infinity twice");
  }
  Random random(seed);
  std::vector<Viewpoint> viewpoints(count);
  for (Viewpoint& viewpoint : viewpoints) {
    viewpoint.direction = random.direction();
    viewpoint.distance = fixed ? min_distance : random.uniform(min_distance, max_distance);
  }
  return viewpoints;
}

}  // namespace pellucid
