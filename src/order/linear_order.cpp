// Linear orders that violate as little weight as possible: see linear_order.h.
#include "linear_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pellucid {
namespace {

class Sifter {
 public:
  Sifter(const PairWishes& wishes, const SiftOptions& options, std::vector<std::uint32_t>& ranks)
      : wishes_(wishes),
        movable_(options.movable),
        step_(options.step),
        ranks_(ranks),
        positions_(ranks.begin(), ranks.end()),
        sequence_(ranks.size()),
        unsettled_(ranks.size(), 1),
        violated_(ranks.size(), 0) {}

  // Give every node, front to back, the best place among its neighbours. Returns the weight saved. A node is
  // looked at again only after a neighbour passed it, or moved while something was left to gain.
  double sweep() {
    for (NodeId node = 0; node < ranks_.size(); ++node) sequence_[ranks_[node]] = node;
    for (NodeId node = 0; node < ranks_.size(); ++node) positions_[node] = ranks_[node];
    double saved = 0;
    for (const NodeId node : sequence_) {
      if (unsettled_[node] == 0 || (!movable_.empty() && movable_[node] == 0)) continue;
      unsettled_[node] = 0;
      saved += move(node);
    }
    std::sort(sequence_.begin(), sequence_.end(), [&](NodeId a, NodeId b) {
      return positions_[a] != positions_[b] ? positions_[a] < positions_[b] : ranks_[a] < ranks_[b];
    });
    for (std::uint32_t rank = 0; rank < sequence_.size(); ++rank) ranks_[sequence_[rank]] = rank;
    return saved;
  }

 private:
  struct Neighbor {
    double position;
    float weight;
  };

  double move(NodeId node) {
    const double here = positions_[node];
    // Only places between the outermost violated neighbours can be better than this one.
    double first = here;
    double last = here;
    const std::uint32_t begin = wishes_.offsets[node];
    const std::uint32_t end = wishes_.offsets[node + 1];
    for (std::uint32_t i = begin; i < end; ++i) {
      const double there = positions_[wishes_.neighbors[i]];
      if (wishes_.weights[i] > 0) {
        first = std::min(first, there);
      } else if (wishes_.weights[i] < 0) {
        last = std::max(last, there);
      }
    }
    violated_[node] = first != here || last != here ? 1 : 0;
    if (violated_[node] == 0) return 0;

    before_.clear();
    after_.clear();
    double beyond_first = -1;  // the next neighbours outside, between which and the span a place is free
    double beyond_last = static_cast<double>(ranks_.size());
    for (std::uint32_t i = begin; i < end; ++i) {
      const double there = positions_[wishes_.neighbors[i]];
      if (there < first) {
        beyond_first = std::max(beyond_first, there);
      } else if (there > last) {
        beyond_last = std::min(beyond_last, there);
      } else if (there < here) {
        before_.push_back({there, wishes_.weights[i]});
      } else {
        after_.push_back({there, wishes_.weights[i]});
      }
    }
    // Moving towards the front past v changes the cost by -weight, towards the back by +weight.
    std::sort(before_.begin(), before_.end(),
              [](const Neighbor& a, const Neighbor& b) { return a.position > b.position; });
    std::sort(after_.begin(), after_.end(),
              [](const Neighbor& a, const Neighbor& b) { return a.position < b.position; });
    const Place forward = best_place(before_, -1.0F, beyond_first);
    const Place backward = best_place(after_, 1.0F, beyond_last);
    const Place& best = forward.gain >= backward.gain ? forward : backward;
    if (best.gain <= 0) return 0;
    positions_[node] = best.position;
    unsettle_neighbors(node, std::min(here, best.position), std::max(here, best.position));
    return best.gain;
  }

  // Neighbours that a move passed may be violated now; others only if they were before.
  void unsettle_neighbors(NodeId node, double passed_from, double passed_to) {
    for (std::uint32_t i = wishes_.offsets[node]; i < wishes_.offsets[node + 1]; ++i) {
      const NodeId neighbor = wishes_.neighbors[i];
      const double there = positions_[neighbor];
      const bool passed = passed_from <= there && there <= passed_to;
      if (passed || violated_[neighbor] != 0) unsettled_[neighbor] = 1;
    }
  }

  struct Place {
    double gain = 0;
    double position = 0;
  };

  // Pass the neighbours one by one; the best gap lies between the last one passed and the next (`beyond`
  // after the last).
  [[nodiscard]] Place best_place(const std::vector<Neighbor>& passed, float sign, double beyond) const {
    Place best;
    double gain = 0;
    for (std::size_t i = 0; i < passed.size(); ++i) {
      gain -= static_cast<double>(sign * passed[i].weight);
      if (gain > best.gain) {
        const double next = i + 1 < passed.size() ? passed[i + 1].position : beyond;
        const double middle = 0.5 * (next - passed[i].position);
        best = {gain, passed[i].position + std::clamp(middle, -step_, step_)};
      }
    }
    return best;
  }

  const PairWishes& wishes_;
  std::span<const std::uint8_t> movable_;
  double step_;
  std::vector<std::uint32_t>& ranks_;
  std::vector<double> positions_;  // ranks, and fractions between them for nodes that moved in this sweep
  std::vector<NodeId> sequence_;
  std::vector<std::uint8_t> unsettled_;
  std::vector<std::uint8_t> violated_;  // some wish of the node was violated when it was last looked at
  std::vector<Neighbor> before_, after_;
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
  Sifter sifter(wishes, options, trial);
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
