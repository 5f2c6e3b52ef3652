#version 460
#extension GL_GOOGLE_include_directive : require
#ifdef INTERLOCK
#extension GL_ARB_fragment_shader_interlock : require
#endif
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "counters.glsl"
#include "capture/k_buffers/places.glsl"
// The nearest fragments of a pixel, as many as it has slots for, in no order but that the first slot holds the
// farthest: the one that the next has to be nearer than, which most are not, and that it takes the place of. One fragment
// of a pixel at a time: fragment shader INTERLOCK, or a spin lock. Vasilakis, Papaioannou, Fudos, "k+-buffer: An Efficient,
// Memory-Friendly and Dynamic k-buffer Framework", TVCG 2015. kK: a pixel with as many slots or more has a heap.
layout(std430, set = 0, binding = SLOT_A) coherent buffer Pool { uint words[]; };
#include "capture/k_buffers/max_first.glsl"
#ifdef INTERLOCK
layout(pixel_interlock_unordered) in;
#endif

void main() {
  // Others of a quad that the triangle does not cover: their atomics do nothing, so they would wait in vain.
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
