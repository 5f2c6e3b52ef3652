// Sums of whole numbers in fields of 64 bits, which are two words, the lower one first.
#ifndef FIELDS_GLSL
#define FIELDS_GLSL
uvec2 in_field(uint value, uint begin) {
  if (begin >= 32u) return uvec2(0u, value << (begin - 32u));
  return uvec2(value << begin, begin == 0u ? 0u : value >> (32u - begin));
}
uint field_of(uvec2 sums, uint begin, uint bits) {
  const uint mask = (1u << bits) - 1u;
  if (begin >= 32u) return sums.y >> (begin - 32u) & mask;
  return (sums.x >> begin | (begin == 0u ? 0u : sums.y << (32u - begin))) & mask;
}
// Sums begin at -1, as slots that nothing was put into do.
uvec2 sums_in(uvec2 slot) { return uvec2(slot.x + 1u, slot.y + (slot.x == kNone ? 1u : 0u)); }
#endif
