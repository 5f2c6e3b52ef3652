// Slots of 8 bytes in one pool (A): first the nearest fragments of a pixel, then, where there are more, their tail.
// A slot holds a key (depth, id) and, once the colour came, (mark, depth, colour). Which slots: with kVariant 0 push.p0
// for every pixel, the last of them the tail; else those from a pixel's word in the map (B) to its successor's, with 2
// tails whose colours are weighted.
#ifndef PLACES_GLSL
#define PLACES_GLSL
#include "../interface/keys.glsl"
#include "weighted_tail.glsl"
layout(std430, set = 0, binding = SLOT_A) buffer Pool { uint64_t pool[]; };
layout(std430, set = 0, binding = SLOT_B) readonly buffer Map { uint map[]; };

// A word of the map: the range of the tail (tail.glsl) or its code (weighted_tail.glsl), 0 where there is none, and the
// first slot.
const uint kPlaceBits = 27u;
const uint kPlaceMask = (1u << kPlaceBits) - 1u;

struct Place {
  uint first, keys;  // slots of fragments
  uint tail;         // 0: none; else its range or code, and it is behind them
};

Place place_of(uint pixel) {
  if (kVariant == 0u) return Place(push.p0 * pixel, push.p0 - 1u, push.p1);
  const uint word = map[pixel];
  const uint first = word & kPlaceMask;
  const uint range = word >> kPlaceBits;
  return Place(first, (map[pixel + 1u] & kPlaceMask) - first - (range > 0u ? 1u : 0u), range);
}

// Depths in 0..1 leave the two top bits free.
const uint64_t kHasColor = uint64_t(1) << 63;
uint slot_depth(uint64_t slot) { return uint(slot >> 32) & 0x7FFFFFFFu; }

bool has_weights(Place place) { return kVariant == 2u && place.tail != kManyFragments; }
// push.p1: of the most fragments that a pixel has.
uint tail_range(Place place) { return kVariant == 2u ? push.p1 : place.tail; }

// Red, green, blue, optical depth, without weights. A slot that nothing was put into is -1.
const uint kTailBits = 16u;
uint64_t pack_tail(uvec4 units) {
  return uint64_t(units.x) | (uint64_t(units.y) << 16) | (uint64_t(units.z) << 32) | (uint64_t(units.w) << 48);
}
vec4 unpack_tail(uint64_t sum) {
  return vec4(uint(sum) & 0xFFFFu, uint(sum >> 16) & 0xFFFFu, uint(sum >> 32) & 0xFFFFu, uint(sum >> 48));
}
vec4 layer_of_tail(Place place) {
  const uint64_t sum = pool[place.first + place.keys] + uint64_t(1);
  if (has_weights(place)) return weighted_layer(sum, place.tail);
  return tail_layer(unpack_tail(sum), tail_scale(kTailBits, tail_range(place)));
}
#endif
