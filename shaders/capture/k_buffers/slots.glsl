// Access to the slots of a place (places.glsl) while colours are stored: as 64 bits or, for devices without
// 64-bit atomics, as words (HALVES).
#ifndef SLOTS_GLSL
#define SLOTS_GLSL
#include "capture/k_buffers/places.glsl"
#ifdef HALVES
layout(std430, set = 0, binding = SLOT_A) coherent buffer Pool { uint words[]; };
#ifndef ORDER_WORDS
#define ORDER_WORDS memoryBarrierBuffer();
#endif
uint depth_at(uint i) { return words[2u * i + 1u] & ~kHasColor; }
// The mark is stored before its colour. A shader that reads a colour in place of an id therefore also finds the
// mark.
uvec2 slot_at(uint i) {
  const uint low = words[2u * i];
  ORDER_WORDS
  return uvec2(low, words[2u * i + 1u]);
}
void put_color(uint i, uint depth, uint color) {
  atomicExchange(words[2u * i + 1u], kHasColor | depth);
  ORDER_WORDS
  atomicExchange(words[2u * i], color);
}
// The invocation whose addition overflows the lower word adds the carry, so the result is a 64-bit sum.
void add_to_slot(uint i, uvec2 units) {
  const uint before = atomicAdd(words[2u * i], units.x);
  const uint carried = units.y + (before + units.x < before ? 1u : 0u);
  if (carried > 0u) atomicAdd(words[2u * i + 1u], carried);
}
#else
#include "capture/keys.glsl"
layout(std430, set = 0, binding = SLOT_A) buffer Pool { uint64_t pool[]; };
uvec2 slot_at(uint i) { return unpackUint2x32(pool[i]); }
uint depth_at(uint i) { return depth_of(slot_at(i)); }
void put_color(uint i, uint depth, uint color) {
  atomicExchange(pool[i], packUint2x32(uvec2(color, kHasColor | depth)));
}
void add_to_slot(uint i, uvec2 units) { atomicAdd(pool[i], packUint2x32(units)); }
#endif

// Returns the first of the sorted fragments that is not nearer than `depth`.
uint first_slot_at(Place place, uint depth) {
  uint begin = place.first;
  for (uint end = place.first + place.keys; begin < end;) {
    const uint middle = (begin + end) / 2u;
    if (depth_at(middle) < depth) begin = middle + 1u;
    else end = middle;
  }
  return begin;
}

// Returns the slot that keeps a fragment, or the end of the slots if none does.
uint slot_of(Place place, uint depth, uint id) {
  const uint behind = place.first + place.keys;
  for (uint i = first_slot_at(place, depth); i < behind; ++i) {
    const uvec2 slot = slot_at(i);
    if (slot == uvec2(id, depth)) return i;
    if (depth_of(slot) != depth) break;
  }
  return behind;
}
#endif
