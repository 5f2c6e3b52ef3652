#version 460
#extension GL_GOOGLE_include_directive : require
#ifdef INTERLOCK
#extension GL_ARB_fragment_shader_interlock : require
#endif
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "counters.glsl"
#include "capture/k_buffers/places.glsl"
// Keeps the nearest fragments of a pixel, as many as it has slots for. The first slot holds the farthest of
// them; the others are in no particular order. A new fragment must be nearer than the first slot, and then
// replaces it. Most fragments are not nearer and are rejected at once. The fragments of a pixel run one at a
// time, by fragment shader interlock (INTERLOCK) or a spin lock. A pixel with kK slots or more has a heap.
// Based on: Vasilakis, Papaioannou, Fudos, "k+-buffer: An Efficient, Memory-Friendly and Dynamic k-buffer
// Framework", TVCG 2015.
layout(std430, set = 0, binding = SLOT_A) coherent buffer Pool { uint words[]; };
#include "capture/k_buffers/max_first.glsl"
#ifdef INTERLOCK
layout(pixel_interlock_unordered) in;
#endif

void main() {
  // Helper invocations, which the triangle does not cover, must leave: their atomics do nothing, so they
  // would wait for the lock forever.
  if (gl_SampleMaskIn[0] == 0) discard;
  const Place place = place_of(fragment_pixel());
  const uvec2 key = uvec2(floatBitsToUint(gl_FragCoord.z), fragment_id());
  if (place.tail == 0u) take_any_slot(place, key);
  const bool enters = place.tail > 0u && place.keys > 0u && !is_rejected(place, key);
#ifdef INTERLOCK
  if (!enters) discard;
  beginInvocationInterlockARB();
  const uvec2 farthest = insert(place, key);
  words[2u * place.first] = farthest.y;
  words[2u * place.first + 1u] = farthest.x | kUnlocked;
  endInvocationInterlockARB();
#else
  if (enters) insert_in_turn(place, key);
#endif
}
