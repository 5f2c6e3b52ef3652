#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "../interface/fragment_input.glsl"
#define HALVES
#include "slots.glsl"
#include "halves_chain.glsl"
// The depths of the nearest fragments of a pixel, as many as it has slots for.
void main() { insert_depth(place_of(fragment_pixel()), floatBitsToUint(gl_FragCoord.z)); }
