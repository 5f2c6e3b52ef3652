#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "counters.glsl"
#include "resolve/marked_tiles.glsl"
// Does what buffers/offsets.comp does, for few pixels with fragments. There is one workgroup for each marked
// tile. Counts (A) become the first node of each pixel (B), with one atomic addition per pixel. Ranges of
// other pixels are not read.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_A) readonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = SLOT_B) writeonly buffer Ends { uint ends[]; };
void main() {
  const uvec2 pixel = 8u * marked_tile(gl_WorkGroupID.x) + gl_LocalInvocationID.xy;
  if (any(greaterThanEqual(pixel, frame.size))) return;
  const uint count = counts[pixel_index(pixel)];
  if (count > 0u) ends[pixel_index(pixel)] = atomicAdd(counters.next_node, count);
}
