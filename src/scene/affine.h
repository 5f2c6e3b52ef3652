// Internal to the module `scene`: affine maps in double precision.
#pragma once

#include "pellucid/animation.h"
#include "pellucid/base.h"

namespace pellucid {

// p -> x * p.x + y * p.y + z * p.z + origin
struct Affine {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin;

  [[nodiscard]] Vec3d direction(const Vec3d& d) const { return x * d.x + y * d.y + z * d.z; }
  [[nodiscard]] Vec3d point(const Vec3d& p) const { return direction(p) + origin; }
  [[nodiscard]] bool mirrors() const { return dot(cross(x, y), z) < 0; }
};

// a after b
inline Affine operator*(const Affine& a, const Affine& b) {
  return {a.direction(b.x), a.direction(b.y), a.direction(b.z), a.point(b.origin)};
}

inline Affine to_affine(const Mat4& matrix) {
  const auto& m = matrix.m;
  return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
}

// Quaternions are taken as they are, as the readers of Instance::world do.
inline Affine to_affine(const NodeTransform& node) {
  if (node.matrix) return to_affine(*node.matrix);
  const auto [x, y, z, w] = node.rotation;
  return {Vec3d{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)} * node.scale.x,
          Vec3d{2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)} * node.scale.y,
          Vec3d{2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)} * node.scale.z,
          node.translation};
}

}  // namespace pellucid
