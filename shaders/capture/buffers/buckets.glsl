// Returns the uniform bucket of a depth between the nearest and farthest depth (bits) of a pixel. It is
// monotone in z.
uint bucket_of(float z, uint nearest, uint farthest, uint buckets) {
  const float zn = uintBitsToFloat(nearest);
  const float zf = uintBitsToFloat(farthest);
  if (!(zf > zn)) return 0u;
  return min(buckets - 1u, uint(float(buckets) * ((z - zn) / (zf - zn))));
}
