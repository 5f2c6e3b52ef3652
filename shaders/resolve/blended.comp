#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "../interface/opaque.glsl"
// What was blended front to back, over the background.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_PICTURE) writeonly buffer Picture { vec4 picture[]; };
layout(set = 0, binding = SLOT_IMAGE_0) uniform texture2D blended;
void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, frame.size))) return;
  const uint pixel = pixel_index(gl_GlobalInvocationID.xy);
  const vec4 c = texelFetch(blended, ivec2(gl_GlobalInvocationID.xy), 0);
  picture[pixel] = vec4(c.rgb + (1.0 - c.a) * background_of(pixel), c.a);
}
