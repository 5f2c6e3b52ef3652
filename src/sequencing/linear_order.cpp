// Linear orders that violate as little weight as possible: see linear_order.h.
#include "sequencing/linear_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sequencing/sifter.h"

namespace pellucid {
namespace {

// Wishes that do not depend on where the others are.
class FixedRows {
 public:
  explicit FixedRows(const PairWishes& wishes) : wishes_(wishes) {}

  [[nodiscard]] WishRow row(NodeId node, std::span<const double> /*positions*/) const {
    const std::uint32_t begin = wishes_.offsets[node];
    const std::uint32_t count = wishes_.offsets[node + 1] - begin;
    return {std::span(wishes_.neighbors).subspan(begin, count),
            std::span(wishes_.weights).subspan(begin, count)};
  }
  [[nodiscard]] std::pair<double, double> room(NodeId /*node*/) const {
    return {-1.0, static_cast<double>(wishes_.offsets.size() - 1)};
  }

 private:
  const PairWishes& wishes_;
};

// A pair that hides each other stands twice in both rows: leave the difference in one place and nothing in
// the other.
void settle_opposites(const EdgeRows& edges, PairWishes& wishes) {
  for (NodeId node = 0; node < edges.node_count(); ++node) {
    std::uint32_t hides = wishes.offsets[node + 1] - (edges.offsets[node + 1] - edges.offsets[node]);
    std::uint32_t hidden_by = wishes.offsets[node];
    const std::uint32_t hides_end = wishes.offsets[node + 1];
    const std::uint32_t hidden_by_end = hides;
    while (hides < hides_end && hidden_by < hidden_by_end) {
      const NodeId neighbor = wishes.neighbors[hides];
      if (neighbor < wishes.neighbors[hidden_by]) {
        ++hides;
      } else if (neighbor > wishes.neighbors[hidden_by]) {
        ++hidden_by;
      } else {
        float& forward = wishes.weights[hides++];
        float& backward = wishes.weights[hidden_by++];
        if (node < neighbor) wishes.unavoidable += static_cast<double>(std::min(forward, -backward));
        forward += backward;
        backward = 0;
      }
    }
  }
}

}  // namespace

PairWishes net_wishes(const EdgeRows& edges) {
  PairWishes wishes;
  wishes.offsets.assign(edges.offsets.size(), 0);
  for (NodeId node = 0; node < edges.node_count(); ++node) {
    wishes.offsets[node + 1] += edges.offsets[node + 1] - edges.offsets[node];
  }
  for (const NodeId back : edges.backs) ++wishes.offsets[back + 1];
  std::partial_sum(wishes.offsets.begin(), wishes.offsets.end(), wishes.offsets.begin());
  wishes.neighbors.resize(wishes.offsets.back());
  wishes.weights.resize(wishes.offsets.back());

  // What a node hides comes last in its row, what hides it first: both sorted.
  std::vector<std::uint32_t> hiding(wishes.offsets.begin(), wishes.offsets.end() - 1);
  for (NodeId node = 0; node < edges.node_count(); ++node) {
    const std::uint32_t count = edges.offsets[node + 1] - edges.offsets[node];
    const std::uint32_t own = wishes.offsets[node + 1] - count;
    for (std::uint32_t i = 0; i < count; ++i) {
      const NodeId back = edges.backs[edges.offsets[node] + i];
      const float weight = edges.weights[edges.offsets[node] + i];
      wishes.neighbors[own + i] = back;
      wishes.weights[own + i] = weight;
      const std::uint32_t slot = hiding[back]++;
      wishes.neighbors[slot] = node;
      wishes.weights[slot] = -weight;
    }
  }
  settle_opposites(edges, wishes);
  return wishes;
}

double violated_weight(const PairWishes& wishes, std::span<const std::uint32_t> ranks) {
  double sum = 0;
  for (NodeId node = 0; node + 1 < wishes.offsets.size(); ++node) {
    for (std::uint32_t i = wishes.offsets[node]; i < wishes.offsets[node + 1]; ++i) {
      const float weight = wishes.weights[i];
      if (weight > 0 && ranks[wishes.neighbors[i]] < ranks[node]) sum += static_cast<double>(weight);
    }
  }
  return sum;
}

double sift(const PairWishes& wishes, const SiftOptions& options, std::vector<std::uint32_t>& ranks) {
  const double before = violated_weight(wishes, ranks);
  std::vector<std::uint32_t> trial = ranks;
  FixedRows rows(wishes);
  Sifter sifter(rows, options, trial);
  double left = before;
  for (std::uint32_t sweep = 0; sweep < options.sweeps && left > 0; ++sweep) {
    stop_if_requested(options.progress);
    const double saved = sifter.sweep();
    if (saved <= options.least_gain * left) break;
    left -= saved;
  }
  // Fractions between neighbours can run out of digits: trust the count, not the sum of the gains.
  const double after = violated_weight(wishes, trial);
  if (after >= before) return before;
  ranks = std::move(trial);
  return after;
}

std::vector<std::uint32_t> ranks_by_key(std::span<const double> keys) {
  std::vector<NodeId> sequence(keys.size());
  std::iota(sequence.begin(), sequence.end(), 0U);
  std::sort(sequence.begin(), sequence.end(),
            [&](NodeId a, NodeId b) { return keys[a] != keys[b] ? keys[a] < keys[b] : a < b; });
  std::vector<std::uint32_t> ranks(keys.size());
  for (std::uint32_t rank = 0; rank < sequence.size(); ++rank) ranks[sequence[rank]] = rank;
  return ranks;
}

}  // namespace pellucid
