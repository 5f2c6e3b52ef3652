// Terms of importance, each a function of a pixel. To add one: a function here, a line in importance.comp, a name in
// include/pellucid/budget.h.
#ifndef TERMS_GLSL
#define TERMS_GLSL
#include "../interface/samples.glsl"
// D: bytes of an image, row by row, or those that the last frame left (residue.glsl).
layout(std430, set = 0, binding = SLOT_D) readonly buffer Given { uint given[]; };
float given_byte(uint i) { return float(given[i / 4u] >> (8u * (i % 4u)) & 255u); }

vec2 place_of(uint pixel) { return place_in_picture(uvec2(pixel % frame.size.x, pixel / frame.size.x)); }

// Fragments that it takes to halve the light, on average: with slots in this proportion as much light gets through
// those of one pixel as through those of another.
float opacity_term(uint fragments, uint depth_units) {
  return float(fragments) * kDepthUnits / float(max(depth_units, fragments * 7u));
}

// Equation 3.
float complexity_term(uint fragments) {
  return budget.alpha + (1.0 - budget.alpha) * min(1.0, float(fragments) / budget.limit);
}

// Equation 4; the point of interest may be anywhere, so it may get below 0.
float periphery_term(uint pixel) {
  const vec2 size = picture_size();
  const float d = 2.0 * length(place_of(pixel) - budget.point * size) / (1.1 * length(size));
  return max(1.0 - pow(d, budget.falloff), 0.0);
}

// Equation 5, of the nearest fragment of this frame.
float fresnel_term(uint nearest) {
  const float away = 1.0 - float(~nearest & 255u) / 255.0;
  const float away2 = away * away;
  return 1.0 - 0.5 * away2 * away2 * away;
}

// The user's, scaled to the picture.
float image_term(uint pixel) {
  const vec2 size = vec2(float(budget.image_width), float(budget.image_height));
  const uvec2 at = uvec2(min(place_of(pixel) / picture_size() * size, size - 1.0));
  return given_byte(at.y * budget.image_width + at.x) / 255.0;
}

// What the last frame found: 1 where nothing is known, an octave for 32 steps.
float residue_term(uint pixel) { return exp2((given_byte(pixel) - 128.0) / 32.0); }

// Equation 6: noise that is the same in every frame, and evenly spread (Jimenez, "Next Generation Post Processing in
// Call of Duty: Advanced Warfare", SIGGRAPH 2014).
float noise_term(uint pixel) {
  if (budget.noise == 0.0) return 0.0;
  const vec2 at = floor(place_of(pixel));
  return budget.noise * (fract(52.9829189 * fract(dot(at, vec2(0.06711056, 0.00583715)))) - 0.5);
}
#endif
