#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
// Multi-layer alpha blending: SLOTS nodes in order of depth; where one too many comes, the two farthest become one.
// Salvi, Vaidyanathan, I3D 2014. What was merged stays so, whatever comes between: it depends on draw order.
#include "capture/blending/layer_nodes.glsl"
#define ATTACHMENTS 3  // four nodes of three words
#include "capture/ordered_words.glsl"

void main() {
  EACH(LOAD)
  const vec4 c = unpack_color(fragment_color());
  uvec3 carried = layer_node(floatBitsToUint(gl_FragCoord.z), vec4(c.rgb * c.a, 1.0 - c.a));
  for (uint i = 0u; i < SLOTS; ++i) {
    const uvec3 here = slot_at(i);
    const bool nearer = carried.x < here.x;
    if (nearer) put_slot(i, carried);
    carried = nearer ? here : carried;
  }
  if (carried.x != kNone) {
    const uvec3 last = slot_at(SLOTS - 1u);
    put_slot(SLOTS - 1u, layer_node(last.x, layer_over(node_layer(last), node_layer(carried))));
  }
  EACH(STORE)
}
