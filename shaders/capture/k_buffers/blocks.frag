#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "capture/k_buffers/blocks.glsl"
// Adds every fragment to the tail of its block.
void main() {
  const uint pixel = fragment_pixel();
  if (push.p2 != 0u) atomicOr(covered[pixel / 32u], 1u << (pixel % 32u));
  const uvec4 units = tail_units(tail_share(fragment_color()), tail_scale(kBlockBits, push.p1),
                                 tail_rounding(pixel, fragment_id()));
  const uint block = block_of(pixel);
  for (uint i = 0u; i < 4u; ++i) atomicAdd(blocks[block + i], units[i]);
}
