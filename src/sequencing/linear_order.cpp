// Implements sifting with fixed preferences.
#include "sequencing/linear_order.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pellucid {
namespace {

// Preferences that do not depend on the positions of the other items.
class FixedRows {
 public:
  explicit FixedRows(const PairPreferences& preferences) : preferences_(preferences) {}

  [[nodiscard]] PreferenceRow row(NodeId node, std::span<const double> /*positions*/) const {
    const std::uint32_t begin = preferences_.offsets[node];
    const std::uint32_t count = preferences_.offsets[node + 1] - begin;
    return {std::span(preferences_.neighbors).subspan(begin, count),
            std::span(preferences_.weights).subspan(begin, count)};
  }
  [[nodiscard]] std::pair<double, double> free_range(NodeId /*node*/) const {
    return {-1.0, static_cast<double>(preferences_.offsets.size() - 1)};
  }

 private:
  const PairPreferences& preferences_;
};

// Joins the two entries of pairs that occlude each other: one entry receives the difference and the other one
// 0.
void settle_opposites(const EdgeRows& edges, PairPreferences& preferences) {
  for (NodeId node = 0; node < edges.node_count(); ++node) {
    std::uint32_t behind = preferences.offsets[node + 1] - (edges.offsets[node + 1] - edges.offsets[node]);
    std::uint32_t in_front = preferences.offsets[node];
    const std::uint32_t behind_end = preferences.offsets[node + 1];
    const std::uint32_t in_front_end = behind;
    while (behind < behind_end && in_front < in_front_end) {
      const NodeId neighbor = preferences.neighbors[behind];
      if (neighbor < preferences.neighbors[in_front]) {
        ++behind;
      } else if (neighbor > preferences.neighbors[in_front]) {
        ++in_front;
      } else {
        float& forward = preferences.weights[behind++];
        float& backward = preferences.weights[in_front++];
        if (node < neighbor) preferences.unavoidable += static_cast<double>(std::min(forward, -backward));
        forward += backward;
        backward = 0;
      }
    }
  }
}

}  // namespace

PairPreferences net_preferences(const EdgeRows& edges) {
  PairPreferences preferences;
  preferences.offsets.assign(edges.offsets.size(), 0);
  for (NodeId node = 0; node < edges.node_count(); ++node) {
    preferences.offsets[node + 1] += edges.offsets[node + 1] - edges.offsets[node];
  }
  for (const NodeId back : edges.backs) ++preferences.offsets[back + 1];
  std::partial_sum(preferences.offsets.begin(), preferences.offsets.end(), preferences.offsets.begin());
  preferences.neighbors.resize(preferences.offsets.back());
  preferences.weights.resize(preferences.offsets.back());

  // The nodes behind a node come last in its row and those in front of it first. Both are sorted.
  std::vector<std::uint32_t> next_slot(preferences.offsets.begin(), preferences.offsets.end() - 1);
  for (NodeId node = 0; node < edges.node_count(); ++node) {
    const std::uint32_t count = edges.offsets[node + 1] - edges.offsets[node];
    const std::uint32_t own = preferences.offsets[node + 1] - count;
    for (std::uint32_t i = 0; i < count; ++i) {
      const NodeId back = edges.backs[edges.offsets[node] + i];
      const float weight = edges.weights[edges.offsets[node] + i];
      preferences.neighbors[own + i] = back;
      preferences.weights[own + i] = weight;
      const std::uint32_t slot = next_slot[back]++;
      preferences.neighbors[slot] = node;
      preferences.weights[slot] = -weight;
    }
  }
  settle_opposites(edges, preferences);
  return preferences;
}

double violated_weight(const PairPreferences& preferences, std::span<const std::uint32_t> ranks) {
  double sum = 0;
  for (NodeId node = 0; node + 1 < preferences.offsets.size(); ++node) {
    for (std::uint32_t i = preferences.offsets[node]; i < preferences.offsets[node + 1]; ++i) {
      const float weight = preferences.weights[i];
      if (weight > 0 && ranks[preferences.neighbors[i]] < ranks[node]) sum += static_cast<double>(weight);
    }
  }
  return sum;
}

double sift(const PairPreferences& preferences, const SiftOptions& options,
            std::vector<std::uint32_t>& ranks) {
  const double before = violated_weight(preferences, ranks);
  std::vector<std::uint32_t> trial = ranks;
  FixedRows rows(preferences);
  Sifter sifter(rows, options, trial);
  double left = before;
  for (std::uint32_t sweep = 0; sweep < options.sweeps && left > 0; ++sweep) {
    stop_if_requested(options.progress);
    const double saved = sifter.sweep();
    if (saved <= options.least_gain * left) break;
    left -= saved;
  }
  // Fractions between neighbours can run out of digits, so recompute the weight instead of adding up the
  // gains.
  const double after = violated_weight(preferences, trial);
  if (after >= before) return before;
  ranks = std::move(trial);
  return after;
}

std::vector<std::uint32_t> ranks_by_key(std::span<const double> keys) {
  std::vector<NodeId> order(keys.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](NodeId a, NodeId b) { return keys[a] != keys[b] ? keys[a] < keys[b] : a < b; });
  std::vector<std::uint32_t> ranks(keys.size());
  for (std::uint32_t rank = 0; rank < order.size(); ++rank) ranks[order[rank]] = rank;
  return ranks;
}

}  // namespace pellucid
