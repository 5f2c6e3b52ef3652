#version 460
#extension GL_GOOGLE_include_directive : require
#if defined(LAYERED)
#extension GL_ARB_shader_viewport_layer_array : require
#endif
#include "frame.glsl"
// The only vertex shader, so that the depths of all passes agree to the bit. With LAYERED, instance i goes to
// layer i of the attachments.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 0) out vec3 world_position;
layout(location = 1) out vec3 world_normal;
invariant gl_Position;

// Texture coordinates and colours, if the scene has any.
layout(location = 2) out vec2 texcoord;
layout(location = 3) out vec4 vertex_color;
layout(std430, set = 0, binding = SLOT_ATTRIBUTES) readonly buffer Attributes { float attributes[]; };

void hand_on_look() {
  texcoord = vec2(0.0);
  vertex_color = vec4(1.0);
  if (!has_feature(kColored)) return;
  const uint first = 6u * uint(gl_VertexIndex);
  texcoord = vec2(attributes[first], attributes[first + 1u]);
  vertex_color = vec4(attributes[first + 2u], attributes[first + 3u], attributes[first + 4u], attributes[first + 5u]);
}

void main() {
  gl_Position = frame.clip_from_world * vec4(position, 1.0);
#if defined(LAYERED)
  gl_Layer = gl_InstanceIndex;
#endif
  world_position = position;
  world_normal = normal;
  hand_on_look();
}
