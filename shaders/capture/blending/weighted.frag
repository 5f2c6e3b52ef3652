#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "capture/blending/optical_depth.glsl"
// Weighted blended transparency: colours are summed up, the nearer the heavier (fold_sums.comp divides by the weights).
// McGuire, Bavoil, "Weighted Blended Order-Independent Transparency", JCGT 2013: equation 6 with the weight of equation 10,
// which goes by depth between the near and the far plane.
layout(location = 0) out vec4 sums;  // colours and opacity, weighted
layout(location = 1) out float depth_sum;
const float kMostDepth = 32.0;
const float kLeastWeight = 1e-2;
const float kMostWeight = 3e3;
// Only ratios of weights matter: half floats hold the sums of 256 fragments of the largest weight, and of colours up to 2.
const float kScale = 65504.0 / (256.0 * 2.0 * kMostWeight);

void main() {
  const vec4 c = unpack_color(fragment_color());
  const float near = 1.0 - gl_FragCoord.z;
  const float weight = c.a * clamp(kMostWeight * near * near * near, kLeastWeight, kMostWeight);
  sums = vec4(c.rgb, 1.0) * (c.a * weight * kScale);
  depth_sum = optical_depth(c.a, kMostDepth);
}
