// The tail of a place: sums in one slot, of three kinds, or in two slots.
#ifndef PLACE_TAIL_GLSL
#define PLACE_TAIL_GLSL
#include "capture/k_buffers/places.glsl"
#include "capture/k_buffers/weighted_tail.glsl"
const uint kTailBits = 16u;
bool has_weights(Place place) { return kVariant == kMappedWithWeights && place.tail != kManyFragments; }
// push.p1 is the range for the deepest pixel.
uint tail_range(Place place) { return kVariant == kMappedWithWeights ? push.p1 : place.tail; }
float opacity_scale(Place place) { return tail_scale(kTailBits, tail_range(place) - kMostDepthBits); }
float depth_scale(Place place) { return tail_scale(32u, tail_range(place)); }

// Returns the units of the first of two slots, if opacities are the weights: red, green, blue, opacity. The
// second slot has the optical depth.
uvec2 units_by_opacity(uint color, Place place, float rounding) {
  const float scale = opacity_scale(place);
  const uvec4 units = uvec4(floor(opacity_share(color) * scale + (scale >= 1.0 ? rounding : 0.0)));
  return uvec2(units.x | units.y << 16, units.z | units.w << 16);
}
uvec2 units_of_depth(uint color, Place place, float rounding) {
  return uvec2(tail_units(tail_share(color), depth_scale(place), rounding).w, 0u);
}

// Returns what a fragment adds to the tail. `last` is the depth of the last fragment that was kept.
uvec2 units_in_place(Place place, uint color, float z, float last, float rounding) {
  const vec4 share = tail_share(color);
  if (has_weights(place)) return weighted_units(share, light_in_tail(z, last, place.tail), place.tail, rounding);
  const uvec4 units = tail_units(share, tail_scale(kTailBits, tail_range(place)), rounding);
  return uvec2(units.x | units.y << 16, units.z | units.w << 16);
}

vec4 four_sums(uvec2 sums) { return vec4(sums.x & 0xFFFFu, sums.x >> 16, sums.y & 0xFFFFu, sums.y >> 16); }

// Returns the premultiplied colour and transmittance of the tail. `depth` is the second slot, if there is
// one.
vec4 layer_in_place(Place place, uvec2 slot, uvec2 depth) {
  const uvec2 sums = sums_in(slot);
  if (has_weights(place)) return weighted_layer(sums, place.tail);
  const vec4 four = four_sums(sums);
  if (kVariant != kUniformWithOpacities) return tail_layer(four, tail_scale(kTailBits, tail_range(place)));
  return layer_of_sums(four.rgb, four.w, float(sums_in(depth).x) / depth_scale(place));
}
#endif
