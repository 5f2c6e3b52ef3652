#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "../interface/counters.glsl"
#include "places.glsl"
#include "../resolve/effects.glsl"
#include "../resolve/tally.glsl"
// Fold the fragments of every pixel, which are in depth order already, and its tail behind them.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_PICTURE) writeonly buffer Picture { vec4 picture[]; };
#ifdef MEASURE
#include "residue.glsl"
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
    uint run = 0u;  // fragments at the depth of the last one, beside it
    bool done = false;
    for (; captured < place.keys; ++captured) {
      const uint64_t slot = pool[place.first + captured];
      if (slot == kNoKey) break;
      const uint depth = slot_depth(slot);
      run = depth == previous ? run + 1u : 0u;
      if (run > 0u) coplanar += run == 1u ? 2u : 1u;
      previous = depth;
      const uint low = key_id(slot);
      if (!done) effect_step(state, pixel, Fragment(uintBitsToFloat(depth), low, low));
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
    picture[pixel] = effect_finish(state, pixel);
    tally(captured, coplanar, true, false);
  }
  end_tally();
}
