// Fewer misses, no more overdraw: see keep_hidden.h.
#include "keep_hidden.h"

#include <algorithm>
#include <limits>

#include "gather_visits.h"

namespace pellucid {
namespace {

constexpr int kRounds = 8;
constexpr double kLeastGain = 0.002;  // of the misses, to go on

// What must come before what: for every hidden layer, the first drawn of those that hide it.
SequenceConstraints constraints_of(const ListPool& pool, std::span<const WeightedList> weighted,
                                   std::span<const std::uint32_t> ranks) {
  std::vector<std::uint64_t> pairs;  // first << 32 | second, as triangles
  for (const WeightedList& entry : weighted) {
    const std::span<const Layer> list = pool.list(entry.list);
    std::uint32_t first = patch_of_layer(list[0]);
    for (std::size_t i = 1; i < list.size(); ++i) {
      const std::uint32_t triangle = patch_of_layer(list[i]);
      if (ranks[triangle] < ranks[first]) {
        first = triangle;
      } else if (triangle != first) {
        pairs.push_back((std::uint64_t{first} << 32U) | triangle);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  SequenceConstraints constraints;
  constraints.offsets.assign(2 * ranks.size() + 1, 0);
  for (const std::uint64_t pair : pairs) {
    ++constraints.offsets[node_of(static_cast<std::uint32_t>(pair >> 32U), false) + 1];
    constraints.followers.push_back(node_of(static_cast<std::uint32_t>(pair), false));
  }
  for (std::size_t i = 1; i < constraints.offsets.size(); ++i)
    constraints.offsets[i] += constraints.offsets[i - 1];
  return constraints;
}

}  // namespace

void save_misses(const OverdrawSubject& subject, const ListPool& pool, std::span<const WeightedList> weighted,
                 std::uint32_t cache_size, std::vector<std::uint32_t>& sequence, const Progress* progress) {
  Mesh mesh;
  mesh.positions = subject.frames.front();
  mesh.triangles = subject.triangles;
  NodeSequence nodes;
  for (const std::uint32_t triangle : sequence) nodes.push_back(node_of(triangle, false));
  std::vector<std::uint32_t> ranks(sequence.size());
  auto misses = static_cast<double>(fifo_misses(mesh, nodes, cache_size));
  for (int round = 0; round < kRounds; ++round) {
    for (std::uint32_t rank = 0; rank < nodes.size(); ++rank) ranks[triangle_of(nodes[rank])] = rank;
    nodes =
        gather_visits(mesh, constraints_of(pool, weighted, ranks), std::move(nodes), cache_size, progress);
    const auto after = static_cast<double>(fifo_misses(mesh, nodes, cache_size));
    const bool go_on = after < (1 - kLeastGain) * misses;
    misses = after;
    if (!go_on) break;
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) sequence[i] = triangle_of(nodes[i]);
}

}  // namespace pellucid
