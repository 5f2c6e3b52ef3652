// Internal to the module `scene`: the nodes of a rig that move geometry, and their places at a time.
#pragma once

#include "pellucid/animation.h"
#include "scene/affine.h"

namespace pellucid {

// The curves that an animation moves a node by; kNoCurve: as at rest.
constexpr std::uint32_t kNoCurve = ~0U;
struct NodeMotion {
  std::uint32_t slot = 0;
  std::uint32_t translation = kNoCurve, rotation = kNoCurve, scale = kNoCurve;
};

class Skeleton {
 public:
  // Of the nodes in `used` and all their ancestors.
  Skeleton(const std::vector<RigNode>& nodes, const std::vector<std::uint32_t>& used);

  // Where the world matrix of a node in `used` is.
  [[nodiscard]] std::uint32_t slot_of(std::uint32_t node) const { return slots_[node]; }
  [[nodiscard]] bool moves(std::uint32_t node) const { return slots_[node] != kNoSlot; }

  // The curves of an animation that move these nodes.
  [[nodiscard]] std::vector<NodeMotion> motions_of(const RigAnimation& animation) const;
  // World matrices of all slots.
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
