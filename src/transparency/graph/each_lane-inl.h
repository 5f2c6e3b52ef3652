// Included once per SIMD target, inside its namespace, after highway.h: no include guard.
//
// visit(lane) for every lane that is set, in order. Not hn::CompressStore: on AVX2, GCC 12 copies its table
// of permutations to the stack at every call, which took a quarter of the time of the occlusion graph.
template <class Tag, class Mask, class Visit>
HWY_INLINE void for_each_lane(Tag tag, Mask mask, const Visit& visit) {
  std::uint64_t bits = 0;
  hn::StoreMaskBits(tag, mask, reinterpret_cast<std::uint8_t*>(&bits));
  for (; bits != 0; bits &= bits - 1) visit(static_cast<std::size_t>(std::countr_zero(bits)));
}
