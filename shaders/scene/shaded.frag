#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "counters.glsl"
// Counts the fragments that pass the depth test, which are those that an opaque draw shades.
layout(early_fragment_tests) in;
void main() { atomicAdd(counters.captured, 1u); }
