// Makes meshes, and has helpers that the tests of several modules use.
#pragma once

#include <cstdint>
#include <limits>

#include "pellucid/mesh.h"
#include "pellucid/view.h"

namespace pellucid::testing {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Appends the positions and triangles of a mesh to another one.
inline void append(Mesh& mesh, const Mesh& part) {
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  for (const Triangle& t : part.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

// Returns unconnected triangles whose middles are uniform in [-extent, extent]^3. Their corners are at most
// `size` from the middle along each axis.
inline Mesh random_soup(std::size_t triangles, double size, std::uint64_t seed, double extent = 1) {
  Random random(seed);
  const auto offset = [&](double most) {
    return Vec3d{random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most)};
  };
  Mesh mesh;
  for (std::size_t i = 0; i < triangles; ++i) {
    const auto corner = static_cast<std::uint32_t>(mesh.positions.size());
    const Vec3d middle = offset(extent);
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(to_float(middle + offset(size)));
    mesh.triangles.push_back({corner, corner + 1, corner + 2});
  }
  return mesh;
}

// Returns an icosphere as a mesh that faces outwards.
inline Mesh icosphere_mesh(std::uint32_t level, double radius = 1, const Vec3d& center = {}) {
  const Icosphere sphere = make_icosphere(level);
  Mesh mesh;
  for (const Vec3d& v : sphere.vertices) mesh.positions.push_back(to_float(center + v * radius));
  for (const auto& t : sphere.triangles) mesh.triangles.push_back(t);
  return mesh;
}

// Returns the volume of a closed mesh that faces outwards.
inline double volume(const Mesh& mesh) {
  double six_volumes = 0;
  for (const Triangle& t : mesh.triangles) {
    six_volumes += dot(to_double(mesh.positions[t[0]]),
                       cross(to_double(mesh.positions[t[1]]), to_double(mesh.positions[t[2]])));
  }
  return six_volumes / 6;
}

// Four corners at the origin and on the axes, closed.
inline Mesh tetrahedron() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return mesh;
}

}  // namespace pellucid::testing
