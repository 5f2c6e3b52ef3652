#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "capture/k_buffers/place_map.glsl"
// Replaces the sums of every group by those of all groups before it, and computes what the level leaves over.
// Runs as one workgroup.
layout(local_size_x = 64) in;
shared uvec2 totals[64];
void main() {
  const uint lane = gl_LocalInvocationIndex;
  const uint count = (pixel_count() + kGroupPixels - 1u) / kGroupPixels;
  const uint share = (count + 63u) / 64u;
  const uint begin = min(lane * share, count);
  const uint end = min(begin + share, count);
  uvec2 sum = uvec2(0u);
  for (uint i = begin; i < end; ++i) sum += budget.groups[i];
  totals[lane] = sum;
  barrier();
  if (lane == 0u) {
    uvec2 before = uvec2(0u);
    for (uint i = 0u; i < 64u; ++i) {
      const uvec2 here = totals[i];
      totals[i] = before;
      before += here;
    }
    budget.leftover = kK == kWater ? budget.slots - before.x : 0u;
  }
  barrier();
  sum = totals[lane];
  for (uint i = begin; i < end; ++i) {
    const uvec2 here = budget.groups[i];
    budget.groups[i] = sum;
    sum += here;
  }
}
