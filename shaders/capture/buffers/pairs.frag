#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "scene/fragment_input.glsl"
#include "capture/keys.glsl"
#include "capture/buffers/depth_bins.glsl"
layout(std430, set = 0, binding = SLOT_B) readonly buffer Bounds { uint bounds[]; };
layout(std430, set = 0, binding = SLOT_D) readonly buffer Bins { uint bins[]; };

// Returns the bucket of a fragment: uniform (kVariant 0) or adaptive (1).
uint pair_bucket(uint pixel, float z) {
  const uint nearest = bounds[2u * pixel];
  const uint farthest = bounds[2u * pixel + 1u];
  if (kVariant == 0u) return bucket_of(z, nearest, farthest, kK);
  const uint bin = bin_of(z, nearest, farthest);
  const uint first = bins_of(pixel) + kWords;
  uint bucket = 0u;
  while (bucket + 1u < kK && bin >= bins[first + bucket]) ++bucket;
  return bucket;
}

#if defined(KEYS)
// Finds the nearest and farthest fragment of every bucket. A has two keys per bucket, which start at kNoKey
// and 0.
layout(std430, set = 0, binding = SLOT_A) buffer Keys { uint64_t keys[]; };
void main() {
  const uint pixel = fragment_pixel();
  const uint slot = 2u * (kK * pixel + pair_bucket(pixel, gl_FragCoord.z));
  const uint64_t key = make_key(gl_FragCoord.z, fragment_id());
  atomicMin(keys[slot], key);
  atomicMax(keys[slot + 1u], key);
}
#endif

#if defined(COLORS)
// Stores the colours (C) of the fragments whose keys were kept (A).
layout(std430, set = 0, binding = SLOT_A) readonly buffer Keys { uint64_t keys[]; };
layout(std430, set = 0, binding = SLOT_C) writeonly buffer Colors { uint colors[]; };
void main() {
  const uint pixel = fragment_pixel();
  const uint slot = 2u * (kK * pixel + pair_bucket(pixel, gl_FragCoord.z));
  const uint64_t key = make_key(gl_FragCoord.z, fragment_id());
  if (keys[slot] == key) colors[slot] = fragment_color();
  else if (keys[slot + 1u] == key) colors[slot + 1u] = fragment_color();
}
#endif
