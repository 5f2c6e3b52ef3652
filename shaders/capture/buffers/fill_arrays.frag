#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "counters.glsl"
// Fills an array of kK nodes for every pixel, in draw order. A has the number of fragments so far. C has the
// depths of all nodes, then their ids and colours.
layout(std430, set = 0, binding = SLOT_A) buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = SLOT_C) writeonly buffer Nodes { uint nodes[]; };
void main() {
  const uint pixel = fragment_pixel();
  const uint place = atomicAdd(counts[pixel], 1u);
  if (place >= kK) {
    atomicAdd(counters.overflowed, 1u);
    return;
  }
  const uint node = pixel * kK + place;
  nodes[node] = floatBitsToUint(gl_FragCoord.z);
  const uint word = kK * pixel_count() + 2u * node;
  nodes[word] = fragment_id();
  nodes[word + 1u] = fragment_color();
}
