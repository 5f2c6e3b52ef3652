#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "counters.glsl"
#if defined(MARKED)
layout(early_fragment_tests) in;  // fragments that fail the stencil test must not be stored
#endif
// S-buffer, second pass: stores each fragment in the range of its pixel. B says where the next one goes. C
// has the depths of all nodes, then their ids and colours. push.p3 is the number of nodes.
layout(std430, set = 0, binding = SLOT_B) buffer Ends { uint ends[]; };
layout(std430, set = 0, binding = SLOT_C) writeonly buffer Nodes { uint nodes[]; };
void main() {
  const uint place = atomicAdd(ends[fragment_pixel()], 1u);
  if (place >= push.p3) {
    atomicAdd(counters.overflowed, 1u);
    return;
  }
  nodes[place] = floatBitsToUint(gl_FragCoord.z);
  const uint word = push.p3 + 2u * place;
  nodes[word] = fragment_id();
  nodes[word + 1u] = fragment_color();
}
