#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
// Draws opaque surfaces before anything is captured (scene/opaque.glsl).
layout(location = 0) out uvec2 nearest;
void main() { nearest = uvec2(floatBitsToUint(gl_FragCoord.z) + 1u, fragment_color()); }
