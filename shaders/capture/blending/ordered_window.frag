#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
// The ordered k-buffer. Fragments come nearly front to back and pass through a sorted window of the kK
// farthest fragments so far. The fragment that leaves the window, its nearest, is blended under those that
// left before.
#include "capture/ordered_words.glsl"
#include "capture/insert_fragment.glsl"
#include "capture/blending/ordered_window.glsl"

vec4 blended_before() {
  if (words[kFarthestWord + 1u] == kNone) return kNothingBlended;
  return uintBitsToFloat(uvec4(words[kBlendedWord], words[kBlendedWord + 1u], words[kBlendedWord + 2u],
                               words[kBlendedWord + 3u]));
}

void put_blended(vec4 blended) {
  const uvec4 bits = floatBitsToUint(blended);
  for (uint i = 0u; i < 4u; ++i) words[kBlendedWord + i] = bits[i];
}

void blend(uvec3 nearest) {
  put_blended(blended_under(blended_before(), nearest.z));
  const uvec3 farthest = uvec3(words[kFarthestWord], words[kFarthestWord + 1u], 0u);
  const bool is_late = is_before(farthest, nearest);  // keys are complemented
  if (is_late) {
    words[kLateWord] = 0u;
  } else {
    words[kFarthestWord] = nearest.x;
    words[kFarthestWord + 1u] = nearest.y;
  }
}

void main() {
  EACH(LOAD)
  const uvec3 nearest = insert_fragment(uvec3(~floatBitsToUint(gl_FragCoord.z), ~fragment_id(), fragment_color()));
  if (!is_free(nearest)) blend(nearest);
  EACH(STORE)
}
