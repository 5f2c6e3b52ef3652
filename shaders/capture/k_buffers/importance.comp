#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "capture/k_buffers/place_map.glsl"
#include "capture/k_buffers/survey.glsl"

// Terms of importance, each a function of a pixel. To add one, write a function, call it in main() here, and
// add its name to include/pellucid/memory_budget.h.
#include "scene/samples.glsl"
// D has the bytes of an image, row by row, or those that the last frame left (fold_places.comp).
layout(std430, set = 0, binding = SLOT_D) readonly buffer Given { uint given[]; };
float given_byte(uint i) { return float(given[i / 4u] >> (8u * (i % 4u)) & 255u); }

vec2 place_of(uint pixel) { return place_in_image(uvec2(pixel % frame.size.x, pixel / frame.size.x)); }

// Returns the mean number of fragments that halve the light. If slots are proportional to it, equally much
// light gets through the slots of every pixel.
float opacity_term(uint fragments, uint depth_units) {
  return float(fragments) * kDepthUnits / float(max(depth_units, fragments * 7u));
}

// Equation 3 of the paper.
float complexity_term(uint fragments) {
  return budget.alpha + (1.0 - budget.alpha) * min(1.0, float(fragments) / budget.limit);
}

// Equation 4 of the paper. The point of interest may be anywhere, so the result may be below 0.
float periphery_term(uint pixel) {
  const vec2 size = image_size();
  const float d = 2.0 * length(place_of(pixel) - budget.point * size) / (1.1 * length(size));
  return max(1.0 - pow(d, budget.falloff), 0.0);
}

// Equation 5 of the paper, for the nearest fragment of this frame.
float fresnel_term(uint nearest) {
  const float away = 1.0 - float(~nearest & 255u) / 255.0;
  const float away2 = away * away;
  return 1.0 - 0.5 * away2 * away2 * away;
}

// Returns the importance in the image of the user, scaled to the size of this image.
float image_term(uint pixel) {
  const vec2 size = vec2(float(budget.image_width), float(budget.image_height));
  const uvec2 at = uvec2(min(place_of(pixel) / image_size() * size, size - 1.0));
  return given_byte(at.y * budget.image_width + at.x) / 255.0;
}

// Returns what the last frame found: 1 where nothing is known, and a factor of 2 for every 32 steps.
float residue_term(uint pixel) { return exp2((given_byte(pixel) - 128.0) / 32.0); }

// Equation 6 of the paper: noise that is the same in every frame and evenly spread (Jimenez, "Next Generation
// Post Processing in Call of Duty: Advanced Warfare", SIGGRAPH 2014).
float noise_term(uint pixel) {
  if (budget.noise == 0.0) return 0.0;
  const vec2 at = floor(place_of(pixel));
  return budget.noise * (fract(52.9829189 * fract(dot(at, vec2(0.06711056, 0.00583715)))) - 0.5);
}

// Computes the importance of every pixel: the product of the terms that kVariant names, and noise; 0 without
// fragments. Based on: Vasilakis, Vardis, Papaioannou, Moustakas, "Variable k-buffer using Importance Maps",
// Eurographics 2017, section 3.2.
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
