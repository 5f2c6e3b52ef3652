// What a round of peeling finds in the current layer of a pixel, at its near end and, with SIDES 2, at its
// far end, too:
//   PAIRS   the smallest and the largest id, and how many there are
//   LISTS   all fragments
//   ARRAYS  the kK fragments that are drawn first
//   CHAINS  the kK smallest ids; at the far end, the kK largest
//   IMAGE   one fragment, in a colour attachment (peel_image.frag)
// Everything starts as zero, except heads and chains, which start as kNone.
#ifndef LAYERS_GLSL
#define LAYERS_GLSL
#ifndef SIDES
#define SIDES 1
#endif
uint near_end(uint pixel) { return SIDES * pixel; }
uint far_end(uint pixel) { return SIDES * pixel + 1u; }

// Where the layers lie, if there is no depth test. The key of a depth is its bits + 1, so that 0 lies in
// front of all depths and kNone behind them. For each end, x is the current layer and y is the next one. At
// the near end y is complemented, so that both start as 0 and take the maximum.
#if defined(SEARCH)
layout(std430, set = 0, binding = SLOT_A) buffer Depths { uvec2 depths[]; };
uint key_of(float z) { return floatBitsToUint(z) + 1u; }
float depth_of(uint key) { return uintBitsToFloat(key - 1u); }
#endif

// If a layer has more fragments than a round can take, the next round resumes it. These windows say which ids
// were taken. PAIRS: the smallest ids up to x and the largest down to y. CHAINS: all ids up to x, at the far
// end down to x; y says whether there are more. x is 0 at the beginning of a layer.
#if defined(PAIRS) || defined(CHAINS)
layout(std430, set = 0, binding = SLOT_B) buffer Windows { uvec2 windows[]; };
#endif
#if defined(PAIRS)
struct Pair {
  uint smallest_complement, largest, count, smallest_color, largest_color;
};
layout(std430, set = 0, binding = SLOT_C) buffer Pairs { Pair pairs[]; };
#elif defined(CHAINS)
// An id (at the far end its complement) in the upper word and a colour in the lower word.
layout(std430, set = 0, binding = SLOT_C) buffer Chains { uint64_t chains[]; };
const uint64_t kEmpty = ~uint64_t(0);
// Returns whether a layer is resumed, or its other fragments are lost (classic dual peeling).
bool resumes() { return kVariant != 0u; }
#elif defined(LISTS)
layout(std430, set = 0, binding = SLOT_B) buffer Heads { uint heads[]; };
layout(std430, set = 0, binding = SLOT_C) buffer Nodes { uint nodes[]; };  // id, colour, next
#elif defined(ARRAYS)
layout(std430, set = 0, binding = SLOT_B) buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = SLOT_C) buffer Nodes { uvec2 nodes[]; };  // id, colour
#endif
#endif
