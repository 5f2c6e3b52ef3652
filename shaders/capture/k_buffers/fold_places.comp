#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "counters.glsl"
#include "resolve/effects.glsl"
#include "resolve/tally.glsl"
// Folds the fragments of every pixel, which are in depth order already, and its tail behind them. They come
// from the place of the pixel in the pool, or from the LAYERS of an image.
#ifdef LAYERS
#include "capture/k_buffers/core_layers.glsl"
layout(set = 0, binding = SLOT_IMAGE_0) uniform utexture2DArray layers;
struct Place {
  uint keys, tail;
  ivec2 at;
};
Place place_of(uint pixel) { return Place(kK, 1u, ivec2(pixel % frame.size.x, pixel / frame.size.x)); }
uint word_at(Place place, uint i) { return texelFetch(layers, ivec3(place.at, i / 4u), 0)[i % 4u]; }
bool kept_at(Place place, uint i, out Fragment f) {
  f = Fragment(uintBitsToFloat(word_at(place, 3u * i)), word_at(place, 3u * i + 1u), word_at(place, 3u * i + 2u));
  return f.id != kNone;
}
vec4 layer_of_tail(Place place) {
  float sums[5];
  for (uint i = 0u; i < kSumWords; ++i) sums[i] = float(word_at(place, kTailWord + i) + 1u);
  return layer_of_sums(vec3(sums[0], sums[1], sums[2]), sums[3], sums[kSumWords - 1u] / sum_scale());
}
#else
#include "capture/k_buffers/place_tail.glsl"
layout(std430, set = 0, binding = SLOT_A) readonly buffer Pool { uvec2 pool[]; };
bool kept_at(Place place, uint i, out Fragment f) {
  const uvec2 slot = pool[place.first + i];
  f = Fragment(uintBitsToFloat(depth_of(slot)), slot.x, slot.x);
  return !is_empty(slot);
}
vec4 layer_of_tail(Place place) {
  const uint tail = place.first + place.keys;
  return layer_in_place(place, pool[tail], kVariant == kUniformWithOpacities ? pool[tail + 1u] : uvec2(kNone));
}
#endif
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_FINAL_COLORS) writeonly buffer FinalColors { vec4 final_colors[]; };
#ifdef MEASURE
// Importance for the next frame (E), one byte per pixel. It depends on how much the tail covers of the light
// that the fragments in front of it let through. It grows if more than kWanted is left to the tail, and
// shrinks otherwise (importance.comp).
layout(std430, set = 0, binding = SLOT_E) buffer Residues { uint residues[]; };
const float kWanted = 1.0 / 16.0;
void measure_residue(uint pixel, float residue) {
  const uint shift = 8u * (pixel % 4u);
  const int old = int(residues[pixel / 4u] >> shift & 255u);
  const int step = int(round(16.0 * log2((residue + kWanted / 4.0) / (1.25 * kWanted))));
  const int now = clamp(old + step, 0, 255);
  atomicXor(residues[pixel / 4u], uint(old ^ now) << shift);
}
#endif

void main() {
  begin_tally();
  const uvec2 at = gl_GlobalInvocationID.xy;
  if (all(lessThan(at, frame.size))) {
    const uint pixel = pixel_index(at);
    const Place place = place_of(pixel);
    State state = effect_init();
    uint captured = 0u;
    uint coplanar = 0u;
    uint previous = kNone;
    uint run = 0u;  // number of further fragments at the depth of the last one
    bool done = false;
    for (; captured < place.keys; ++captured) {
      Fragment f;
      if (!kept_at(place, captured, f)) break;
      const uint depth = floatBitsToUint(f.z);
      run = depth == previous ? run + 1u : 0u;
      if (run > 0u) coplanar += run == 1u ? 2u : 1u;
      previous = depth;
      if (!done) effect_step(state, pixel, f);
      done = done || effect_is_done(state);
    }
    if (place.tail > 0u && effect_blends()) {
      const vec4 layer = layer_of_tail(place);
#ifdef MEASURE
      measure_residue(pixel, state.color.a * (1.0 - layer.a));
#endif
      transparency_merge(state, State(layer, uvec4(0u)));
    }
#ifdef MEASURE
    else measure_residue(pixel, 0.0);
#endif
    final_colors[pixel] = effect_finish(state, pixel);
    tally(captured, coplanar, true, false);
  }
  end_tally();
}
