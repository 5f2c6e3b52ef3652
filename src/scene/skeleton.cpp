// Implements skeleton.h: node hierarchies in motion, and the curves that move them. Slerp follows Shoemake,
// "Animating rotation with quaternion curves", SIGGRAPH 1985.
#include "scene/skeleton.h"

#include <algorithm>
#include <cmath>

namespace pellucid {
namespace {

// Below this angle, the sine in the denominator loses digits, and chord and arc are practically equal.
constexpr double kSmallAngle = 1e-4;

using Quaternion = std::array<double, 4>;

// A time between the keys `key` and `next`, at `fraction` of the way. Outside of the curve, key equals next.
struct CurveSpan {
  std::size_t key = 0, next = 0;
  double fraction = 0;
  double seconds = 0;  // from key to next
};

CurveSpan find_span(const AnimationCurve& curve, double time) {
  const auto& times = curve.times;
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return {};
  const auto key = static_cast<std::size_t>(after - times.begin()) - 1;
  if (after == times.end()) return {key, key, 0, 0};
  const double start = times[key];
  const double seconds = *after - start;
  return {key, key + 1, (time - start) / seconds, seconds};
}

// A key of a cubic spline has three values in place of one: in-tangent, value, out-tangent.
enum Column : std::size_t { in_tangent = 0, value_column = 1, out_tangent = 2 };

std::span<const float> numbers(const AnimationCurve& curve, std::size_t key, Column column) {
  const std::size_t width = curve.width;
  const bool cubic = curve.interpolation == Interpolation::cubic_spline;
  return std::span(curve.values).subspan(cubic ? (3 * key + column) * width : key * width, width);
}

void sample_cubic(const AnimationCurve& curve, const CurveSpan& at, std::span<double> value) {
  const double t = at.fraction, t2 = t * t, t3 = t2 * t;
  const auto v0 = numbers(curve, at.key, value_column), v1 = numbers(curve, at.next, value_column);
  const auto b0 = numbers(curve, at.key, out_tangent), a1 = numbers(curve, at.next, in_tangent);
  for (std::size_t i = 0; i < value.size(); ++i) {
    value[i] = (2 * t3 - 3 * t2 + 1) * v0[i] + at.seconds * (t3 - 2 * t2 + t) * b0[i] +
               (3 * t2 - 2 * t3) * v1[i] + at.seconds * (t3 - t2) * a1[i];
  }
}

double dot_product(const Quaternion& a, const Quaternion& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

// Returns the quaternion scaled to length 1, or the identity if its length is 0.
Quaternion unit(const Quaternion& q) {
  const double norm = std::sqrt(dot_product(q, q));
  if (!(norm > 0)) return {0, 0, 0, 1};
  return {q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm};
}

Quaternion slerp(const Quaternion& a, const Quaternion& b, double t) {
  const double cosine = dot_product(a, b);
  const double angle = std::acos(std::min(std::abs(cosine), 1.0));
  double weight_a = 1 - t, weight_b = t;
  if (angle > kSmallAngle) {
    weight_a = std::sin((1 - t) * angle) / std::sin(angle);
    weight_b = std::sin(t * angle) / std::sin(angle);
  }
  // q and -q are the same rotation. The nearer one is used.
  if (cosine < 0) weight_b = -weight_b;
  Quaternion q;
  for (std::size_t i = 0; i < 4; ++i) q[i] = weight_a * a[i] + weight_b * b[i];
  return unit(q);
}

Quaternion rotation_of_key(const AnimationCurve& curve, std::size_t key) {
  Quaternion q;
  std::ranges::copy(numbers(curve, key, value_column), q.begin());
  return unit(q);
}

}  // namespace

void sample_curve(const AnimationCurve& curve, double time, std::span<double> value) {
  const CurveSpan at = find_span(curve, time);
  if (curve.interpolation == Interpolation::cubic_spline) return sample_cubic(curve, at, value);
  const auto from = numbers(curve, at.key, value_column), to = numbers(curve, at.next, value_column);
  const double t = curve.interpolation == Interpolation::step ? 0 : at.fraction;
  for (std::size_t i = 0; i < value.size(); ++i) value[i] = (1 - t) * from[i] + t * to[i];
}

std::array<double, 4> sample_rotation(const AnimationCurve& curve, double time) {
  if (curve.interpolation != Interpolation::linear) {
    Quaternion q{};
    sample_curve(curve, time, q);
    return unit(q);
  }
  const CurveSpan at = find_span(curve, time);
  return slerp(rotation_of_key(curve, at.key), rotation_of_key(curve, at.next), at.fraction);
}

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
