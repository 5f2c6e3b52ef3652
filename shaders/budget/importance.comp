#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "budget.glsl"
#include "survey.glsl"
#include "terms.glsl"
// Importance of every pixel: the product of the terms that kVariant names, and noise; 0 where there is nothing.
// Vasilakis, Vardis, Papaioannou, Moustakas, "Variable k-buffer using Importance Maps", Eurographics 2017, section 3.2.
layout(local_size_x = 64) in;
const float kLeastImportance = 1.0 / 1024.0;
const float kMostImportance = 1024.0;
shared uint64_t sums[64];

float importance_of(uint pixel, uint fragments) {
  if (fragments == 0u) return 0.0;
  float importance = 1.0;
  if (has_term(kOpacityTerm)) importance *= opacity_term(fragments, surveyed_depth(pixel));
  if (has_term(kComplexityTerm)) importance *= complexity_term(fragments);
  if (has_term(kPeripheryTerm)) importance *= periphery_term(pixel);
  if (has_term(kFresnelTerm)) importance *= fresnel_term(survey[nearest_word(pixel)]);
  if (has_term(kImageTerm)) importance *= image_term(pixel);
  if (has_term(kResidueTerm)) importance *= residue_term(pixel);
  return clamp(importance + noise_term(pixel), kLeastImportance, kMostImportance);
}

void main() {
  uint64_t sum = uint64_t(0);
  const uint first = first_pixel();
  for (uint i = first; i < min(first + kLanePixels, pixel_count()); ++i) {
    const float importance = importance_of(i, surveyed_fragments(i));
    map[i] = floatBitsToUint(importance);
    sum += uint64_t(kImportanceUnits * importance);
  }
  if (kK != kPrinted) return;
  sums[gl_LocalInvocationIndex] = sum;
  barrier();
  if (gl_LocalInvocationIndex != 0u) return;
  for (uint i = 1u; i < 64u; ++i) sum += sums[i];
  if (sum > uint64_t(0)) atomicAdd(budget.importance_sum, sum);
}
