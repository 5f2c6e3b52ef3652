// The budget and how it is given out. B has one word per pixel: first its importance (a float), in the end
// its place (places.glsl). C has what all groups share, then two sums for every group of 1024 pixels.
#ifndef BUDGET_GLSL
#define BUDGET_GLSL
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
layout(std430, set = 0, binding = SLOT_B) buffer Map { uint map[]; };
layout(std430, set = 0, binding = SLOT_C) buffer Budget {
  uint slots;                        // number of slots to give out
  float alpha, limit, falloff;       // parameters of importance
  vec2 point;
  float noise;
  uint covered;                      // pixels with fragments; each gets at least one slot
  uint leftover;                     // slots that are left at the level; they go to the first pixels that
                                     // would get one more at the next higher level
  uint level;                        // bits of a float
  uint image_width, image_height;    // of the importance image of the user
  uint64_t importance_sum;           // in units of 1 / kImportanceUnits
  uint64_t unused;
  uint64_t sums[8 * 16];             // for each round of the search and each of its 15 levels
  uvec2 groups[];
} budget;
const float kImportanceUnits = 65536.0;
const uint kGroupPixels = 1024u;
const uint kLanePixels = 16u;

// kK: how slots are given out.
const uint kWater = 0u;    // one (for a tail) plus importance times the level, at most one per fragment
const uint kUniform = 1u;  // the same number for all, at most one per fragment
const uint kPrinted = 2u;  // shares of importance, rounded down, as printed in the paper, and one for a tail

uint group_index() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }
uint first_pixel() { return group_index() * kGroupPixels + gl_LocalInvocationIndex * kLanePixels; }

uint slots_at(uint fragments, float importance, uint level) {
  if (fragments == 0u) return 0u;
  if (level > 0x7F7FFFFFu) return fragments;
  const float wanted = uintBitsToFloat(level) * importance;
  return min(fragments, 1u + uint(ceil(min(wanted, 1073741824.0))));
}
uint next_level(uint level) { return level == 0xFFFFFFFFu ? level : level + 1u; }

// Returns the slots of a pixel at the level, and how many more it would get at the next higher level. A level
// has 24 bits and its product with an importance is below 2^24 wherever it matters, so the second number is
// at most 1.
uvec2 slots_of(uint pixel, uint fragments) {
  const float importance = uintBitsToFloat(map[pixel]);
  if (kK == kPrinted) {
    if (fragments == 0u) return uvec2(0u);
    const uint64_t units = uint64_t(kImportanceUnits * importance);
    return uvec2(1u + uint(units * uint64_t(budget.slots - budget.covered) / budget.importance_sum), 0u);
  }
  const uint slots = slots_at(fragments, importance, budget.level);
  const uint more = slots_at(fragments, importance, next_level(budget.level));
  return uvec2(slots, kK == kUniform ? 0u : min(more - slots, 1u));
}
#endif
