#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "../interface/fragment_input.glsl"
#include "optical_depth.glsl"
// Second pass of stochastic transparency: a fragment gets light through the samples (A) that hide nothing in front of it.
// Transmittance of all is summed up as it is (the paper's alpha correction).
layout(std430, set = 0, binding = SLOT_A) readonly buffer SampleDepths { uint sample_depths[]; };
layout(location = 0) out vec4 sums;
layout(location = 1) out float depth_sum;
const float kMostDepth = 32.0;

void main() {
  const uint first = kK * fragment_pixel();
  const uint depth = floatBitsToUint(gl_FragCoord.z);
  uint open = 0u;
  for (uint i = 0u; i < kK; ++i) open += depth <= sample_depths[first + i] ? 1u : 0u;
  const vec4 c = unpack_color(fragment_color());
  sums = vec4(c.rgb, 1.0) * (c.a * float(open) / float(kK));
  depth_sum = optical_depth(c.a, kMostDepth);
}
