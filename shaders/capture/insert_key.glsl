// Insertion into a chain of keys, which increase; needs a buffer `keys`. A chain of 64-bit minima: each place keeps the
// smaller key and the larger one goes on, whoever else does the same, so the result is the same for any order of
// fragments, without a lock. What is read without an atomic may be stale, and is then only larger than it should be.
void insert_key(uint first, uint count, uint64_t key) {
  if (key >= keys[first + count - 1u]) return;
  for (uint i = 0u; i < count && key != kNoKey; ++i) key = max(key, atomicMin(keys[first + i], key));
}
