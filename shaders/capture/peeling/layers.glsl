// What a round of peeling finds in the layer at hand of a pixel: at its near end, and with SIDES 2 at its far
// end, too.
//   PAIRS   the smallest and the largest id, and how many there are
//   LISTS   all
//   ARRAYS  the kK drawn first
//   CHAINS  the first kK, that is those of the smallest ids, at the far end of the largest
//   IMAGE   one, in a colour attachment: peel_image.frag
// Everything starts as zero, but heads and chains as kNone.
#ifndef LAYERS_GLSL
#define LAYERS_GLSL
#ifndef SIDES
#define SIDES 1
#endif
uint near_end(uint pixel) { return SIDES * pixel; }
uint far_end(uint pixel) { return SIDES * pixel + 1u; }

// Without depth test: where the layers lie. Keys of depths are their bits + 1, so that 0 is in front of all
// of them and kNone behind. Of each end: the layer at hand; the next one, at the near end as its complement,
// so that both start as 0 and take the maximum.
#if defined(SEARCH)
layout(std430, set = 0, binding = SLOT_A) buffer Depths { uvec2 depths[]; };
uint key_of(float z) { return floatBitsToUint(z) + 1u; }
float depth_of(uint key) { return uintBitsToFloat(key - 1u); }
#endif

// Layers of more fragments than a round can take are resumed by the next: which ids were taken. PAIRS: the
// smallest ids up to x, the largest down to y. CHAINS: all up to x, at the far end down to it; y: there are
// more. x is 0 when a layer begins.
#if defined(PAIRS) || defined(CHAINS)
layout(std430, set = 0, binding = SLOT_B) buffer Windows { uvec2 windows[]; };
#endif
#if defined(PAIRS)
struct Pair {
  uint smallest_complement, largest, count, smallest_color, largest_color;
};
layout(std430, set = 0, binding = SLOT_C) buffer Pairs { Pair pairs[]; };
#elif defined(CHAINS)
// An id, or its complement at the far end, above a colour.
layout(std430, set = 0, binding = SLOT_C) buffer Chains { uint64_t chains[]; };
const uint64_t kEmpty = ~uint64_t(0);
// Is a layer resumed (kb), or do its other fragments get lost (classic dual peeling)?
bool resumes() { return kVariant != 0u; }
#elif defined(LISTS)
layout(std430, set = 0, binding = SLOT_B) buffer Heads { uint heads[]; };
layout(std430, set = 0, binding = SLOT_C) buffer Nodes { uint nodes[]; };  // id, colour, next
#elif defined(ARRAYS)
layout(std430, set = 0, binding = SLOT_B) buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = SLOT_C) buffer Nodes { uvec2 nodes[]; };  // id, colour
#endif
#endif
