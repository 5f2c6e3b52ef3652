#version 460
#extension GL_GOOGLE_include_directive : require
#ifdef INTERLOCK
#extension GL_ARB_fragment_shader_interlock : require
#endif
#include "../interface/frame.glsl"
#include "../interface/fragment_input.glsl"
#include "../interface/counters.glsl"
#include "places.glsl"
// The nearest fragments of a pixel, as many as it has slots for, in no sequence but that the first slot holds the
// farthest: the one that the next has to be nearer than, which most are not, and that it takes the place of. One fragment
// of a pixel at a time: fragment shader INTERLOCK, or a spin lock. Vasilakis, Papaioannou, Fudos, "k+-buffer: An Efficient,
// Memory-Friendly and Dynamic k-buffer Framework", TVCG 2015. kK: a pixel with as many slots or more has a heap.
layout(std430, set = 0, binding = SLOT_A) coherent buffer Pool { uint words[]; };
#include "max_heap.glsl"
#ifdef INTERLOCK
layout(pixel_interlock_unordered) in;
#endif

// Where all have a slot nobody waits: each takes the first that is free.
void take_any_slot(Place place, uvec2 key) {
  for (uint i = place.first; i < place.first + place.keys; ++i) {
    if (words[2u * i + 1u] != kNone || atomicCompSwap(words[2u * i + 1u], kNone, key.x) != kNone) continue;
    words[2u * i] = key.y;
    return;
  }
}

// The farthest only gets nearer, so a look at it without the lock may reject, not admit.
bool is_rejected(Place place, uvec2 key) { return key.x > (words[2u * place.first + 1u] & ~kUnlocked); }

// In the critical section: the farthest afterwards.
uvec2 insert(Place place, uvec2 key) {
  const uvec2 farthest = key_at(place.first);
  if (!is_behind(farthest, key)) return farthest;
  return place.keys >= kK ? sift_down(place.first, place.keys, 0u, key) : replace_first(place.first, place.keys, key);
}

#ifndef INTERLOCK
// The word that the farthest is told by is the lock: it is taken by clearing its top bit, and put back as the new one.
bool insert_alone(Place place, uvec2 key) {
  const uint lock = 2u * place.first + 1u;
  if ((atomicAnd(words[lock], ~kUnlocked) & kUnlocked) == 0u) return false;
  memoryBarrierBuffer();
  const uvec2 farthest = insert(place, key);
  words[lock - 1u] = farthest.y;
  memoryBarrierBuffer();
  atomicExchange(words[lock], farthest.x | kUnlocked);
  return true;
}

// Tries push.p2 times; what is still outside then goes to the tail and is counted. The critical section is within the
// turn that gets the lock, so invocations that run in step do not wait for one of their own.
void insert_in_turn(Place place, uvec2 key) {
  bool waits = true;
  for (uint turn = 0u; turn < push.p2 && waits; ++turn)
    waits = !is_rejected(place, key) && !insert_alone(place, key);
  if (waits && !is_rejected(place, key)) atomicAdd(counters.overflowed, 1u);
}
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
