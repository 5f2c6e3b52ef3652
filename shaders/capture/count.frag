#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#if defined(MARKED)
layout(early_fragment_tests) in;  // fragments that fail the stencil test must not be counted
#endif
// Counts the fragments of every pixel, without shading. A has one word per pixel.
layout(std430, set = 0, binding = SLOT_A) buffer Counts { uint counts[]; };
void main() { atomicAdd(counts[fragment_pixel()], 1u); }
