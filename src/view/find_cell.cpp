// From a direction to its view cell: by the descent of pellucid/runtime/select.h, and by trying every cell.
#include <algorithm>

#include "pellucid/runtime/select.h"
#include "pellucid/view.h"

namespace pellucid {
namespace {

bool triangle_contains(const std::array<Vec3d, 3>& corners, const Vec3d& direction) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d inward = normalized(cross(corners[k], corners[(k + 1) % 3]));
    if (dot(inward, direction) < -PELLUCID_BORDER) return false;
  }
  return true;
}

std::uint32_t nearest_sample(const ViewPartition& partition, const Vec3d& direction) {
  std::uint32_t best = 0;
  for (std::uint32_t c = 1; c < partition.samples.size(); ++c) {
    if (dot(partition.samples[c], direction) > dot(partition.samples[best], direction)) best = c;
  }
  return best;
}

}  // namespace

std::uint32_t find_cell(const ViewPartition& partition, const Vec3d& direction) {
  const std::array<double, 3> d{direction.x, direction.y, direction.z};
  if (has_triangle_cells(partition.spec)) {
    return pellucid_find_triangle(partition.spec.level, d.data());
  }
  return partition.corner_cells[pellucid_find_corner(partition.spec.level, d.data())];
}

std::uint32_t find_cell_brute_force(const ViewPartition& partition, const Vec3d& direction) {
  const Vec3d unit = normalized(direction);
  if (!has_triangle_cells(partition.spec)) return nearest_sample(partition, unit);
  for (std::uint32_t c = 0; c < partition.corners.size(); ++c) {
    if (triangle_contains(partition.corners[c], unit)) return c;
  }
  return 0;
}

}  // namespace pellucid
