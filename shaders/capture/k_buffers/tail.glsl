// The tail of a pixel: the fragments that found no place, as one translucent layer behind those that did. Its
// transmittance is the product of theirs. Its colour is their mean, weighted by optical depth -log2(1 -
// alpha), which is what layers of a fine mixture of them would show. Sums are integers, so the draw order
// does not matter. A hash of the fragment decides whether it is rounded up or down, so that errors cancel.
// Based on: Maule, Comba, Torchelsen, Bastos, "Hybrid Transparency", I3D 2013.
#ifndef TAIL_GLSL
#define TAIL_GLSL
// The optical depth of an opaque fragment, which counts as one of opacity 255/256. It must be a power of two.
const float kMostDepth = 8.0;
const uint kMostDepthBits = 3u;

float optical_depth(float alpha) { return min(-log2(max(1.0 - alpha, 1.0 / 256.0)), kMostDepth); }
// Returns the optical depth after opacity was rounded to 8 bits. It is never less than that, even if another
// shader rounds the last place differently.
float rounded_depth(float alpha) { return optical_depth(floor(255.0 * alpha + 0.501) / 255.0); }

// Returns what a fragment adds to the sums: half its colour times its optical depth, and the optical depth.
vec4 tail_share(uint color) {
  const vec4 c = unpack_color(color);
  return vec4(0.5 * c.rgb, 1.0) * optical_depth(c.a);
}

// Returns the same, weighted by opacity as in the paper.
vec4 opacity_share(uint color) {
  const vec4 c = unpack_color(color);
  return vec4(0.5 * c.rgb, 1.0) * c.a;
}

// Returns a multiple of 1/32 below 1 as the rounding offset.
float tail_rounding(uint pixel, uint id) {
  uint x = id * 0x9E3779B1u ^ pixel * 0x85EBCA77u;
  x ^= x >> 15;
  x *= 0x2C1B3C6Du;
  x ^= x >> 12;
  return float(x >> 27) / 32.0;
}

// Returns the number of units in 1, for fields of `bits` bits and sums below 2^(range - kRangeBias).
const int kRangeBias = 8;
float tail_scale(uint bits, uint range) { return exp2(float(int(bits) - int(range) + kRangeBias)); }
// Returns the range for this number of fragments. Rounding cannot exceed it, because the most that a fragment
// adds is a whole number of units.
uint bits_of(uint count) { return count == 0u ? 0u : uint(findMSB(count)) + 1u; }
uint range_of(uint count) { return bits_of(count) + kMostDepthBits + uint(kRangeBias); }
uvec4 tail_units(vec4 share, float scale, float rounding) {
  return uvec4(floor(share * scale + (scale * kMostDepth >= 2.0 ? rounding : 0.0)));
}

// Returns the premultiplied colour and transmittance of a layer, from sums of weighted colours, weights, and
// optical depths.
vec4 layer_of_sums(vec3 color, float weight, float depth) {
  const float transmittance = exp2(-depth);
  return vec4((1.0 - transmittance) * 2.0 * color / max(weight, 1.0), transmittance);
}
// Returns the same if optical depths are the weights.
vec4 tail_layer(vec4 sums, float scale) { return layer_of_sums(sums.rgb, sums.w, sums.w / scale); }
#endif
