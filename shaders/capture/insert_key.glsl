// Inserts a key into a chain of increasing keys, by 64-bit atomic minima. Needs a buffer `keys`. Each place
// keeps the smaller key and passes on the larger one. Other invocations do the same at the same time, so the
// result does not depend on the order of fragments, and no lock is needed. Values that are read without an
// atomic operation may be stale. A stale value is never smaller than the current one.
void insert_key(uint first, uint count, uint64_t key) {
  if (key >= keys[first + count - 1u]) return;
  for (uint i = 0u; i < count && key != kNoKey; ++i) key = max(key, atomicMin(keys[first + i], key));
}
