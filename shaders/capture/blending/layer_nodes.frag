#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
// Multi-layer alpha blending: keeps SLOTS nodes in order of depth. When there is one node too many, the two
// farthest are merged. A fragment that comes between merged ones later cannot be put in its place, so the
// result depends on the draw order. Based on: Salvi, Vaidyanathan, I3D 2014.
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
