#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
// Stencil routing: the stencil test lets the n-th fragment of a pixel into layer n, once. The test comes
// after the shader, so discarded fragments are not counted.
layout(location = 0) out uvec4 node;
void main() { node = uvec4(floatBitsToUint(gl_FragCoord.z), fragment_id(), fragment_color(), 0u); }
