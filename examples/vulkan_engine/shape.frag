#version 450
layout(push_constant) uniform Frame {
  mat4 clip_from_world;
  vec4 eye;
};
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 outward;
layout(location = 0) out vec4 color;

void main() {
  const vec3 to_eye = normalize(eye.xyz - place);
  // A back-facing copy has the vertices, and so the normals, of its triangle.
  vec3 normal = normalize(outward);
  if (dot(normal, to_eye) < 0) normal = -normal;
  const float facing = dot(normal, to_eye);
  // Tinted glass: the colour depends on the direction from the centre, and the glass is more opaque at its edges.
  const float angle = atan(place.y, place.x);
  const vec3 tint = 0.5 + 0.45 * cos(angle + vec3(0, 2.1, 4.2));
  color = vec4(tint * (0.35 + 0.65 * facing), mix(0.85, 0.45, facing));
}
