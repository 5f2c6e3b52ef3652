#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "counters.glsl"
// Turns counts (A) into the first node of every pixel (B): a scan within each tile of 8 x 8 pixels, and one
// atomic addition per tile. The ranges of a tile are contiguous. The place of a tile depends on timing, the
// image does not.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_A) readonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = SLOT_B) writeonly buffer Ends { uint ends[]; };
shared uint sums[64];
shared uint base;
void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  const bool inside = all(lessThan(pixel, frame.size));
  const uint lane = gl_LocalInvocationIndex;
  const uint count = inside ? counts[pixel_index(pixel)] : 0u;
  sums[lane] = count;
  barrier();
  for (uint step = 1u; step < 64u; step *= 2u) {
    const uint left = lane >= step ? sums[lane - step] : 0u;
    barrier();
    sums[lane] += left;
    barrier();
  }
  if (lane == 63u) base = atomicAdd(counters.next_node, sums[63]);
  barrier();
  if (inside) ends[pixel_index(pixel)] = base + sums[lane] - count;
}
