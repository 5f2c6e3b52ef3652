// A tail whose colours are weighted by the light that gets to them. What is in front of a fragment of the tail is not
// known, but the pixel's optical depth is, from the survey: if it is evenly spread from the last fragment that was kept to
// the far plane, a fragment at a share x of that way gets 2^-(x depth) of the light. Transmittance stays the product of
// all. Five sums in a word: red, green, blue and weight of 13 bits, optical depth of 12.
#ifndef WEIGHTED_TAIL_GLSL
#define WEIGHTED_TAIL_GLSL

// Sums of whole numbers in fields of 64 bits, which are two words, the lower one first.
uvec2 in_field(uint value, uint begin) {
  if (begin >= 32u) return uvec2(0u, value << (begin - 32u));
  return uvec2(value << begin, begin == 0u ? 0u : value >> (32u - begin));
}
uint field_of(uvec2 sums, uint begin, uint bits) {
  const uint mask = (1u << bits) - 1u;
  if (begin >= 32u) return sums.y >> (begin - 32u) & mask;
  return (sums.x >> begin | (begin == 0u ? 0u : sums.y << (32u - begin))) & mask;
}
// Sums begin at -1, as slots that nothing was put into do.
uvec2 sums_in(uvec2 slot) { return uvec2(slot.x + 1u, slot.y + (slot.x == kNone ? 1u : 0u)); }

#include "capture/k_buffers/tail.glsl"
const uint kWeightBits = 13u;
const uint kDepthBits = 12u;

// Sums are below 2^(code / 2 - 2), a little more than the pixel's optical depth, so that 255 fragments may be rounded up.
const uint kLastCode = 30u;
const uint kManyFragments = 31u;  // or too great a depth: a tail without weights
float bound_of(uint code) { return exp2(0.5 * float(code) - 2.0); }
uint code_of(float depth, uint fragments) {
  const float bound = depth * (16.0 / 15.0);
  if (fragments >= 256u || bound > bound_of(kLastCode)) return kManyFragments;
  return uint(clamp(ceil(2.0 * log2(bound) + 4.0), 1.0, float(kLastCode)));
}

// `last`: depth of the last fragment that was kept, 0 where there is none.
float light_in_tail(float z, float last, uint code) {
  const float kShareOfBound = 0.8;  // that the depth of the tail is, on average
  const float kMostExponent = 4.0;  // sums keep enough bits
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

// Premultiplied colour and transmittance of a layer. `sums`: of weighted_units().
vec4 weighted_layer(uvec2 sums, uint code) {
  const vec3 color = vec3(field_of(sums, 0u, 13u), field_of(sums, 13u, 13u), field_of(sums, 26u, 13u));
  const float depth = float(field_of(sums, 52u, 12u)) * bound_of(code) / exp2(float(kDepthBits));
  return layer_of_sums(color, float(field_of(sums, 39u, 13u)), depth);
}
#endif
