#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "../interface/fragment_input.glsl"
#include "moments.glsl"
// Second pass: colours by the light that gets to them.
layout(set = 0, binding = SLOT_IMAGE_1) uniform texture2D depth_sums;
layout(set = 0, binding = SLOT_IMAGE_2) uniform texture2D moments;
layout(location = 0) out vec4 sums;
void main() {
  const ivec2 place = ivec2(gl_FragCoord.xy);
  const vec4 c = unpack_color(fragment_color());
  const float light =
      light_at(moment_depth(gl_FragCoord.z), texelFetch(moments, place, 0), texelFetch(depth_sums, place, 0).r);
  sums = vec4(c.rgb, 1.0) * (c.a * light);
}
