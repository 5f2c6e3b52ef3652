// What is known of a pixel before places are given out. It lies where the fragments will lie (A): a word each for the
// number of fragments, then, where kVariant says so, the sum of their optical depths and the nearest one.
#ifndef SURVEY_GLSL
#define SURVEY_GLSL
// Terms of importance: include/pellucid/budget.h.
const uint kOpacityTerm = 1u;
const uint kComplexityTerm = 2u;
const uint kPeripheryTerm = 4u;
const uint kFresnelTerm = 8u;
const uint kImageTerm = 16u;
const uint kResidueTerm = 32u;
const uint kDepthSurvey = 64u;  // optical depths are summed up, for the term and for tails
bool has_term(uint term) { return (kVariant & term) != 0u; }
layout(std430, set = 0, binding = SLOT_A) buffer Survey { uint survey[]; };
const float kDepthUnits = 1024.0;
uint depth_word(uint pixel) { return pixel_count() + pixel; }
uint nearest_word(uint pixel) { return (has_term(kDepthSurvey) ? 2u : 1u) * pixel_count() + pixel; }
#endif
