#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "../interface/fragment_input.glsl"
#include "places.glsl"
// Second pass over the same fragments: colours in place of ids where keys were kept, marked, so that no colour is taken
// for the id of a fragment at the same depth; all others go to the tail. A slot is read and written as one word.
const uint kDump = 7u;  // kDumpEffect, which wants the ids

void main() {
  const uint pixel = fragment_pixel();
  const Place place = place_of(pixel);
  const uint depth = floatBitsToUint(gl_FragCoord.z);
  const uint id = fragment_id();
  const uint64_t key = make_key(gl_FragCoord.z, id);
  const uint behind = place.first + place.keys;
  uint begin = place.first;
  for (uint end = behind; begin < end;) {
    const uint middle = (begin + end) / 2u;
    if (slot_depth(pool[middle]) < depth) begin = middle + 1u;
    else end = middle;
  }
  for (; begin < behind; ++begin) {
    const uint64_t slot = pool[begin];
    if (slot_depth(slot) != depth) break;
    if (slot != key) continue;
    if (kEffect != kDump)
      atomicExchange(pool[begin], kHasColor | (uint64_t(depth) << 32) | uint64_t(fragment_color()));
    return;
  }
  if (kEffect == kDump || place.tail == 0u) return;
  const vec4 share = tail_share(fragment_color());
  const float rounding = tail_rounding(pixel, id);
  if (has_weights(place)) {
    const float last = place.keys > 0u ? uintBitsToFloat(slot_depth(pool[behind - 1u])) : 0.0;
    const float light = light_in_tail(gl_FragCoord.z, last, place.tail);
    atomicAdd(pool[behind], weighted_units(share, light, place.tail, rounding));
  } else {
    atomicAdd(pool[behind], pack_tail(tail_units(share, tail_scale(kTailBits, tail_range(place)), rounding)));
  }
}
