// A tail whose colours are weighted by the light that reaches them. What lies in front of a fragment of the
// tail is not known, but the survey has the optical depth of the pixel. It is assumed to be evenly spread
// from the last fragment that was kept to the far plane, so a fragment at the share x of that distance gets
// 2^-(x depth) of the light. The transmittance is still the product of all. A slot holds five sums: red,
// green, blue and weight with 13 bits each, and optical depth with 12.
#ifndef WEIGHTED_TAIL_GLSL
#define WEIGHTED_TAIL_GLSL

// Integer sums in fields of 64 bits, which are two words, the lower one first.
uvec2 in_field(uint value, uint begin) {
  if (begin >= 32u) return uvec2(0u, value << (begin - 32u));
  return uvec2(value << begin, begin == 0u ? 0u : value >> (32u - begin));
}
uint field_of(uvec2 sums, uint begin, uint bits) {
  const uint mask = (1u << bits) - 1u;
  if (begin >= 32u) return sums.y >> (begin - 32u) & mask;
  return (sums.x >> begin | (begin == 0u ? 0u : sums.y << (32u - begin))) & mask;
}
// Sums begin at -1, because the bits of an empty slot are all set.
uvec2 sums_in(uvec2 slot) { return uvec2(slot.x + 1u, slot.y + (slot.x == kNone ? 1u : 0u)); }

#include "capture/k_buffers/tail.glsl"
const uint kWeightBits = 13u;
const uint kDepthBits = 12u;

// Sums are below 2^(code / 2 - 2). That is a little more than the optical depth of the pixel, so that 255
// fragments may be rounded up.
const uint kLastCode = 30u;
const uint kManyFragments = 31u;  // a tail without weights, also if the optical depth is too large
float bound_of(uint code) { return exp2(0.5 * float(code) - 2.0); }
uint code_of(float depth, uint fragments) {
  const float bound = depth * (16.0 / 15.0);
  if (fragments >= 256u || bound > bound_of(kLastCode)) return kManyFragments;
  return uint(clamp(ceil(2.0 * log2(bound) + 4.0), 1.0, float(kLastCode)));
}

// Returns the light that reaches a fragment of the tail. `last` is the depth of the last fragment that was
// kept, or 0 if there is none.
float light_in_tail(float z, float last, uint code) {
  const float kShareOfBound = 0.8;  // optical depth of the tail, on average, as a share of its bound
  const float kMostExponent = 4.0;  // so that sums keep enough bits
  const float begin = view_distance(last);
  const float way = view_distance(1.0) - begin;
  const float share = way > 0.0 ? clamp((view_distance(z) - begin) / way, 0.0, 1.0) : 0.0;
  return exp2(-min(kShareOfBound * bound_of(code) * share, kMostExponent));
}

uvec2 weighted_units(vec4 share, float light, uint code, float rounding) {
  const float bound = bound_of(code);
  const uvec4 units = uvec4(floor(light * share * (exp2(float(kWeightBits)) / bound) + rounding));
  const uint depth = uint(floor(share.w * (exp2(float(kDepthBits)) / bound) + rounding));
  return in_field(units.x, 0u) | in_field(units.y, 13u) | in_field(units.z, 26u) | in_field(units.w, 39u) |
         in_field(depth, 52u);
}

// Returns the premultiplied colour and transmittance of a layer. `sums` are those of weighted_units().
vec4 weighted_layer(uvec2 sums, uint code) {
  const vec3 color = vec3(field_of(sums, 0u, 13u), field_of(sums, 13u, 13u), field_of(sums, 26u, 13u));
  const float depth = float(field_of(sums, 52u, 12u)) * bound_of(code) / exp2(float(kDepthBits));
  return layer_of_sums(color, float(field_of(sums, 39u, 13u)), depth);
}
#endif
