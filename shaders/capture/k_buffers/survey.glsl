// What is known of a pixel before places are given out. It lies where the fragments will lie (A): a word each for the
// number of fragments, then, where kVariant says so, the sum of their optical depths and the nearest one. Number and sum
// share a word where no pixel has 1024 fragments.
#ifndef SURVEY_GLSL
#define SURVEY_GLSL
// Terms of importance: include/pellucid/memory_budget.h.
const uint kOpacityTerm = 1u;
const uint kComplexityTerm = 2u;
const uint kPeripheryTerm = 4u;
const uint kFresnelTerm = 8u;
const uint kImageTerm = 16u;
const uint kResidueTerm = 32u;
const uint kDepthSurvey = 64u;  // optical depths are summed up, for the term and for tails
bool has_term(uint term) { return (kVariant & term) != 0u; }
layout(std430, set = 0, binding = SLOT_A) buffer Survey { uint survey[]; };
const uint kPackedSurvey = 128u;
const uint kCountBits = 10u;
const float kDepthUnits = 512.0;  // of an optical depth, 8 at most
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
