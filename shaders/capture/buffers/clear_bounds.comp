#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
// Clears the bounds: the nearest depth (bits) is larger than any depth, the farthest smaller.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_B) writeonly buffer Bounds { uint bounds[]; };
void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, frame.size))) return;
  const uint pixel = pixel_index(gl_GlobalInvocationID.xy);
  bounds[2u * pixel] = kNone;
  bounds[2u * pixel + 1u] = 0u;
}
