// Which cells cannot share an order: see conflicts.h.
#include "transparency/cluster/conflicts.h"

#include <algorithm>
#include <bit>

#include "base/parallel.h"

namespace pellucid {
namespace {

using BitSet = std::vector<std::uint64_t>;

void set_bit(BitSet& set, std::size_t number) {
  set[number / 64] |= std::uint64_t{1} << (number % 64);
}

bool intersect(const BitSet& a, const BitSet& b) {
  for (std::size_t word = 0; word < a.size(); ++word) {
    if ((a[word] & b[word]) != 0) return true;
  }
  return false;
}

// Per pair of opposite edges one bit: has the cell the one, has it the other?
struct Directions {
  BitSet forward, backward;
};

std::vector<Directions> directions_of(const EdgeTable& table, std::span<const EdgeSet> cells) {
  // The first edge of every pair of opposite ones, by id.
  std::vector<std::uint32_t> pairs;
  for (std::uint32_t id = 0; id < table.backs.size(); ++id) {
    if (table.reverse[id] != kNoEdge && id < table.reverse[id]) pairs.push_back(id);
  }
  const std::size_t words = (pairs.size() + 63) / 64;
  std::vector<Directions> directions(cells.size());
  parallel_loop(std::size_t{0}, cells.size(), [&](std::size_t cell) {
    directions[cell] = {BitSet(words, 0), BitSet(words, 0)};
    for (const std::uint32_t id : cells[cell].ids) {
      const std::uint32_t reverse = table.reverse[id];
      if (reverse == kNoEdge) continue;
      const auto found = std::lower_bound(pairs.begin(), pairs.end(), std::min(id, reverse));
      set_bit(id < reverse ? directions[cell].forward : directions[cell].backward,
              static_cast<std::size_t>(found - pairs.begin()));
    }
  });
  return directions;
}

// From `first` on: of the rivals of all chosen ones, take the one that leaves most others possible.
std::vector<std::uint32_t> greedy_clique(const std::vector<BitSet>& rivals, std::uint32_t first) {
  std::vector<std::uint32_t> clique{first};
  BitSet possible = rivals[first];
  for (;;) {
    int most = -1;
    std::uint32_t best = 0;
    for (std::uint32_t cell = 0; cell < rivals.size(); ++cell) {
      if ((possible[cell / 64] >> (cell % 64) & 1U) == 0) continue;
      int left = 0;
      for (std::size_t word = 0; word < possible.size(); ++word)
        left += std::popcount(possible[word] & rivals[cell][word]);
      if (left > most) {
        most = left;
        best = cell;
      }
    }
    if (most < 0) return clique;
    clique.push_back(best);
    for (std::size_t word = 0; word < possible.size(); ++word) possible[word] &= rivals[best][word];
  }
}

}  // namespace

std::vector<std::uint32_t> contradicting_cells(const EdgeTable& table, std::span<const EdgeSet> cells) {
  const std::vector<Directions> directions = directions_of(table, cells);
  std::vector<BitSet> rivals(cells.size(), BitSet((cells.size() + 63) / 64, 0));
  parallel_loop(std::size_t{0}, cells.size(), [&](std::size_t cell) {
    for (std::size_t other = 0; other < cells.size(); ++other) {
      if (intersect(directions[cell].forward, directions[other].backward) ||
          intersect(directions[cell].backward, directions[other].forward)) {
        set_bit(rivals[cell], other);
      }
    }
  });
  std::vector<std::vector<std::uint32_t>> cliques(cells.size());
  parallel_loop(std::size_t{0}, cells.size(), [&](std::size_t cell) {
    cliques[cell] = greedy_clique(rivals, static_cast<std::uint32_t>(cell));
  });
  const auto largest = std::max_element(cliques.begin(), cliques.end(),
                                        [](const auto& a, const auto& b) { return a.size() < b.size(); });
  return largest == cliques.end() ? std::vector<std::uint32_t>{} : *largest;
}

}  // namespace pellucid
