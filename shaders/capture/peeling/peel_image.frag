#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "capture/peeling/peeled.glsl"
// Front to back, one fragment (id, colour) of the next layer. The depth test decides which one.
layout(location = 0) out uvec2 found;
void main() {
  found = uvec2(fragment_id(), fragment_color());
  if (is_peeled(false)) discard;
}
