#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "../interface/fragment_input.glsl"
#include "moments.glsl"
// First pass: what of the light gets where.
layout(location = 0) out vec4 moments;
layout(location = 1) out float depth_sum;
void main() {
  depth_sum = optical_depth(unpack_color(fragment_color()).a, kMostDepth);
  moments = moments_of(moment_depth(gl_FragCoord.z), depth_sum);
}
