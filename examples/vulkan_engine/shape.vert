#version 450
layout(push_constant) uniform Frame {
  mat4 clip_from_world;
  vec4 eye;
};
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 0) out vec3 place;
layout(location = 1) out vec3 outward;

void main() {
  place = position;
  outward = normal;
  gl_Position = clip_from_world * vec4(position, 1);
}
