// Finds linear orders that violate as little weight as possible, which is the minimum feedback arc set
// problem, by sifting. In: weighted pairwise preferences between items, and an order. Out: a better order.
//
// Transparency uses it with facings as items and wrongly drawn areas as weights, and overdraw with patches
// and wasted fragments. It works for any items and costs that can be written as "the weight that is lost if u
// comes after v".
//
// Based on: Brandenburg, Hanauer, "Sorting heuristics for the feedback arc set problem", 2011. Differs in:
// only the span between the violated neighbours of a node is searched, so that a sweep over a good order
// takes one pass over the edges.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "sequencing/edge_rows.h"

namespace pellucid {

// Pairwise preferences between nodes. In the row of u, a weight > 0 at neighbour v is the weight that is
// saved if u comes before v, and a weight < 0 is that saved if u comes after v. Every pair is in the rows of
// both nodes with opposite signs. A pair with edges in both directions is there twice, once with the
// difference and once with 0.
struct PairPreferences {
  std::vector<std::uint32_t> offsets;  // nodes + 1
  std::vector<NodeId> neighbors;
  std::vector<float> weights;
  double unavoidable = 0;  // the sum of the lighter directions of all pairs, which every order violates
};
// Returns the preferences that follow from edges, by subtracting the two directions of each pair. The rows of
// `edges` must be sorted by back node.
PairPreferences net_preferences(const EdgeRows& edges);

// Returns the weight that an order violates, without `unavoidable`. `ranks` has the rank of every node. Takes
// O(edges).
double violated_weight(const PairPreferences& preferences, std::span<const std::uint32_t> ranks);

struct SiftOptions {
  std::uint32_t sweeps = 10;
  // Stop after a sweep that lowers the violated weight by less than this share.
  double least_gain = 0.01;
  // One flag per node that says whether it may move, or empty if all may move. The preferences of the other
  // nodes may be incomplete.
  std::span<const std::uint8_t> movable;
  // A node moves to the middle of a gap between neighbours, but at most this many ranks beyond the neighbour
  // that it passes. The value should be small if nodes with unknown preferences may be in the gap.
  double step = std::numeric_limits<double>::infinity();
  const Progress* progress = nullptr;  // may be null; may request a stop
};
// Improves `ranks`, a permutation of 0 .. nodes - 1, in place, and never makes it worse. Returns the violated
// weight without `unavoidable`. A sweep takes O(edges) and the sorting of the neighbours of violated nodes.
// Deterministic.
double sift(const PairPreferences& preferences, const SiftOptions& options,
            std::vector<std::uint32_t>& ranks);

// Returns the ranks of nodes sorted by key. Ties are broken by node.
std::vector<std::uint32_t> ranks_by_key(std::span<const double> keys);

// ------------------------------------------------------------------------------ sifting with any preferences

// Sifts with preferences that may depend on the positions of the other items. One item after the other moves
// to the best place among its neighbours. `Preferences` has two functions:
//   PreferenceRow row(item, positions)
//     Returns the neighbours of an item, and for each of them the cost of coming after it instead of before
//     it, given the positions of all items. The row is valid until the next call.
//   std::pair<double, double> free_range(item)
//     Returns the positions between which the item may move.
struct PreferenceRow {
  std::span<const NodeId> neighbors;
  std::span<const float> weights;
};

template <class Preferences>
class Sifter {
 public:
  Sifter(Preferences& preferences, const SiftOptions& options, std::vector<std::uint32_t>& ranks)
      : preferences_(preferences),
        movable_(options.movable),
        step_(options.step),
        ranks_(ranks),
        positions_(ranks.begin(), ranks.end()),
        order_(ranks.size()),
        unsettled_(ranks.size(), 1),
        violated_(ranks.size(), 0) {}

  // Moves every node, from front to back, to the best place among its neighbours. Returns the weight that
  // this saves. Visits a node again only if a neighbour has passed it, or has moved while the node was
  // violated.
  double sweep() {
    for (NodeId node = 0; node < ranks_.size(); ++node) order_[ranks_[node]] = node;
    for (NodeId node = 0; node < ranks_.size(); ++node) positions_[node] = ranks_[node];
    double saved = 0;
    for (const NodeId node : order_) {
      if (unsettled_[node] == 0 || (!movable_.empty() && movable_[node] == 0)) continue;
      unsettled_[node] = 0;
      saved += move(node);
    }
    std::sort(order_.begin(), order_.end(), [&](NodeId a, NodeId b) {
      return positions_[a] != positions_[b] ? positions_[a] < positions_[b] : ranks_[a] < ranks_[b];
    });
    for (std::uint32_t rank = 0; rank < order_.size(); ++rank) ranks_[order_[rank]] = rank;
    return saved;
  }

 private:
  struct Neighbor {
    double position;
    float weight;
    std::uint32_t index;  // in the row; neighbours at the same position keep the order of the row
  };

  double move(NodeId node) {
    const double here = positions_[node];
    // Only places between the outermost violated neighbours can be better than the current one.
    double first = here;
    double last = here;
    const PreferenceRow row = preferences_.row(node, positions_);
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
    // Find the next neighbours outside of the span, which limit the outermost gaps.
    auto [beyond_first, beyond_last] = preferences_.free_range(node);
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
    // Passing a neighbour towards the front changes the cost by -weight, and towards the back by +weight.
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

  // Marks the neighbours that may be violated now: those that the move passed, and those that were violated
  // before.
  void unsettle_neighbors(const PreferenceRow& row, double passed_from, double passed_to) {
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

  // Passes the neighbours one by one and returns the best gap, which is between the last one passed and the
  // next one or `beyond`.
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

  Preferences& preferences_;
  std::span<const std::uint8_t> movable_;
  double step_;
  std::vector<std::uint32_t>& ranks_;
  std::vector<double> positions_;  // ranks, or fractions between them for nodes that moved in this sweep
  std::vector<NodeId> order_;
  std::vector<std::uint8_t> unsettled_;  // nodes to visit in the next sweep
  std::vector<std::uint8_t> violated_;   // nodes with a violated preference at their last visit
  std::vector<Neighbor> before_, after_;
};

}  // namespace pellucid
