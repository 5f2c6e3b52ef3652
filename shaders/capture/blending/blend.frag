#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
// Outputs the premultiplied colour for blending "under" what was drawn before. It is rounded like the colours
// of all techniques.
layout(location = 0) out vec4 color;
void main() {
  const vec4 c = unpack_color(fragment_color());
  color = vec4(c.rgb * c.a, c.a);
}
