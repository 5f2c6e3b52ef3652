#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "capture/k_buffers/blocks.glsl"
#include "resolve/effects.glsl"
// Gives each covered pixel its share of the tail of its block.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_FINAL_COLORS) writeonly buffer FinalColors { vec4 final_colors[]; };

// Counts the covered pixels of a row from one index to another.
uint covered_between(uint first, uint last) {
  uint sum = 0u;
  for (uint word = first / 32u; word <= last / 32u; ++word) {
    uint bits = covered[word];
    if (word == first / 32u) bits &= 0xFFFFFFFFu << (first % 32u);
    if (word == last / 32u) bits &= 0xFFFFFFFFu >> (31u - last % 32u);
    sum += uint(bitCount(bits));
  }
  return sum;
}

uint covered_of_block(uvec2 first) {
  const uvec2 end = min(first + push.p0, frame.size);
  if (push.p2 == 0u) return (end.x - first.x) * (end.y - first.y);
  uint sum = 0u;
  for (uint y = first.y; y < end.y; ++y)
    sum += covered_between(pixel_index(uvec2(first.x, y)), pixel_index(uvec2(end.x - 1u, y)));
  return sum;
}

void main() {
  const uvec2 at = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(at, frame.size))) return;
  const uint pixel = pixel_index(at);
  State state = effect_init();
  if (is_covered(pixel) && effect_blends()) {
    const uint block = block_of(pixel);
    const vec4 sums = vec4(blocks[block], blocks[block + 1u], blocks[block + 2u], blocks[block + 3u]);
    const float pixels = float(max(covered_of_block(at / push.p0 * push.p0), 1u));
    transparency_merge(state, State(tail_layer(sums, tail_scale(kBlockBits, push.p1) * pixels), uvec4(0u)));
  }
  final_colors[pixel] = effect_finish(state, pixel);
}
