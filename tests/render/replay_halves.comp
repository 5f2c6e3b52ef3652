#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#define HALVES
#define ORDER_WORDS  // lavapipe makes a whole workgroup wait at barriers of memory, whoever gets there
#include "capture/k_buffers/slots.glsl"
#include "capture/k_buffers/halves_chain.glsl"
// Brings a list of fragments (C: pixel, depth bits, id, colour) into the slots of their pixels (A) as fragment shaders do
// that have only 32-bit atomics, but all at the same time; kK: which of the three passes. push.p0: slots of a pixel; p1:
// not 0; p2: fragments.
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
