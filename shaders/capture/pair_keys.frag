#version 460
#extension GL_GOOGLE_include_directive : require
#include "../interface/frame.glsl"
#include "../interface/fragment_input.glsl"
#include "../interface/keys.glsl"
#include "buckets.glsl"
#include "depth_bins.glsl"
// The nearest and the farthest fragment of every bucket. A: two keys a bucket; they start at kNoKey and 0.
layout(std430, set = 0, binding = SLOT_A) buffer Keys { uint64_t keys[]; };
layout(std430, set = 0, binding = SLOT_B) readonly buffer Bounds { uint bounds[]; };
layout(std430, set = 0, binding = SLOT_D) readonly buffer Bins { uint bins[]; };
#include "pair_bucket.glsl"
void main() {
  const uint pixel = fragment_pixel();
  const uint slot = 2u * (kK * pixel + pair_bucket(pixel, gl_FragCoord.z));
  const uint64_t key = make_key(gl_FragCoord.z, fragment_id());
  atomicMin(keys[slot], key);
  atomicMax(keys[slot + 1u], key);
}
