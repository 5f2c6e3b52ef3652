// What vertices hand to fragments beside their place: texture coordinates and colours, where a scene has some.
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
