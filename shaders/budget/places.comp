#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "budget.glsl"
#include "survey.glsl"
#include "tail.glsl"
// The place of every pixel (places.glsl), in the sequence of pixels.
layout(local_size_x = 64) in;
const uint kPlaceBits = 27u;
shared uvec2 sums[64];

// Of the tail, which takes one of the slots; 0: there is none. Where all optical depths of the pixel were summed up
// their sum bounds the tail's, twice, so that rounding does not matter. Edges of wireframes were not looked at.
uint tail_range(uint pixel, uint fragments, uint slots) {
  if (kK == kPrinted ? fragments == 0u : slots >= fragments) return 0u;
  const uint tail = max(fragments + 1u, slots + 1u) - slots;
  const uint range = range_of(tail);
  if (!has_term(kDepthSurvey) || kEffect == 1u || tail >= 32768u) return range;
  const float sum = 2.0 * (float(survey[depth_word(pixel)] + fragments) / kDepthUnits);
  return min(range, uint(max(int(ceil(log2(sum))) + kRangeBias, 1)));
}

void main() {
  const uint lane = gl_LocalInvocationIndex;
  const uint group = group_index();
  const uint first = first_pixel();
  const uint end = min(first + kLanePixels, pixel_count());
  uvec2 sum = uvec2(0u);
  for (uint i = first; i < end; ++i) sum += slots_of(i, survey[i]);
  sums[lane] = sum;
  barrier();
  if (first >= pixel_count()) return;
  uvec2 before = budget.groups[group];
  for (uint i = 0u; i < lane; ++i) before += sums[i];
  for (uint i = first; i < end; ++i) {
    const uint fragments = survey[i];
    const uvec2 here = slots_of(i, fragments);
    const uint place = before.x + min(before.y, budget.leftover);
    before += here;
    const uint behind = before.x + min(before.y, budget.leftover);
    map[i] = tail_range(i, fragments, behind - place) << kPlaceBits | place;
    if (i + 1u == pixel_count()) map[i + 1u] = behind;
  }
}
