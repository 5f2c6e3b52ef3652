#include "capture/buffers/buckets.glsl"
// Adaptive buckets: a pixel's depth range in 1,024 bins; each bucket has about as many bins with fragments. D: 32
// words of bits a pixel, then kK - 1 first bins of the buckets.
const uint kBins = 1024u;
const uint kWords = 32u;
uint bins_of(uint pixel) { return (kWords + kK) * pixel; }
uint bin_of(float z, uint nearest, uint farthest) { return bucket_of(z, nearest, farthest, kBins); }
