#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "../interface/fragment_input.glsl"
#define HALVES
#include "slots.glsl"
#include "halves_chain.glsl"
// Second pass over the same fragments: which of them the depths are of (depths.frag).
void main() { insert_id(place_of(fragment_pixel()), floatBitsToUint(gl_FragCoord.z), fragment_id()); }
