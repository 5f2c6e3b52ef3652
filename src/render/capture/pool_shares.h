// pool_shares.h - a pool of nodes, divided among pixels by the number of their fragments.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace pellucid::render {

struct PoolShares {
  // The first place of each pixel, in rows, and the end. 0 fragments: 0 places.
  std::vector<std::uint32_t> firsts;
  std::uint32_t rounds = 0;  // until every pixel with a share had all of its fragments in it
};

// For going around until all fragments were there: min(count, k) places each, whether they fit or not.
PoolShares shares_of_k(std::span<const std::uint32_t> counts, std::uint32_t k);

// The same in the fewest rounds r for which a part of each pixel's fragments, ceil(count / r) but not more
// than `most`, fits into `places`; at least one each, whether they fit or not.
PoolShares divide_for_rounds(std::span<const std::uint32_t> counts, std::uint64_t places, std::uint32_t most);

// For one round: min(count, k) places, k the largest with which they fit; what is left goes to pixels at even
// distances, one place each, until nothing is left or all have what they need.
PoolShares divide_once(std::span<const std::uint32_t> counts, std::uint64_t places);

}  // namespace pellucid::render
