#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "../interface/counters.glsl"
// As offsets.comp where few pixels have fragments: from counts (A) to the first node of each of them (B), an atomic
// addition for each. Nobody asks where the ranges of the others begin.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_A) readonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = SLOT_B) writeonly buffer Ends { uint ends[]; };
layout(std430, set = 0, binding = SLOT_D) readonly buffer Marks { uint marks[]; };
void main() {
  if (marks[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] == 0u) return;
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, frame.size))) return;
  const uint count = counts[pixel_index(pixel)];
  if (count > 0u) ends[pixel_index(pixel)] = atomicAdd(counters.next_node, count);
}
