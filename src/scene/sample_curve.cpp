// Interpolation between key frames: see sample_curve.h. Formulas: glTF 2.0, appendix C; slerp after Shoemake,
// "Animating rotation with quaternion curves", SIGGRAPH 1985.
#include "scene/sample_curve.h"

#include <algorithm>
#include <cmath>

namespace pellucid {
namespace {

// Below this angle sin() in the denominator loses digits, and chord and arc are the same.
constexpr double kSmallAngle = 1e-4;

using Quaternion = std::array<double, 4>;

// Between keys `key` and `next`, `fraction` of the way; key == next outside of the curve.
struct Moment {
  std::size_t key = 0, next = 0;
  double fraction = 0;
  double seconds = 0;  // from key to next
};

Moment find_moment(const AnimationCurve& curve, double time) {
  const auto& times = curve.times;
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return {};
  const auto key = static_cast<std::size_t>(after - times.begin()) - 1;
  if (after == times.end()) return {key, key, 0, 0};
  const double start = times[key];
  const double seconds = *after - start;
  return {key, key + 1, (time - start) / seconds, seconds};
}

// Cubic splines hold three numbers in the place of one: in-tangents, values, out-tangents of a key.
enum Column : std::size_t { in_tangent = 0, value_column = 1, out_tangent = 2 };

std::span<const float> numbers(const AnimationCurve& curve, std::size_t key, Column column) {
  const std::size_t width = curve.width;
  const bool cubic = curve.interpolation == Interpolation::cubic_spline;
  return std::span(curve.values).subspan(cubic ? (3 * key + column) * width : key * width, width);
}

void sample_cubic(const AnimationCurve& curve, const Moment& at, std::span<double> value) {
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

// No rotation where there is no direction to tell one.
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
  // q and -q are the same rotation: take the nearer.
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
  const Moment at = find_moment(curve, time);
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
  const Moment at = find_moment(curve, time);
  return slerp(rotation_of_key(curve, at.key), rotation_of_key(curve, at.next), at.fraction);
}

}  // namespace pellucid
