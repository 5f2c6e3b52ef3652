#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "counters.glsl"
#include "capture/keys.glsl"
#include "capture/buffers/shares.glsl"
#include "capture/buffers/overflow_tail.glsl"
#include "resolve/effects.glsl"
#include "resolve/tally.glsl"
// Folds the keys (A) and colours (C) of the share of every pixel, which are in depth order already, and
// empties the share for the next round. The last key (B) says where that round begins. For finished pixels it
// lies behind everything.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_FINAL_COLORS) writeonly buffer FinalColors { vec4 final_colors[]; };
layout(std430, set = 0, binding = SLOT_STATE_FRONT) buffer States { State states[]; };
layout(std430, set = 0, binding = SLOT_A) buffer Keys { uint64_t keys[]; };
layout(std430, set = 0, binding = SLOT_B) buffer Last { uint64_t last[]; };
layout(std430, set = 0, binding = SLOT_C) readonly buffer Colors { uint colors[]; };

void finish(uint pixel, State state) {
  if (kVariant == kLosesFragments && effect_blends()) effect_merge(state, State(tail_layer(pixel), uvec4(0u)));
  final_colors[pixel] = effect_finish(state, pixel);
}

void fold_share(uint pixel, Share share) {
  State state = effect_init();
  uint64_t previous = uint64_t(0);
  uint run = 0u;  // number of further fragments at the depth of the last one
  bool pixel_counted = false;
  if (push.round > 0u) {
    state = states[pixel];
    previous = last[pixel] & kKeyBits;
    run = (last[pixel] & kCountedFragment) != uint64_t(0) ? 1u : 0u;
    pixel_counted = (last[pixel] & kCountedPixel) != uint64_t(0);
  }
  uint captured = 0u;
  uint coplanar = 0u;
  bool opaque = effect_is_done(state);
  for (; captured < share.count; ++captured) {
    const uint at = share.first + captured;
    const uint64_t key = keys[at];
    if (key == kNoKey) break;
    keys[at] = kNoKey;
    const bool same = previous != uint64_t(0) && uint(key >> 32) == uint(previous >> 32);
    run = same ? run + 1u : 0u;
    if (same) coplanar += run == 1u ? 2u : 1u;
    previous = key;
    if (!opaque) effect_step(state, pixel, Fragment(key_depth(key), key_id(key), colors[at]));
    opaque = opaque || effect_is_done(state);
  }
  const bool done = captured < share.count || push.p2 == kLastRound;
  if (done) {
    last[pixel] = kNoKey;
    finish(pixel, state);
  } else {
    states[pixel] = state;
    last[pixel] = previous | (run > 0u ? kCountedFragment : uint64_t(0)) |
                  (pixel_counted || coplanar > 0u ? kCountedPixel : uint64_t(0));
  }
  tally(captured, coplanar, !pixel_counted, !done);
}

void main() {
  begin_tally();
  if (all(lessThan(gl_GlobalInvocationID.xy, frame.size))) {
    const uint pixel = pixel_index(gl_GlobalInvocationID.xy);
    const Share share = share_of(pixel);
    if (share.count == 0u) finish(pixel, effect_init());
    else if (share.in_window && (push.round == 0u || last[pixel] != kNoKey)) fold_share(pixel, share);
  }
  end_tally();
}
