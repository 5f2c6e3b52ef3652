// Defines a loop over the lanes of a mask. It is included once per SIMD target, inside the namespace of the
// target and after highway.h. Therefore it has no include guard.

// Calls visit(lane) for every lane that is set, in order. hn::CompressStore is not used because on AVX2, GCC
// 12 copies its table of permutations to the stack at every call, which took a quarter of the time of the
// occlusion graph.
template <class Tag, class Mask, class Visit>
HWY_INLINE void for_each_lane(Tag tag, Mask mask, const Visit& visit) {
  std::uint64_t bits = 0;
  hn::StoreMaskBits(tag, mask, reinterpret_cast<std::uint8_t*>(&bits));
  for (; bits != 0; bits &= bits - 1) visit(static_cast<std::size_t>(std::countr_zero(bits)));
}
