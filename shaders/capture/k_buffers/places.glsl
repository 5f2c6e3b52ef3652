// Slots of 8 bytes in one pool (A). A pixel has slots for its nearest fragments and, if it has more, one or
// two for their tail (place_tail.glsl). A slot is two words, the lower one first: id and depth bits, and
// later colour and mark | depth bits. In an empty slot all bits are set. With kVariant 0 and 3 every pixel
// has push.p0 slots; the last one is the tail (with 3, the last two). Otherwise the slots of a pixel begin
// where its word in the map (B) says, and end where those of the next pixel begin.
#ifndef PLACES_GLSL
#define PLACES_GLSL
layout(std430, set = 0, binding = SLOT_B) readonly buffer Map { uint map[]; };

// kVariant: enum class Places of src/render/capture/k_buffers/tailed_buffer.h.
const uint kUniformPlaces = 0u;
const uint kMappedWithWeights = 2u;     // light weights the colours of tails (weighted_tail.glsl)
const uint kUniformWithOpacities = 3u;  // opacity weights the colours of tails

// A word of the map has the first slot, and above it the range (tail.glsl) or code (weighted_tail.glsl) of
// the tail, or 0 without a tail.
const uint kPlaceBits = 27u;
const uint kPlaceMask = (1u << kPlaceBits) - 1u;

struct Place {
  uint first, keys;  // slots for fragments
  uint tail;         // range or code of the tail, which follows them; 0: no tail
};

Place place_of(uint pixel) {
  if (kVariant == kUniformPlaces) return Place(push.p0 * pixel, push.p0 - 1u, push.p1);
  if (kVariant == kUniformWithOpacities) return Place(push.p0 * pixel, push.p0 - 2u, push.p1);
  const uint word = map[pixel];
  const uint first = word & kPlaceMask;
  const uint range = word >> kPlaceBits;
  return Place(first, (map[pixel + 1u] & kPlaceMask) - first - (range > 0u ? 1u : 0u), range);
}

// Depths in 0..1 leave the two top bits free. The depth of an empty slot is greater than all others.
const uint kHasColor = 0x80000000u;
uint depth_of(uvec2 slot) { return slot.y & ~kHasColor; }
bool is_empty(uvec2 slot) { return slot == uvec2(kNone); }
#endif
