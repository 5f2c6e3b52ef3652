#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "capture/keys.glsl"
// Clears the kK slots (A) of every pixel. Every second slot is for a maximum.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_A) writeonly buffer Keys { uint64_t keys[]; };
void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, frame.size))) return;
  const uint first = kK * pixel_index(gl_GlobalInvocationID.xy);
  for (uint i = 0u; i < kK; ++i) keys[first + i] = i % 2u == 1u ? uint64_t(0) : kNoKey;
}
