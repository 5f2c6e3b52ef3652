// Internal to the module `scene`: the value of an animation curve at a time.
#pragma once

#include <span>

#include "pellucid/animation.h"

namespace pellucid {

// value.size() == curve.width. Times outside of the curve's are clamped.
void sample_curve(const AnimationCurve& curve, double time, std::span<double> value);

// Likewise for rotations: unit quaternions, linear ones interpolated on the sphere.
std::array<double, 4> sample_rotation(const AnimationCurve& curve, double time);

}  // namespace pellucid
