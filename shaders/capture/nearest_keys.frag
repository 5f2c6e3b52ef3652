#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "../interface/fragment_input.glsl"
#include "../interface/keys.glsl"
// The kK nearest fragments. A: kK keys a pixel, increasing.
layout(std430, set = 0, binding = SLOT_A) buffer Keys { uint64_t keys[]; };
#include "insert_key.glsl"
void main() { insert_key(kK * fragment_pixel(), kK, make_key(gl_FragCoord.z, fragment_id())); }
