#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "counters.glsl"
#include "resolve/marked_tiles.glsl"
// As buffers/offsets.comp where few pixels have fragments, with a workgroup for each of their tiles: from counts (A) to
// the first node of each of them (B), with an atomic addition for each. Nobody asks where the ranges of the others begin.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_A) readonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = SLOT_B) writeonly buffer Ends { uint ends[]; };
void main() {
  const uvec2 pixel = 8u * marked_tile(gl_WorkGroupID.x) + gl_LocalInvocationID.xy;
  if (any(greaterThanEqual(pixel, frame.size))) return;
  const uint count = counts[pixel_index(pixel)];
  if (count > 0u) ends[pixel_index(pixel)] = atomicAdd(counters.next_node, count);
}
