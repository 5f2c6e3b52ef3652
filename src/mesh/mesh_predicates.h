// Internal to the module `mesh`: questions about single triangles.
#pragma once

#include <algorithm>
#include <cmath>

#include "pellucid/mesh.h"

namespace pellucid {

inline bool is_finite(const Vec3f& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

inline bool in_range(const Mesh& mesh, const Triangle& t) {
  return std::max({t[0], t[1], t[2]}) < mesh.positions.size();
}

inline bool has_finite_corners(const Mesh& mesh, const Triangle& t) {
  return is_finite(mesh.positions[t[0]]) && is_finite(mesh.positions[t[1]]) &&
         is_finite(mesh.positions[t[2]]);
}

// Normal direction, as long as twice the area.
inline Vec3d twice_area_vector(const Mesh& mesh, const Triangle& t) {
  const Vec3d a = to_double(mesh.positions[t[0]]);
  return cross(to_double(mesh.positions[t[1]]) - a, to_double(mesh.positions[t[2]]) - a);
}

}  // namespace pellucid
