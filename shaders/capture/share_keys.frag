#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "../interface/fragment_input.glsl"
#include "../interface/keys.glsl"
#include "shares.glsl"
// The nearest fragments of every pixel behind the last key of its round before (B), as many as its share of the pool
// has places (A). In pixels that are done nothing is behind it.
layout(std430, set = 0, binding = SLOT_A) buffer Keys { uint64_t keys[]; };
layout(std430, set = 0, binding = SLOT_B) readonly buffer Last { uint64_t last[]; };
#include "insert_key.glsl"
void main() {
  const uint pixel = fragment_pixel();
  const uint64_t key = make_key(gl_FragCoord.z, fragment_id());
  if (push.round > 0u && key <= (last[pixel] & kKeyBits)) return;
  const Share share = share_of(pixel);
  if (share.in_window && share.count > 0u) insert_key(share.first, share.count, key);
}
