// Linear orders that violate as little weight as possible: the minimum feedback arc problem, by sifting.
//
// Used for transparency (nodes are facings, weights are wrongly drawn areas) and open to any other items and
// costs that can be written as "weight lost if u comes after v".
// Sifting: C. Brandenburg, K. Hanauer, "Sorting heuristics for the feedback arc set problem", 2011. Differs
// in: only the span between a node's violated neighbours is searched, so that a sweep over a good order costs
// one pass over the edges.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "transparency/graph/occlusion_graph.h"

namespace pellucid {

// Net wishes between pairs: for u's neighbour v, weight > 0 means "u before v saves this much", < 0 the
// opposite. Every pair stands in both rows with opposite signs; one that wishes for both directions stands
// there twice, once with the difference and once with 0.
struct PairWishes {
  std::vector<std::uint32_t> offsets;  // nodes + 1
  std::vector<NodeId> neighbors;
  std::vector<float> weights;
  double unavoidable = 0;  // sum over pairs of the lighter direction: violated by every order
};
PairWishes net_wishes(const EdgeRows& edges);

// Violated weight of an order (rank by node), without `unavoidable`. O(edges).
double violated_weight(const PairWishes& wishes, std::span<const std::uint32_t> ranks);

struct SiftOptions {
  std::uint32_t sweeps = 10;
  // Stop when a sweep lowers the violated weight by less than this share.
  double least_gain = 0.01;
  // Nodes that may move (one flag a node); empty: all. The others' wishes need not be complete.
  std::span<const std::uint8_t> movable;
  // A node lands at most so many ranks behind the one it passes, else in the middle of the gap. Where other
  // nodes may lie in the gap whose wishes are not known, it should be close.
  double step = std::numeric_limits<double>::infinity();
  const Progress* progress = nullptr;  // may stop it
};
// Improve `ranks` (a permutation of 0 .. nodes - 1) in place; never makes it worse. Returns the violated
// weight. O(edges) a sweep, plus sorting of what violated nodes look at.
double sift(const PairWishes& wishes, const SiftOptions& options, std::vector<std::uint32_t>& ranks);

// Ranks of nodes sorted by key, ties by node.
std::vector<std::uint32_t> ranks_by_key(std::span<const double> keys);

}  // namespace pellucid
