#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "../interface/fragment_input.glsl"
// First pass of stochastic transparency: a fragment hides as large a share of its pixel's kK samples (A) as its opacity
// says, chosen at random; the nearest fragment of each sample stays. Enderton, Sintorn, Shirley, Luebke, I3D 2010. The
// numbers are those of the sample of the whole picture and the fragment's id: the same in every frame.
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
  random_state = mixed(fragment_id()) ^ sample_in_picture(uvec2(gl_FragCoord.xy));
  const uint depth = floatBitsToUint(gl_FragCoord.z);
  const float samples = float(kK) * unpack_color(fragment_color()).a;
  // So many of those that are left, each as likely as the others.
  uint wanted = uint(samples + next_random());
  for (uint i = 0u; i < kK && wanted > 0u; ++i) {
    if (next_random() * float(kK - i) >= float(wanted)) continue;
    --wanted;
    if (depth < sample_depths[kK * pixel + i]) atomicMin(sample_depths[kK * pixel + i], depth);
  }
}
