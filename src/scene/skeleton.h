// Internal to the module `scene`: computes where the nodes of a rig are at a time of an animation.
//
// In: nodes, curves and channels (pellucid/animation.h). Out: world matrices in double precision, and the
// values of curves. Format: glTF 2.0, sections 3.5 and 3.11, appendix C.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pellucid/animation.h"
#include "pellucid/base.h"

namespace pellucid {

// The affine map p -> x * p.x + y * p.y + z * p.z + origin.
struct Affine {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin;

  [[nodiscard]] Vec3d direction(const Vec3d& d) const { return x * d.x + y * d.y + z * d.z; }
  [[nodiscard]] Vec3d point(const Vec3d& p) const { return direction(p) + origin; }
  [[nodiscard]] bool mirrors() const { return dot(cross(x, y), z) < 0; }
};

// Returns the map that applies b, then a.
inline Affine operator*(const Affine& a, const Affine& b) {
  return {a.direction(b.x), a.direction(b.y), a.direction(b.z), a.point(b.origin)};
}

inline Affine to_affine(const Mat4& matrix) {
  const auto& m = matrix.m;
  return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
}

// Converts a transform. Quaternions are used as they are, as by the readers of Instance::world.
inline Affine to_affine(const NodeTransform& node) {
  if (node.matrix) return to_affine(*node.matrix);
  const auto [x, y, z, w] = node.rotation;
  return {Vec3d{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)} * node.scale.x,
          Vec3d{2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)} * node.scale.y,
          Vec3d{2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)} * node.scale.z,
          node.translation};
}

// Writes the value of `curve` at `time` (seconds) to `value`, where value.size() == curve.width. Times
// outside the curve are clamped.
void sample_curve(const AnimationCurve& curve, double time, std::span<double> value);

// Returns the value of a curve of rotations: a unit quaternion. Linear rotations are interpolated on the
// sphere.
std::array<double, 4> sample_rotation(const AnimationCurve& curve, double time);

// The curves that move a node in an animation. kNoCurve means the value at rest.
constexpr std::uint32_t kNoCurve = ~0U;
struct NodeMotion {
  std::uint32_t slot = 0;
  std::uint32_t translation = kNoCurve, rotation = kNoCurve, scale = kNoCurve;
};

class Skeleton {
 public:
  // Keeps the nodes in `used` and all their ancestors.
  Skeleton(const std::vector<RigNode>& nodes, const std::vector<std::uint32_t>& used);

  // Returns the index of the world matrix of a node in `used`.
  [[nodiscard]] std::uint32_t slot_of(std::uint32_t node) const { return slots_[node]; }
  [[nodiscard]] bool moves(std::uint32_t node) const { return slots_[node] != kNoSlot; }

  // Returns the curves of an animation that move these nodes.
  [[nodiscard]] std::vector<NodeMotion> motions_of(const RigAnimation& animation) const;
  // Returns the world matrices of all slots at a time (seconds).
  [[nodiscard]] std::vector<Affine> worlds_at(const std::vector<NodeMotion>& motions,
                                              const std::vector<AnimationCurve>& curves, double time) const;

 private:
  static constexpr std::uint32_t kNoSlot = ~0U;
  struct Bone {
    std::uint32_t parent = kNoSlot;  // a smaller slot
    NodeTransform rest;
    Affine rest_local;
  };

  std::vector<std::uint32_t> slots_;  // of every node
  std::vector<Bone> bones_;           // parents first
};

}  // namespace pellucid
