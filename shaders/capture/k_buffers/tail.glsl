// The tail of a pixel: fragments that found no place, as one translucent layer behind those that did. Transmittance is
// the product of theirs, colour their mean weighted by optical depth -log2(1 - alpha): what layers of a fine mixture of
// them would show. Sums of integers, so that draw order does not matter; rounded up or down by a hash of
// the fragment, so that errors cancel.
// Hybrid transparency: Maule, Comba, Torchelsen, Bastos, I3D 2013.
#ifndef TAIL_GLSL
#define TAIL_GLSL
// Optical depth of an opaque fragment, for which that of 255/256 is taken; a power of two.
const float kMostDepth = 8.0;
const uint kMostDepthBits = 3u;

float optical_depth(float alpha) { return min(-log2(max(1.0 - alpha, 1.0 / 256.0)), kMostDepth); }
// As it is once opacity was rounded to 8 bits; never less, where another shader rounds otherwise in the last place.
float rounded_depth(float alpha) { return optical_depth(floor(255.0 * alpha + 0.501) / 255.0); }

// What a fragment adds: half its colour times its optical depth, and the latter.
vec4 tail_share(uint color) {
  const vec4 c = unpack_color(color);
  return vec4(0.5 * c.rgb, 1.0) * optical_depth(c.a);
}

// The same weighted by opacity, as in the paper.
vec4 opacity_share(uint color) {
  const vec4 c = unpack_color(color);
  return vec4(0.5 * c.rgb, 1.0) * c.a;
}

// Multiples of 1/32 below 1.
float tail_rounding(uint pixel, uint id) {
  uint x = id * 0x9E3779B1u ^ pixel * 0x85EBCA77u;
  x ^= x >> 15;
  x *= 0x2C1B3C6Du;
  x ^= x >> 12;
  return float(x >> 27) / 32.0;
}

// Units of 1, in fields of `bits` bits for sums below 2^(range - kRangeBias).
const int kRangeBias = 8;
float tail_scale(uint bits, uint range) { return exp2(float(int(bits) - int(range) + kRangeBias)); }
// The range of so many fragments, which no rounding gets out of: the most of each is a whole number of units.
uint bits_of(uint count) { return count == 0u ? 0u : uint(findMSB(count)) + 1u; }
uint range_of(uint count) { return bits_of(count) + kMostDepthBits + uint(kRangeBias); }
uvec4 tail_units(vec4 share, float scale, float rounding) {
  return uvec4(floor(share * scale + (scale * kMostDepth >= 2.0 ? rounding : 0.0)));
}

// Premultiplied colour and transmittance of a layer, from sums of weighted colours, of weights, and of optical depths.
vec4 layer_of_sums(vec3 color, float weight, float depth) {
  const float transmittance = exp2(-depth);
  return vec4((1.0 - transmittance) * 2.0 * color / max(weight, 1.0), transmittance);
}
// Where optical depths are the weights.
vec4 tail_layer(vec4 sums, float scale) { return layer_of_sums(sums.rgb, sums.w, sums.w / scale); }
#endif
