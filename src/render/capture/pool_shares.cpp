// Division of a pool: see pool_shares.h.
#include "pool_shares.h"

#include <algorithm>

namespace pellucid::render {
namespace {

// The largest k with which sum of min(count, k) is not above `places`, and not above the largest count.
std::uint32_t water_level(std::span<const std::uint32_t> counts, std::uint64_t places) {
  const std::uint32_t deepest = counts.empty() ? 0 : *std::max_element(counts.begin(), counts.end());
  std::vector<std::uint64_t> pixels_of_depth(std::size_t{deepest} + 1);
  for (const std::uint32_t count : counts) ++pixels_of_depth[count];
  std::uint64_t taken = 0;
  std::uint64_t deeper = counts.size();  // pixels with more than `level` fragments
  for (std::uint32_t level = 0; level < deepest; ++level) {
    deeper -= pixels_of_depth[level];
    if (taken + deeper > places) return level;
    taken += deeper;
  }
  return deepest;
}

// `extra`: does the n-th of the pixels with more than `level` fragments get another place?
template <class Extra>
PoolShares make_shares(std::span<const std::uint32_t> counts, std::uint32_t level, const Extra& extra) {
  PoolShares shares;
  shares.firsts.reserve(counts.size() + 1);
  shares.firsts.push_back(0);
  std::uint64_t deeper = 0;
  for (const std::uint32_t count : counts) {
    const std::uint32_t more = count > level && extra(deeper++) ? 1 : 0;
    const std::uint32_t share = std::min(count, level + more);
    shares.firsts.push_back(shares.firsts.back() + share);
    shares.largest = std::max(shares.largest, share);
    if (share > 0) shares.rounds = std::max(shares.rounds, (count + share - 1) / share);
  }
  return shares;
}

}  // namespace

PoolShares divide_for_rounds(std::span<const std::uint32_t> counts, std::uint64_t places,
                             std::uint32_t most) {
  const std::uint32_t level = std::clamp<std::uint32_t>(water_level(counts, places), 1, most);
  return make_shares(counts, level, [](std::uint64_t) { return false; });
}

PoolShares divide_once(std::span<const std::uint32_t> counts, std::uint64_t places) {
  const std::uint32_t level = water_level(counts, places);
  std::uint64_t taken = 0;
  std::uint64_t deeper = 0;
  for (const std::uint32_t count : counts) {
    taken += std::min(count, level);
    deeper += count > level ? 1U : 0U;
  }
  const std::uint64_t left = std::min(places - taken, deeper);
  return make_shares(counts, level,
                     [&](std::uint64_t n) { return (n + 1) * left / deeper > n * left / deeper; });
}

}  // namespace pellucid::render
