// The bucket of a fragment: uniform (kVariant 0) or adaptive (1). Needs Bounds (B) and Bins (D).
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
