#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "counters.glsl"
#include "capture/k_buffers/places.glsl"
layout(std430, set = 0, binding = SLOT_A) coherent buffer Pool { uint words[]; };
#define ORDER_WORDS  // lavapipe makes a whole workgroup wait at barriers of memory, whoever gets there
#include "capture/k_buffers/max_first.glsl"
// Stores a list of fragments (C: pixel, depth bits, id) in the slots of their pixels (A) with a spin lock, as
// fragment shaders do, but all at the same time. push.p0 is the number of slots per pixel, p1 is not 0, p2 is
// the number of turns, and p3 is the number of fragments.
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = SLOT_C) readonly buffer List { uvec4 list[]; };
void main() {
  if (gl_GlobalInvocationID.x >= push.p3) return;
  const uvec4 given = list[gl_GlobalInvocationID.x];
  insert_in_turn(place_of(given.x), given.yz);
}
