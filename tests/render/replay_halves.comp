#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#define HALVES
#define ORDER_WORDS  // lavapipe makes a whole workgroup wait at barriers of memory, whoever gets there
#include "capture/k_buffers/slots.glsl"
#include "capture/k_buffers/halves_chain.glsl"
// Stores a list of fragments (C: pixel, depth bits, id, colour) in the slots of their pixels (A), as fragment
// shaders with 32-bit atomics do, but all at the same time. kK is the number of the pass, 0 to 2. push.p0 is
// the number of slots per pixel, p1 is not 0, and p2 is the number of fragments.
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = SLOT_C) readonly buffer List { uvec4 list[]; };
void main() {
  if (gl_GlobalInvocationID.x >= push.p2) return;
  const uvec4 given = list[gl_GlobalInvocationID.x];
  const Place place = place_of(given.x);
  if (kK == 0u) {
    insert_depth(place, given.y);
  } else if (kK == 1u) {
    insert_id(place, given.y, given.z);
  } else {
    const uint slot = slot_of(place, given.y, given.z);
    if (slot < place.first + place.keys) put_color(slot, given.y, given.w);
    else add_to_slot(slot, given.zw);
  }
}
