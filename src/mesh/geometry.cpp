// Bounding sphere and normals: see pellucid/mesh.h. All in double precision: squares of the largest floats
// (1e38) and of the smallest (1e-45) stay finite and non-zero there.
#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/mesh_predicates.h"
#include "pellucid/mesh.h"

namespace pellucid {
namespace {

// Which finite positions some triangle uses.
std::vector<char> used_finite_vertices(const Mesh& mesh) {
  std::vector<char> used(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      if (v < used.size() && is_finite(mesh.positions[v])) used[v] = 1;
    }
  }
  return used;
}

}  // namespace

BoundingSphere bounding_sphere(const Mesh& mesh) {
  const std::vector<char> used = used_finite_vertices(mesh);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3d low{kInfinity, kInfinity, kInfinity};
  Vec3d high = -low;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] == 0) continue;
    const Vec3d p = to_double(mesh.positions[v]);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  if (low.x > high.x) return {};

  BoundingSphere sphere;
  sphere.center = (low + high) * 0.5;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] != 0) {
      sphere.radius = std::max(sphere.radius, length(to_double(mesh.positions[v]) - sphere.center));
    }
  }
  return sphere;
}

Vec3d triangle_normal(const Mesh& mesh, std::uint32_t triangle) {
  const Vec3d area = twice_area_vector(mesh, mesh.triangles[triangle]);
  const double size = length(area);
  return size > 0 && std::isfinite(size) ? area / size : Vec3d{};
}

std::vector<Vec3f> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3d> sums(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    if (!in_range(mesh, t) || !has_finite_corners(mesh, t)) continue;
    const Vec3d area = twice_area_vector(mesh, t);
    for (const std::uint32_t v : t) sums[v] += area;
  }
  std::vector<Vec3f> normals(sums.size());
  std::transform(sums.begin(), sums.end(), normals.begin(),
                 [](const Vec3d& sum) { return to_float(normalized(sum)); });
  return normals;
}

}  // namespace pellucid
