#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "capture/buffers/depth_bins.glsl"
// Finds the bins that begin a bucket, so that the numbers of occupied bins of all buckets differ by at most
// one.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = SLOT_D) buffer Bins { uint bins[]; };
void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, frame.size))) return;
  const uint first = bins_of(pixel_index(gl_GlobalInvocationID.xy));
  uint occupied = 0u;
  for (uint w = 0u; w < kWords; ++w) occupied += uint(bitCount(bins[first + w]));
  uint bucket = 1u;
  uint before_word = 0u;
  for (uint w = 0u; w < kWords; ++w) {
    uint bits = bins[first + w];
    const uint here = uint(bitCount(bits));
    // The occupied bin number ceil(bucket * occupied / kK) is the first one of the bucket.
    while (bucket < kK && (bucket * occupied + kK - 1u) / kK < before_word + here) {
      const uint wanted = (bucket * occupied + kK - 1u) / kK - before_word;
      uint rest = bits;
      for (uint i = 0u; i < wanted; ++i) rest &= rest - 1u;
      bins[first + kWords + bucket - 1u] = 32u * w + uint(findLSB(rest));
      ++bucket;
    }
    before_word += here;
  }
  for (; bucket < kK; ++bucket) bins[first + kWords + bucket - 1u] = kBins;
}
