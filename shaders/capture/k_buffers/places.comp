#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "capture/k_buffers/place_map.glsl"
#include "capture/k_buffers/survey.glsl"
#include "capture/k_buffers/weighted_tail.glsl"
// Computes the place of every pixel (places.glsl), in the order of pixels.
layout(local_size_x = 64) in;
const uint kPlaceBits = 27u;
shared uvec2 sums[64];

// Returns what the map says of the tail, which takes one of the slots: its code if all optical depths of the
// pixel were summed up, its range otherwise, and 0 without a tail. Edges of wireframes are not part of the
// survey.
uint tail_of(uint pixel, uint fragments, uint slots) {
  if (kK == kPrinted ? fragments == 0u : slots >= fragments) return 0u;
  const uint tail = max(fragments + 1u, slots + 1u) - slots;
  if (!has_term(kDepthSurvey) || kEffect == 1u) return range_of(tail);
  return code_of(float(surveyed_depth(pixel) + fragments) / kDepthUnits, tail);
}

void main() {
  const uint lane = gl_LocalInvocationIndex;
  const uint group = group_index();
  const uint first = first_pixel();
  const uint end = min(first + kLanePixels, pixel_count());
  uvec2 sum = uvec2(0u);
  for (uint i = first; i < end; ++i) sum += slots_of(i, surveyed_fragments(i));
  sums[lane] = sum;
  barrier();
  if (first >= pixel_count()) return;
  uvec2 before = budget.groups[group];
  for (uint i = 0u; i < lane; ++i) before += sums[i];
  for (uint i = first; i < end; ++i) {
    const uint fragments = surveyed_fragments(i);
    const uvec2 here = slots_of(i, fragments);
    const uint place = before.x + min(before.y, budget.leftover);
    before += here;
    const uint behind = before.x + min(before.y, budget.leftover);
    map[i] = tail_of(i, fragments, behind - place) << kPlaceBits | place;
    if (i + 1u == pixel_count()) map[i + 1u] = behind;
  }
}
