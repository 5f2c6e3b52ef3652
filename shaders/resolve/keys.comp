#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "counters.glsl"
#include "capture/keys.glsl"
#include "resolve/effects.glsl"
#include "resolve/tally.glsl"
// Folds kK slots of a pixel, which are in depth order already. They are keys (A) and colours (C), or three
// words each: WORDS of a buffer (A), or LAYERS of an image with four words each.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_FINAL_COLORS) writeonly buffer FinalColors { vec4 final_colors[]; };
#if defined(WORDS) || defined(LAYERS)
#if defined(WORDS)
layout(std430, set = 0, binding = SLOT_A) readonly buffer Slots { uint words[]; };
uint word_of(uvec2 pixel, uint i) { return words[3u * kK * pixel_index(pixel) + i]; }
#else
layout(set = 0, binding = SLOT_IMAGE_0) uniform utexture2DArray layers;
uint word_of(uvec2 pixel, uint i) { return texelFetch(layers, ivec3(pixel, i / 4u), 0)[i % 4u]; }
#endif
// No fragment has the id kNone.
uint64_t key_of(uvec2 pixel, uint slot) {
  return (uint64_t(word_of(pixel, 3u * slot)) << 32) | uint64_t(word_of(pixel, 3u * slot + 1u));
}
uint color_of(uvec2 pixel, uint slot) { return word_of(pixel, 3u * slot + 2u); }
#else
layout(std430, set = 0, binding = SLOT_A) readonly buffer Keys { uint64_t keys[]; };
layout(std430, set = 0, binding = SLOT_C) readonly buffer Colors { uint colors[]; };
uint64_t key_of(uvec2 pixel, uint slot) { return keys[kK * pixel_index(pixel) + slot]; }
uint color_of(uvec2 pixel, uint slot) { return colors[kK * pixel_index(pixel) + slot]; }
#endif

void main() {
  begin_tally();
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (all(lessThan(pixel, frame.size))) {
    const uint index = pixel_index(pixel);
    State state = effect_init();
    uint64_t previous = uint64_t(0);
    uint run = 0u;  // number of further fragments at the depth of the last one
    uint captured = 0u;
    uint coplanar = 0u;
    bool done = false;
    for (uint i = 0u; i < kK; ++i) {
      const uint64_t key = key_of(pixel, i);
      if (key == kNoKey || key == uint64_t(0) || key == previous) continue;
      const bool same = previous != uint64_t(0) && uint(key >> 32) == uint(previous >> 32);
      run = same ? run + 1u : 0u;
      if (same) coplanar += run == 1u ? 2u : 1u;
      previous = key;
      ++captured;
      if (!done) effect_step(state, index, Fragment(key_depth(key), key_id(key), color_of(pixel, i)));
      done = done || effect_is_done(state);
    }
    final_colors[index] = effect_finish(state, index);
    tally(captured, coplanar, true, false);
  }
  end_tally();
}
