// What is known of a pixel before places are given out. It is stored where the fragments will be (A): one
// word per pixel for the number of fragments, then, if kVariant says so, one for the sum of their optical
// depths and one for the nearest fragment. Number and sum share a word if no pixel has 1024 fragments or
// more.
#ifndef SURVEY_GLSL
#define SURVEY_GLSL
// Terms of importance, as in include/pellucid/memory_budget.h.
const uint kOpacityTerm = 1u;
const uint kComplexityTerm = 2u;
const uint kPeripheryTerm = 4u;
const uint kFresnelTerm = 8u;
const uint kImageTerm = 16u;
const uint kResidueTerm = 32u;
const uint kDepthSurvey = 64u;  // sum up optical depths, for the term and for tails
bool has_term(uint term) { return (kVariant & term) != 0u; }
layout(std430, set = 0, binding = SLOT_A) buffer Survey { uint survey[]; };
const uint kPackedSurvey = 128u;
const uint kCountBits = 10u;
const float kDepthUnits = 512.0;  // per unit of optical depth, which is at most 8
uint depth_word(uint pixel) { return pixel_count() + pixel; }
uint nearest_word(uint pixel) {
  return (has_term(kDepthSurvey) && !has_term(kPackedSurvey) ? 2u : 1u) * pixel_count() + pixel;
}
void add_to_survey(uint pixel, uint depth_units) {
  if (has_term(kPackedSurvey)) {
    atomicAdd(survey[pixel], depth_units << kCountBits | 1u);
  } else {
    atomicAdd(survey[pixel], 1u);
    if (has_term(kDepthSurvey)) atomicAdd(survey[depth_word(pixel)], depth_units);
  }
}
uint surveyed_fragments(uint pixel) {
  return has_term(kPackedSurvey) ? survey[pixel] & ((1u << kCountBits) - 1u) : survey[pixel];
}
uint surveyed_depth(uint pixel) {
  return has_term(kPackedSurvey) ? survey[pixel] >> kCountBits : survey[depth_word(pixel)];
}
#endif
