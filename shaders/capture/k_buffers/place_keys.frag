#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "capture/keys.glsl"
#include "capture/k_buffers/places.glsl"
layout(std430, set = 0, binding = SLOT_A) buffer Pool { uint64_t pool[]; };
// Keeps the nearest fragments of a pixel, as many as it has slots for, by a chain of 64-bit minima
// (capture/insert_key.glsl). Slots only get smaller, and they increase in the end, so a key may skip every
// slot that is smaller already.
void main() {
  const Place place = place_of(fragment_pixel());
  if (place.keys == 0u) return;
  const uint last = place.first + place.keys - 1u;
  uint64_t key = make_key(gl_FragCoord.z, fragment_id());
  if (key >= pool[last]) return;
  uint begin = place.first;
  for (uint end = last; begin < end;) {
    const uint middle = (begin + end) / 2u;
    if (pool[middle] < key) begin = middle + 1u;
    else end = middle;
  }
  for (uint i = begin; i <= last && key != kNoKey; ++i) key = max(key, atomicMin(pool[i], key));
}
