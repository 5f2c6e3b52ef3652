// Node hierarchies in motion: see skeleton.h.
#include "scene/skeleton.h"

#include "scene/sample_curve.h"

namespace pellucid {
namespace {

Vec3d sample_vector(const AnimationCurve& curve, double time) {
  std::array<double, 3> v{};
  sample_curve(curve, time, v);
  return {v[0], v[1], v[2]};
}

}  // namespace

Skeleton::Skeleton(const std::vector<RigNode>& nodes, const std::vector<std::uint32_t>& used)
    : slots_(nodes.size(), kNoSlot) {
  std::vector<std::uint32_t> ancestors;
  for (const std::uint32_t start : used) {
    ancestors.clear();
    for (std::optional<std::uint32_t> node = start; node && slots_[*node] == kNoSlot;
         node = nodes[*node].parent) {
      ancestors.push_back(*node);
    }
    for (; !ancestors.empty(); ancestors.pop_back()) {
      const RigNode& node = nodes[ancestors.back()];
      slots_[ancestors.back()] = static_cast<std::uint32_t>(bones_.size());
      bones_.push_back({node.parent ? slots_[*node.parent] : kNoSlot, node.rest, to_affine(node.rest)});
    }
  }
}

std::vector<NodeMotion> Skeleton::motions_of(const RigAnimation& animation) const {
  std::vector<NodeMotion> motions;
  std::vector<std::uint32_t> motion_of_slot(bones_.size(), kNoSlot);
  for (const AnimationChannel& channel : animation.channels) {
    const std::uint32_t slot = slots_[channel.node];
    if (slot == kNoSlot || channel.path == AnimatedPath::weights) continue;
    if (motion_of_slot[slot] == kNoSlot) {
      motion_of_slot[slot] = static_cast<std::uint32_t>(motions.size());
      motions.push_back({slot});
    }
    NodeMotion& motion = motions[motion_of_slot[slot]];
    if (channel.path == AnimatedPath::translation) motion.translation = channel.curve;
    if (channel.path == AnimatedPath::rotation) motion.rotation = channel.curve;
    if (channel.path == AnimatedPath::scale) motion.scale = channel.curve;
  }
  return motions;
}

std::vector<Affine> Skeleton::worlds_at(const std::vector<NodeMotion>& motions,
                                        const std::vector<AnimationCurve>& curves, double time) const {
  std::vector<Affine> worlds;
  worlds.reserve(bones_.size());
  for (const Bone& bone : bones_) worlds.push_back(bone.rest_local);
  for (const NodeMotion& motion : motions) {
    NodeTransform local = bones_[motion.slot].rest;
    if (motion.translation != kNoCurve) local.translation = sample_vector(curves[motion.translation], time);
    if (motion.rotation != kNoCurve) local.rotation = sample_rotation(curves[motion.rotation], time);
    if (motion.scale != kNoCurve) local.scale = sample_vector(curves[motion.scale], time);
    worlds[motion.slot] = to_affine(local);
  }
  for (std::size_t slot = 0; slot < bones_.size(); ++slot) {
    if (bones_[slot].parent != kNoSlot) worlds[slot] = worlds[bones_[slot].parent] * worlds[slot];
  }
  return worlds;
}

}  // namespace pellucid
