// Slots of 8 bytes in one pool (A): first the nearest fragments of a pixel, then, where there are more, their tail
// (place_tail.glsl). A slot is two words, the lower one first: id and depth bits, and once the colour came, colour and
// mark | depth bits; all bits are set where there is no fragment. Which slots: with kVariant 0 and 3 push.p0 for every
// pixel, the last of them the tail (with 3, the last two); else those from a pixel's word in the map (B) to its successor's.
#ifndef PLACES_GLSL
#define PLACES_GLSL
layout(std430, set = 0, binding = SLOT_B) readonly buffer Map { uint map[]; };

// kVariant: enum class Places of src/render/capture/k_buffers/tailed_buffer.h.
const uint kUniformPlaces = 0u;
const uint kMappedWithWeights = 2u;     // tails have colours that are weighted by light (weighted_tail.glsl)
const uint kUniformWithOpacities = 3u;  // or by opacity

// A word of the map: the range of the tail (tail.glsl) or its code (weighted_tail.glsl), 0 where there is none, and the
// first slot.
const uint kPlaceBits = 27u;
const uint kPlaceMask = (1u << kPlaceBits) - 1u;

struct Place {
  uint first, keys;  // slots of fragments
  uint tail;         // 0: none; else its range or code, and it is behind them
};

Place place_of(uint pixel) {
  if (kVariant == kUniformPlaces) return Place(push.p0 * pixel, push.p0 - 1u, push.p1);
  if (kVariant == kUniformWithOpacities) return Place(push.p0 * pixel, push.p0 - 2u, push.p1);
  const uint word = map[pixel];
  const uint first = word & kPlaceMask;
  const uint range = word >> kPlaceBits;
  return Place(first, (map[pixel + 1u] & kPlaceMask) - first - (range > 0u ? 1u : 0u), range);
}

// Depths in 0..1 leave the two top bits free. Of a slot without a fragment the depth is beyond all others.
const uint kHasColor = 0x80000000u;
uint depth_of(uvec2 slot) { return slot.y & ~kHasColor; }
bool is_empty(uvec2 slot) { return slot == uvec2(kNone); }
#endif
