#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "../interface/fragment_input.glsl"
#include "../interface/keys.glsl"
// The kK nearest fragments behind the last key of the round before. A: kK keys a pixel, increasing; B: the last key.
// A chain of 64-bit minima: what a slot gives up goes on to the next one, so the result is the same for any sequence
// of fragments, without a lock.
layout(std430, set = 0, binding = SLOT_A) buffer Keys { uint64_t keys[]; };
layout(std430, set = 0, binding = SLOT_B) readonly buffer Last { uint64_t last[]; };
void main() {
  const uint pixel = fragment_pixel();
  uint64_t key = make_key(gl_FragCoord.z, fragment_id());
  if (push.round > 0u && key <= (last[pixel] & kKeyBits)) return;
  const uint first = kK * pixel;
  if (key >= keys[first + kK - 1u]) return;
  for (uint i = 0u; i < kK && key != kNoKey; ++i) key = max(key, atomicMin(keys[first + i], key));
}
