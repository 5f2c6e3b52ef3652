// Vertices that stand at the same place: see pellucid/mesh.h.
#include <algorithm>
#include <bit>
#include <limits>

#include "pellucid/mesh.h"

namespace pellucid {
namespace {

constexpr std::uint32_t kEmpty = std::numeric_limits<std::uint32_t>::max();

// Bits of a coordinate; -0 equals +0.
std::uint64_t coordinate_bits(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return bits == 0x80000000U ? 0U : bits;
}

// The mixing step of SplitMix64 over the three coordinates.
std::uint64_t position_hash(const Vec3f& p) {
  std::uint64_t z = coordinate_bits(p.x) | (coordinate_bits(p.y) << 32U);
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL + coordinate_bits(p.z);
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}

bool same_position(const Vec3f& a, const Vec3f& b) {
  return coordinate_bits(a.x) == coordinate_bits(b.x) && coordinate_bits(a.y) == coordinate_bits(b.y) &&
         coordinate_bits(a.z) == coordinate_bits(b.z);
}

}  // namespace

std::vector<std::uint32_t> weld_by_position(std::span<const Vec3f> positions) {
  // Open addressing with linear probing, at most half full.
  const std::size_t slots = std::bit_ceil(std::max<std::size_t>(2 * positions.size(), 2));
  std::vector<std::uint32_t> table(slots, kEmpty);
  std::vector<std::uint32_t> first(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    std::size_t slot = position_hash(positions[v]) & (slots - 1);
    while (table[slot] != kEmpty && !same_position(positions[table[slot]], positions[v])) {
      slot = (slot + 1) & (slots - 1);
    }
    if (table[slot] == kEmpty) table[slot] = v;
    first[v] = table[slot];
  }
  return first;
}

}  // namespace pellucid
