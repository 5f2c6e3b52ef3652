#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "capture/k_buffers/place_map.glsl"
#include "capture/k_buffers/survey.glsl"
// Sums up the slots of each group of pixels, and how many of its pixels would get one more at the next higher
// level.
layout(local_size_x = 64) in;
shared uint slots, more;
void main() {
  if (gl_LocalInvocationIndex == 0u) {
    slots = 0u;
    more = 0u;
  }
  barrier();
  uvec2 sum = uvec2(0u);
  const uint first = first_pixel();
  for (uint i = first; i < min(first + kLanePixels, pixel_count()); ++i) sum += slots_of(i, surveyed_fragments(i));
  atomicAdd(slots, sum.x);
  atomicAdd(more, sum.y);
  barrier();
  const uint group = group_index();
  if (gl_LocalInvocationIndex == 0u && group * kGroupPixels < pixel_count()) budget.groups[group] = uvec2(slots, more);
}
