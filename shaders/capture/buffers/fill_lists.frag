#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "counters.glsl"
// Fills linked lists. A has kK heads (buckets) per pixel, C has nodes (depth, id, colour, next). With several
// buckets, B has the bounds of the depths of a pixel (bits), and the bucket depends on the depth of the
// fragment between them.
layout(std430, set = 0, binding = SLOT_A) buffer Heads { uint heads[]; };
layout(std430, set = 0, binding = SLOT_B) readonly buffer Bounds { uint bounds[]; };
layout(std430, set = 0, binding = SLOT_C) writeonly buffer Nodes { uvec4 nodes[]; };
#include "capture/buffers/buckets.glsl"
void main() {
  const uint node = atomicAdd(counters.next_node, 1u);
  if (node >= frame.capacity) {
    atomicAdd(counters.overflowed, 1u);
    return;
  }
  const uint pixel = fragment_pixel();
  uint head = pixel;
  if (kK > 1u) head = kK * pixel + bucket_of(gl_FragCoord.z, bounds[2u * pixel], bounds[2u * pixel + 1u], kK);
  const uint next = atomicExchange(heads[head], node);
  nodes[node] = uvec4(floatBitsToUint(gl_FragCoord.z), fragment_id(), fragment_color(), next);
}
