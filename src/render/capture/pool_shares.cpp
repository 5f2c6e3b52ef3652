// Division of a pool: see pool_shares.h.
#include "render/capture/pool_shares.h"

#include <algorithm>

namespace pellucid::render {
namespace {

// Of depth complexities: the n-th from 0 is how many pixels have n fragments.
std::vector<std::uint64_t> histogram_of(std::span<const std::uint32_t> counts) {
  const std::uint32_t deepest = counts.empty() ? 0 : *std::max_element(counts.begin(), counts.end());
  std::vector<std::uint64_t> pixels(std::size_t{deepest} + 1);
  for (const std::uint32_t count : counts) ++pixels[count];
  return pixels;
}

// The largest k with which sum of min(count, k) is not above `places`, and not above the largest count.
std::uint32_t water_level(std::span<const std::uint32_t> counts, std::uint64_t places) {
  const std::vector<std::uint64_t> pixels = histogram_of(counts);
  std::uint64_t taken = 0;
  std::uint64_t deeper = counts.size();  // pixels with more than `level` fragments
  for (std::uint32_t level = 0; level + 1 < pixels.size(); ++level) {
    deeper -= pixels[level];
    if (taken + deeper > places) return level;
    taken += deeper;
  }
  return static_cast<std::uint32_t>(pixels.size() - 1);
}

constexpr std::uint32_t part(std::uint32_t count, std::uint32_t parts) {
  return count / parts + (count % parts != 0 ? 1 : 0);
}

// The fewest rounds, but not fewer than `least`, whose parts fit; more do not need more places.
std::uint32_t fewest_rounds(std::span<const std::uint32_t> counts, std::uint64_t places,
                            std::uint32_t least) {
  const std::vector<std::uint64_t> pixels = histogram_of(counts);
  const auto fits = [&](std::uint32_t rounds) {
    std::uint64_t sum = 0;
    for (std::uint32_t n = 1; n < pixels.size(); ++n) sum += pixels[n] * part(n, rounds);
    return sum <= places;
  };
  std::uint32_t low = std::max(least, 1U);
  std::uint32_t high = std::max(low, static_cast<std::uint32_t>(pixels.size() - 1));
  while (low < high) {
    const std::uint32_t middle = low + (high - low) / 2;
    if (fits(middle)) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

// `share_of`: places of a pixel of so many fragments.
template <class ShareOf>
PoolShares make_shares(std::span<const std::uint32_t> counts, const ShareOf& share_of) {
  PoolShares shares;
  shares.firsts.reserve(counts.size() + 1);
  shares.firsts.push_back(0);
  for (const std::uint32_t count : counts) {
    const std::uint32_t share = share_of(count);
    shares.firsts.push_back(shares.firsts.back() + share);
    if (share > 0) shares.rounds = std::max(shares.rounds, part(count, share));
  }
  return shares;
}

}  // namespace

PoolShares shares_of_k(std::span<const std::uint32_t> counts, std::uint32_t k) {
  return make_shares(counts, [&](std::uint32_t count) { return std::min(count, k); });
}

PoolShares divide_for_rounds(std::span<const std::uint32_t> counts, std::uint64_t places,
                             std::uint32_t most) {
  const std::uint32_t deepest = counts.empty() ? 0 : *std::max_element(counts.begin(), counts.end());
  const std::uint32_t rounds = fewest_rounds(counts, places, part(deepest, most));
  return make_shares(counts, [&](std::uint32_t count) { return part(count, rounds); });
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
  std::uint64_t seen = 0;
  return make_shares(counts, [&](std::uint32_t count) {
    if (count <= level) return count;
    const std::uint64_t n = seen++;
    return level + ((n + 1) * left / deeper > n * left / deeper ? 1 : 0);
  });
}

}  // namespace pellucid::render
