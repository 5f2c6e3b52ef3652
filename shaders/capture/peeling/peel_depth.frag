#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "capture/peeling/peeled.glsl"
// Front to back, first pass: the depth test finds the next layer. With RESUMES it finds the last layer again
// if that has fragments left (B of layers.glsl).
#if defined(RESUMES)
layout(std430, set = 0, binding = SLOT_B) readonly buffer Windows { uvec2 windows[]; };
#endif
void main() {
#if defined(RESUMES)
  const bool resumed = windows[fragment_pixel()].x != 0u;
#else
  const bool resumed = false;
#endif
  if (is_peeled(resumed)) discard;
}
