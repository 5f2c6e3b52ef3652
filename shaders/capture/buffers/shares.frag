#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "capture/keys.glsl"
#include "capture/buffers/shares.glsl"
#if defined(KEYS)
// Keeps the nearest fragments of every pixel that lie behind the last key (B) of the round before, as many as
// the share of the pixel in the pool has places (A). In finished pixels nothing lies behind that key.
layout(std430, set = 0, binding = SLOT_A) buffer Keys { uint64_t keys[]; };
layout(std430, set = 0, binding = SLOT_B) readonly buffer Last { uint64_t last[]; };
#include "capture/insert_key.glsl"
void main() {
  const uint pixel = fragment_pixel();
  const uint64_t key = make_key(gl_FragCoord.z, fragment_id());
  if (push.round > 0u && key <= (last[pixel] & kKeyBits)) return;
  const Share share = share_of(pixel);
  if (share.in_window && share.count > 0u) insert_key(share.first, share.count, key);
}
#endif

#if defined(COLORS)
#include "counters.glsl"
#include "capture/buffers/overflow_tail.glsl"
// Second pass over the same fragments: those whose keys (A) were kept store their colours (C).
layout(std430, set = 0, binding = SLOT_A) readonly buffer Keys { uint64_t keys[]; };
layout(std430, set = 0, binding = SLOT_B) readonly buffer Last { uint64_t last[]; };
layout(std430, set = 0, binding = SLOT_C) writeonly buffer Colors { uint colors[]; };

// Returns the place of a key among the increasing keys of a share, or the size of the share if it is not
// there.
uint place_of(Share share, uint64_t key) {
  uint low = 0u;
  uint high = share.count;
  while (low < high) {
    const uint middle = (low + high) / 2u;
    if (keys[share.first + middle] < key) low = middle + 1u;
    else high = middle;
  }
  return low;
}

void main() {
  const uint pixel = fragment_pixel();
  const uint64_t key = make_key(gl_FragCoord.z, fragment_id());
  if (push.round > 0u && key <= (last[pixel] & kKeyBits)) return;
  const Share share = share_of(pixel);
  if (!share.in_window) return;
  const uint place = place_of(share, key);
  if (place < share.count) {
    colors[share.first + place] = fragment_color();
  } else if (kVariant == kLosesFragments) {
    atomicAdd(counters.overflowed, 1u);
    if (kEffect <= kWireframe) add_to_tail(pixel, unpack_color(fragment_color()));
  }
}
#endif
