#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/opaque.glsl"
// Puts what was blended front to back over the background. With MARKS, it also lists the tiles that have
// marked pixels, by their stencils.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_FINAL_COLORS) writeonly buffer FinalColors { vec4 final_colors[]; };
layout(set = 0, binding = SLOT_IMAGE_0) uniform texture2D blended;
#if defined(MARKS)
layout(set = 0, binding = SLOT_IMAGE_1) uniform utexture2D stencils;
#include "resolve/marked_tiles.glsl"
void mark(ivec2 place) {
  if (texelFetch(stencils, place, 0).x != 0u) mark_tile(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x);
}
#else
void mark(ivec2 place) {}
#endif
void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, frame.size))) return;
  const ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  const uint pixel = pixel_index(gl_GlobalInvocationID.xy);
  const vec4 c = texelFetch(blended, place, 0);
  final_colors[pixel] = vec4(c.rgb + (1.0 - c.a) * background_of(pixel), c.a);
  mark(place);
}
