#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "capture/ordered_words.glsl"
#include "capture/insert_fragment.glsl"
#include "capture/k_buffers/core_layers.glsl"
// Keeps the kK nearest fragments, and adds what falls out of them to the tail, in one pass.

void add_to_tail(uvec3 lost) {
  const vec4 depths = tail_share(lost.z);
  const float rounding = tail_rounding(fragment_pixel(), lost.y);
  const uvec4 units = tail_units(kByOpacity ? opacity_share(lost.z) : depths, sum_scale(), rounding);
  for (uint i = 0u; i < 4u; ++i) words[kTailWord + i] += units[i];
  if (kByOpacity) words[kTailWord + 4u] += tail_units(depths, sum_scale(), rounding).w;
}

void main() {
  EACH(LOAD)
  const uvec3 lost = insert_fragment(uvec3(floatBitsToUint(gl_FragCoord.z), fragment_id(), fragment_color()));
  if (lost.y != kNone) add_to_tail(lost);
  EACH(STORE)
}
