#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "vertex.glsl"
// The one vertex shader: depths of all passes agree to the bit.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 0) out vec3 world_position;
layout(location = 1) out vec3 world_normal;
invariant gl_Position;

void main() {
  gl_Position = frame.clip_from_world * vec4(position, 1.0);
  world_position = position;
  world_normal = normal;
  hand_on_look();
}
