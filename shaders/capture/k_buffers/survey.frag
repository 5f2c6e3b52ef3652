#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "capture/k_buffers/survey.glsl"
#include "capture/k_buffers/tail.glsl"
// The pass that counts fragments. kVariant has the terms of importance. It shades no more than they need.
void main() {
  const uint pixel = fragment_pixel();
  if (!has_term(kDepthSurvey) && !has_term(kFresnelTerm)) {
    add_to_survey(pixel, 0u);
    return;
  }
  const vec3 to_eye = direction_to_eye();
  const float facing = clamp(dot(seen_normal(to_eye), to_eye), 0.0, 1.0);
  uint depth_units = 0u;
  if (has_term(kDepthSurvey)) {
    const Surface surface = surface_here();
    const float alpha = seen_opacity(surface, base_color(surface).a, facing);
    depth_units = uint(kDepthUnits * rounded_depth(alpha) + 0.5);
  }
  add_to_survey(pixel, depth_units);
  // The upper 24 of the 30 bits of the depth, then how much the surface faces the eye. The least value is
  // kept as the maximum of complements, because the survey begins with zeros.
  if (has_term(kFresnelTerm))
    atomicMax(survey[nearest_word(pixel)], ~(floatBitsToUint(gl_FragCoord.z) >> 6 << 8 | uint(255.0 * facing + 0.5)));
}
