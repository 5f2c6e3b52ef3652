#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/opaque.glsl"
// Turns weighted sums of colours into their mean, which is seen as one layer with the transmittance of all
// fragments.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_FINAL_COLORS) writeonly buffer FinalColors { vec4 final_colors[]; };
layout(set = 0, binding = SLOT_IMAGE_0) uniform texture2D sums;
layout(set = 0, binding = SLOT_IMAGE_1) uniform texture2D depth_sums;
void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, frame.size))) return;
  const ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  const uint pixel = pixel_index(gl_GlobalInvocationID.xy);
  const float kMostHalf = 65504.0;
  const vec4 sum = min(texelFetch(sums, place, 0), kMostHalf);
  const float transmittance = exp2(-texelFetch(depth_sums, place, 0).r);
  const vec3 mean = sum.a > 0.0 ? sum.rgb / sum.a : vec3(0.0);
  final_colors[pixel] = vec4(mix(mean, background_of(pixel), transmittance), 1.0 - transmittance);
}
