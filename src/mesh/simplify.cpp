// Simplifies a mesh: see pellucid/mesh.h. The quadric edge collapse is that of meshoptimizer, after Garland
// and Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997.
//
// It is a file of its own so that programs that do not simplify link without meshoptimizer.
#include <meshoptimizer.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "pellucid/mesh.h"

namespace pellucid {
namespace {

constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
constexpr float kAnyError = std::numeric_limits<float>::max();

// Returns the positions scaled to the unit ball, because meshoptimizer computes in float32, in which the
// squares of 1e38 and 1e-38 overflow and underflow.
std::vector<Vec3f> unit_positions(const Mesh& mesh) {
  const BoundingSphere sphere = bounding_sphere(mesh);
  const double radius = sphere.radius > 0 ? sphere.radius : 1.0;
  std::vector<Vec3f> result(mesh.positions.size());
  std::transform(mesh.positions.begin(), mesh.positions.end(), result.begin(), [&](const Vec3f& p) {
    const Vec3d unit = (to_double(p) - sphere.center) / radius;
    // Unreferenced vertices may be far away or not finite.
    return dot(unit, unit) < 4.0 ? to_float(unit) : Vec3f{};
  });
  return result;
}

std::vector<std::uint32_t> welded_indices(const Mesh& mesh) {
  const std::vector<std::uint32_t> weld = weld_by_position(mesh.positions);
  std::vector<std::uint32_t> indices;
  indices.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) indices.push_back(weld[v]);
  }
  return indices;
}

// Collapses edges until `target` indices are left. Repeats the collapse that preserves topology while it
// makes progress. If topology stops it above the target, as in a cloud of small parts, uses the one that
// ignores topology.
std::vector<std::uint32_t> collapse(std::vector<std::uint32_t> indices, const std::vector<Vec3f>& positions,
                                    std::size_t target) {
  std::size_t before = indices.size() + 1;
  while (indices.size() > target && indices.size() < before) {
    before = indices.size();
    std::vector<std::uint32_t> fewer(indices.size());
    fewer.resize(meshopt_simplify(fewer.data(), indices.data(), indices.size(), &positions[0].x,
                                  positions.size(), sizeof(Vec3f), target, kAnyError, 0, nullptr));
    indices = std::move(fewer);
  }
  if (indices.size() <= target) return indices;
  std::vector<std::uint32_t> fewer(indices.size());
  fewer.resize(meshopt_simplifySloppy(fewer.data(), indices.data(), indices.size(), &positions[0].x,
                                      positions.size(), sizeof(Vec3f), target, kAnyError, nullptr));
  return fewer;
}

// Returns the triangles of `indices` with only the positions that they use, numbered by first use.
Mesh compacted(const std::vector<std::uint32_t>& indices, const std::vector<Vec3f>& positions) {
  Mesh result;
  std::vector<std::uint32_t> new_index(positions.size(), kUnused);
  result.triangles.resize(indices.size() / 3);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    std::uint32_t& v = new_index[indices[i]];
    if (v == kUnused) {
      v = static_cast<std::uint32_t>(result.positions.size());
      result.positions.push_back(positions[indices[i]]);
    }
    result.triangles[i / 3][i % 3] = v;
  }
  return result;
}

}  // namespace

Mesh simplify(const Mesh& mesh, std::uint32_t target_triangles) {
  const Mesh valid = clean(mesh, {}, "simplify").mesh;
  std::vector<std::uint32_t> indices = welded_indices(valid);
  if (valid.triangles.size() > target_triangles) {
    indices = collapse(std::move(indices), unit_positions(valid), 3 * std::size_t{target_triangles});
  }
  Mesh result = compacted(indices, valid.positions);
  if (!mesh.normals.empty()) result.normals = vertex_normals(result);
  return result;
}

}  // namespace pellucid
