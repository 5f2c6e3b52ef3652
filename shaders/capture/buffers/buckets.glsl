// Uniform buckets between the depths of a pixel's nearest and farthest fragment (bits); monotone in z.
uint bucket_of(float z, uint nearest, uint farthest, uint buckets) {
  const float zn = uintBitsToFloat(nearest);
  const float zf = uintBitsToFloat(farthest);
  if (!(zf > zn)) return 0u;
  return min(buckets - 1u, uint(float(buckets) * ((z - zn) / (zf - zn))));
}
