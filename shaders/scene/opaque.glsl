// What opaque surfaces left (scene/opaque.frag): the bits of the nearest depth + 1, and its colour; 0 where
// there are none.
#ifndef OPAQUE_GLSL
#define OPAQUE_GLSL
layout(set = 0, binding = SLOT_OPAQUE) uniform utexture2D opaque_surfaces;

bool is_behind_opaque(ivec2 pixel, float z) {
  if (!has_feature(kBehindOpaque)) return false;
  const uint nearest = texelFetch(opaque_surfaces, pixel, 0).x;
  return nearest != 0u && floatBitsToUint(z) + 1u >= nearest;
}

// Returns the colour that is seen through everything that was captured.
vec3 background_of(uint pixel) {
  if (has_feature(kBehindOpaque)) {
    const uvec2 nearest = texelFetch(opaque_surfaces, ivec2(pixel % frame.size.x, pixel / frame.size.x), 0).xy;
    if (nearest.x != 0u) return unpack_color(nearest.y).rgb;
  }
  return frame.background.rgb;
}
#endif
