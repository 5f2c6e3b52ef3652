#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#if defined(MARKED)
layout(early_fragment_tests) in;  // what the stencil test keeps out leaves nothing here
#endif
// Fragments of every pixel: A, a word each. No shading.
layout(std430, set = 0, binding = SLOT_A) buffer Counts { uint counts[]; };
void main() { atomicAdd(counts[fragment_pixel()], 1u); }
