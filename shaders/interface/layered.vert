#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_shader_viewport_layer_array : require
#include "frame.glsl"
#include "vertex.glsl"
// As scene.vert; instance i goes to layer i of the attachments.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 0) out vec3 world_position;
layout(location = 1) out vec3 world_normal;
invariant gl_Position;

void main() {
  gl_Position = frame.clip_from_world * vec4(position, 1.0);
  gl_Layer = gl_InstanceIndex;
  world_position = position;
  world_normal = normal;
  hand_on_look();
}
