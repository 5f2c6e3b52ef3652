#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "counters.glsl"
#include "capture/k_buffers/places.glsl"
layout(std430, set = 0, binding = SLOT_A) coherent buffer Pool { uint words[]; };
#define ORDER_WORDS  // lavapipe makes a whole workgroup wait at barriers of memory, whoever gets there
#include "capture/k_buffers/max_first.glsl"
// Brings a list of fragments (C: pixel, depth bits, id) into the slots of their pixels (A) behind a spin lock, as fragment
// shaders do, but all at the same time. push.p0: slots of a pixel; p1: not 0; p2: turns; p3: fragments.
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = SLOT_C) readonly buffer List { uvec4 list[]; };
void main() {
  if (gl_GlobalInvocationID.x >= push.p3) return;
  const uvec4 given = list[gl_GlobalInvocationID.x];
  insert_in_turn(place_of(given.x), given.yz);
}
