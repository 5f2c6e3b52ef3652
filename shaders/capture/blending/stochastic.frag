#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#if defined(DEPTHS)
// First pass of stochastic transparency: a fragment covers a random share of the kK samples of its pixel (A)
// that equals its opacity. Each sample keeps its nearest fragment. The random numbers depend only on the
// sample in the whole image and on the id of the fragment, so they are the same in every frame. Based on:
// Enderton, Sintorn, Shirley, Luebke, I3D 2010.
layout(std430, set = 0, binding = SLOT_A) buffer SampleDepths { uint sample_depths[]; };

uint mixed(uint x) {
  x ^= x >> 16;
  x *= 0x7FEB352Du;
  x ^= x >> 15;
  x *= 0x846CA68Bu;
  return x ^ x >> 16;
}
uint random_state;
float next_random() {
  random_state = mixed(random_state + 0x9E3779B9u);
  return float(random_state >> 8) / 16777216.0;
}

void main() {
  const uint pixel = fragment_pixel();
  random_state = mixed(fragment_id()) ^ sample_in_image(uvec2(gl_FragCoord.xy));
  const uint depth = floatBitsToUint(gl_FragCoord.z);
  const float samples = float(kK) * unpack_color(fragment_color()).a;
  // Choose `wanted` of the samples that are left, each with the same probability.
  uint wanted = uint(samples + next_random());
  for (uint i = 0u; i < kK && wanted > 0u; ++i) {
    if (next_random() * float(kK - i) >= float(wanted)) continue;
    --wanted;
    if (depth < sample_depths[kK * pixel + i]) atomicMin(sample_depths[kK * pixel + i], depth);
  }
}
#endif

#if defined(COLORS)
#include "capture/blending/optical_depth.glsl"
// Second pass of stochastic transparency: a fragment gets light through the samples (A) in which nothing
// hides it. The transmittance of all fragments is summed up exactly (the alpha correction of the paper).
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
#endif
