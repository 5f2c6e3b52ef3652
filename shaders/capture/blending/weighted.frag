#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "capture/blending/optical_depth.glsl"
// Weighted blended transparency: sums up colours with weights that are larger for nearer fragments.
// fold_sums.comp divides by the weights. Based on: McGuire, Bavoil, "Weighted Blended Order-Independent
// Transparency", JCGT 2013, equation 6 with the weight of equation 10, which uses the depth between the near
// and far planes.
layout(location = 0) out vec4 sums;  // colours and opacity, weighted
layout(location = 1) out float depth_sum;
const float kMostDepth = 32.0;
const float kLeastWeight = 1e-2;
const float kMostWeight = 3e3;
// Only ratios of weights matter. This scale lets half floats hold the sums of 256 fragments with the largest
// weight, and of colours up to 2.
const float kScale = 65504.0 / (256.0 * 2.0 * kMostWeight);

void main() {
  const vec4 c = unpack_color(fragment_color());
  const float near = 1.0 - gl_FragCoord.z;
  const float weight = c.a * clamp(kMostWeight * near * near * near, kLeastWeight, kMostWeight);
  sums = vec4(c.rgb, 1.0) * (c.a * weight * kScale);
  depth_sum = optical_depth(c.a, kMostDepth);
}
