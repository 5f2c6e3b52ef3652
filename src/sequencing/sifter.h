// Sifting: one item after the other goes to the best place among its neighbours. See linear_order.h.
//
// `Wishes` says what an item wishes for, given where all others are:
//   WishRow row(item, positions)   its neighbours, and for each what it costs to come after that one instead
//                                  of before; valid until the next call
//   std::pair<double, double> room(item)   positions between which the item may move
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sequencing/linear_order.h"

namespace pellucid {

struct WishRow {
  std::span<const NodeId> neighbors;
  std::span<const float> weights;
};

template <class Wishes>
class Sifter {
 public:
  Sifter(Wishes& wishes, const SiftOptions& options, std::vector<std::uint32_t>& ranks)
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
    std::uint32_t index;  // in its row: neighbours at the same position keep the order of the row
  };

  double move(NodeId node) {
    const double here = positions_[node];
    // Only places between the outermost violated neighbours can be better than this one.
    double first = here;
    double last = here;
    const WishRow row = wishes_.row(node, positions_);
    for (std::size_t i = 0; i < row.neighbors.size(); ++i) {
      const double there = positions_[row.neighbors[i]];
      if (row.weights[i] > 0) {
        first = std::min(first, there);
      } else if (row.weights[i] < 0) {
        last = std::max(last, there);
      }
    }
    violated_[node] = first != here || last != here ? 1 : 0;
    if (violated_[node] == 0) return 0;

    before_.clear();
    after_.clear();
    // The next neighbours outside, between which and the span a place is free.
    auto [beyond_first, beyond_last] = wishes_.room(node);
    for (std::size_t i = 0; i < row.neighbors.size(); ++i) {
      const double there = positions_[row.neighbors[i]];
      if (there < first) {
        beyond_first = std::max(beyond_first, there);
      } else if (there > last) {
        beyond_last = std::min(beyond_last, there);
      } else if (there < here) {
        before_.push_back({there, row.weights[i], static_cast<std::uint32_t>(i)});
      } else {
        after_.push_back({there, row.weights[i], static_cast<std::uint32_t>(i)});
      }
    }
    // Moving towards the front past v changes the cost by -weight, towards the back by +weight.
    std::sort(before_.begin(), before_.end(), [](const Neighbor& a, const Neighbor& b) {
      return a.position != b.position ? a.position > b.position : a.index < b.index;
    });
    std::sort(after_.begin(), after_.end(), [](const Neighbor& a, const Neighbor& b) {
      return a.position != b.position ? a.position < b.position : a.index < b.index;
    });
    const Place forward = best_place(before_, -1.0F, beyond_first);
    const Place backward = best_place(after_, 1.0F, beyond_last);
    const Place& best = forward.gain >= backward.gain ? forward : backward;
    if (best.gain <= 0) return 0;
    positions_[node] = best.position;
    unsettle_neighbors(row, std::min(here, best.position), std::max(here, best.position));
    return best.gain;
  }

  // Neighbours that a move passed may be violated now; others only if they were before.
  void unsettle_neighbors(const WishRow& row, double passed_from, double passed_to) {
    for (const NodeId neighbor : row.neighbors) {
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

  Wishes& wishes_;
  std::span<const std::uint8_t> movable_;
  double step_;
  std::vector<std::uint32_t>& ranks_;
  std::vector<double> positions_;  // ranks, and fractions between them for nodes that moved in this sweep
  std::vector<NodeId> sequence_;
  std::vector<std::uint8_t> unsettled_;
  std::vector<std::uint8_t> violated_;  // some wish of the node was violated when it was last looked at
  std::vector<Neighbor> before_, after_;
};

}  // namespace pellucid
