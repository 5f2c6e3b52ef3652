// Block tails, for budgets in which not even one slot per pixel fits. A has a tail of four words for every
// block of push.p0 x push.p0 pixels. B has one bit for each pixel that something covers, if there is memory
// for it (push.p2). push.p1 is the range of a tail.
#ifndef BLOCKS_GLSL
#define BLOCKS_GLSL
#include "capture/k_buffers/tail.glsl"
layout(std430, set = 0, binding = SLOT_A) buffer Blocks { uint blocks[]; };
layout(std430, set = 0, binding = SLOT_B) buffer Covered { uint covered[]; };
const uint kBlockBits = 32u;
uint block_of(uint pixel) {
  const uvec2 at = uvec2(pixel % frame.size.x, pixel / frame.size.x) / push.p0;
  return 4u * (at.y * ((frame.size.x + push.p0 - 1u) / push.p0) + at.x);
}
bool is_covered(uint pixel) { return push.p2 == 0u || (covered[pixel / 32u] >> (pixel % 32u) & 1u) != 0u; }
#endif
