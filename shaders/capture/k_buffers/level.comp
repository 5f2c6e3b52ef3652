#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "capture/k_buffers/place_map.glsl"
#include "capture/k_buffers/survey.glsl"
// One round of the search for the highest level whose slots fit the budget. A round finds four more bits of
// the level (a float), so it sums up slots for 15 levels. The result of a round follows from its sums.
layout(local_size_x = 64) in;
const uint kLevels = 15u;
shared uint part[kLevels];
shared uint low;

uint level_so_far() {
  uint level = 0u;
  for (uint round = 0u; round < push.round; ++round) {
    uint fitting = 0u;
    for (uint i = 0u; i < kLevels; ++i)
      fitting += budget.sums[16u * round + i] <= uint64_t(budget.slots) ? 1u : 0u;
    level += fitting << (28u - 4u * round);
  }
  return level;
}

void main() {
  const uint lane = gl_LocalInvocationIndex;
  if (lane == 0u) low = level_so_far();
  if (lane < kLevels) part[lane] = 0u;
  barrier();
  // The last call only stores the level that was found.
  if (push.round == 8u) {
    if (group_index() == 0u && lane == 0u) budget.level = low;
    return;
  }
  uint sums[kLevels];
  for (uint c = 0u; c < kLevels; ++c) sums[c] = 0u;
  const uint first = first_pixel();
  for (uint i = first; i < min(first + kLanePixels, pixel_count()); ++i) {
    const uint fragments = surveyed_fragments(i);
    if (fragments == 0u) continue;
    const float importance = uintBitsToFloat(map[i]);
    for (uint c = 0u; c < kLevels; ++c)
      sums[c] += slots_at(fragments, importance, low + (c + 1u << (28u - 4u * push.round)));
  }
  for (uint c = 0u; c < kLevels; ++c)
    if (sums[c] > 0u) atomicAdd(part[c], sums[c]);
  barrier();
  if (lane < kLevels && part[lane] > 0u) atomicAdd(budget.sums[16u * push.round + lane], uint64_t(part[lane]));
}
