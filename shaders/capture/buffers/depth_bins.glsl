#include "capture/buffers/buckets.glsl"
// Adaptive buckets: the depth range of a pixel is divided into 1,024 bins, and each bucket has about equally
// many occupied bins. D has 32 words of bits per pixel, then the first bins of buckets 1 to kK - 1.
const uint kBins = 1024u;
const uint kWords = 32u;
uint bins_of(uint pixel) { return (kWords + kK) * pixel; }
uint bin_of(float z, uint nearest, uint farthest) { return bucket_of(z, nearest, farthest, kBins); }
