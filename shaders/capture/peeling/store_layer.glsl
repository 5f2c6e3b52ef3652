// store() stores this fragment, which lies in the current layer at an end of its pixel, as layers.glsl
// describes.
#if defined(PAIRS)
// With kVariant 0, the first pass, it finds the ids. With kVariant 1, the second pass, it stores their
// colours.
void store(uint end, bool far) {
  const uint id = fragment_id();
  if (kVariant != 0u) {
    if (id == ~pairs[end].smallest_complement) pairs[end].smallest_color = fragment_color();
    else if (id == pairs[end].largest) pairs[end].largest_color = fragment_color();
    return;
  }
  const uvec2 taken = windows[end];
  if (taken.x != 0u && (id <= taken.x || id >= taken.y)) return;
  atomicMax(pairs[end].smallest_complement, ~id);
  atomicMax(pairs[end].largest, id);
  atomicAdd(pairs[end].count, 1u);
}
#elif defined(CHAINS)
// Inserts without a lock: each place keeps the smaller value and passes on the larger one. All invocations do
// the same.
void store(uint end, bool far) {
  const uint id = fragment_id();
  if (resumes()) {
    const uint taken = windows[end].x;
    if (taken != 0u && (far ? id >= taken : id <= taken)) return;
  }
  uint64_t carried = (uint64_t(far ? ~id : id) << 32) | uint64_t(fragment_color());
  for (uint i = 0u; i < kK; ++i) {
    const uint64_t old = atomicMin(chains[kK * end + i], carried);
    carried = max(old, carried);
    if (carried == kEmpty) return;
  }
  if (resumes()) atomicMax(windows[end].y, 1u);
}
#elif defined(LISTS)
// Both ends take their nodes from one counter. With two counters that run towards each other, it would not be
// certain when they meet.
void store(uint end, bool far) {
  const uint node = atomicAdd(counters.next_node, 1u);
  if (node >= frame.capacity) {
    atomicAdd(counters.overflowed, 1u);
    return;
  }
  nodes[3u * node] = fragment_id();
  nodes[3u * node + 1u] = fragment_color();
  nodes[3u * node + 2u] = atomicExchange(heads[end], node);
}
#elif defined(ARRAYS)
void store(uint end, bool far) {
  const uint place = atomicAdd(counts[end], 1u);
  if (place < kK) nodes[kK * end + place] = uvec2(fragment_id(), fragment_color());
}
#endif
