// Computes lower bounds of the violated weight (declared in clustering.h) and of the number of acyclic
// clusters (declared in edge_set.h).
//
// Every order violates an edge of every cycle. If the same weight is taken away from each edge of a cycle,
// and then of another cycle, as long as weights are left, the sum of the weights taken away once per cycle is
// a lower bound. This is the local ratio method of Bar-Yehuda and Even, 1985, or a greedy fractional cycle
// packing. Every cycle has an edge that the given order violates. So cycles of two, three and four nodes are
// searched for around these edges only, heaviest edge first.
#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "base/parallel.h"
#include "transparency/cluster/clustering.h"
#include "transparency/cluster/edge_set.h"

namespace pellucid {

// ------------------------------------------------------------------------------------------- violated weight

namespace {

// The lightest violated edges with this share of the violated weight in total are not used. They are most of
// the edges and add hardly anything to the bound.
constexpr double kNegligible = 0.1;
// The search for cycles of four stops when this many edges have been followed for each edge of the graph,
// because dense graphs have too many paths of two steps.
constexpr std::uint64_t kStepsPerEdge = 8;

class CyclePacking {
 public:
  CyclePacking(const EdgeRows& edges, std::span<const std::uint32_t> ranks)
      : edges_(edges), left_(edges.weights), ranks_(ranks), marks_(edges.node_count(), kNoEdgeTo) {}

  double run() {
    collect_violated();
    collect_incoming();
    for (const Edge& edge : violated_) pack_around(edge);
    return packed_;
  }

 private:
  static constexpr std::uint32_t kNoEdgeTo = 0xFFFFFFFFU;
  struct Edge {
    NodeId front;
    std::uint32_t index;
  };

  void collect_violated() {
    double total = 0;
    for (NodeId front = 0; front < edges_.node_count(); ++front) {
      for (std::uint32_t i = edges_.offsets[front]; i < edges_.offsets[front + 1]; ++i) {
        if (ranks_[edges_.backs[i]] > ranks_[front]) continue;
        violated_.push_back({front, i});
        total += static_cast<double>(edges_.weights[i]);
      }
    }
    std::sort(violated_.begin(), violated_.end(), [&](const Edge& a, const Edge& b) {
      const float x = edges_.weights[a.index];
      const float y = edges_.weights[b.index];
      return x != y ? x > y : a.index < b.index;
    });
    double kept = 0;
    std::size_t count = 0;
    while (count < violated_.size() && kept < (1 - kNegligible) * total)
      kept += static_cast<double>(edges_.weights[violated_[count++].index]);
    violated_.resize(count);
  }

  // Collects the edges into the front nodes of violated edges.
  void collect_incoming() {
    std::vector<std::uint8_t> wanted(edges_.node_count(), 0);
    for (const Edge& edge : violated_) wanted[edge.front] = 1;
    incoming_.resize(edges_.node_count());
    for (NodeId front = 0; front < edges_.node_count(); ++front) {
      for (std::uint32_t i = edges_.offsets[front]; i < edges_.offsets[front + 1]; ++i) {
        if (wanted[edges_.backs[i]] != 0) incoming_[edges_.backs[i]].push_back({front, i});
      }
    }
  }

  // Packs the cycles that an edge closes with paths of the order between the ranks of its ends.
  void pack_around(const Edge& closing) {
    const NodeId last = closing.front;
    const NodeId first = edges_.backs[closing.index];
    for (const Edge& edge : incoming_[last]) {
      if (edge.front == first || is_between(edge.front, first, last)) marks_[edge.front] = edge.index;
    }
    if (marks_[first] != kNoEdgeTo) pack<2>({closing.index, marks_[first]});
    for_each_step(first, first, last, closing, [&](NodeId next, std::uint32_t step) {
      if (marks_[next] != kNoEdgeTo) pack<3>({closing.index, step, marks_[next]});
    });
    for_each_step(first, first, last, closing, [&](NodeId next, std::uint32_t step) {
      if (steps_ >= kStepsPerEdge * edges_.backs.size()) return;
      steps_ += edges_.offsets[next + 1] - edges_.offsets[next];
      for_each_step(next, first, last, closing, [&](NodeId after, std::uint32_t second) {
        if (marks_[after] != kNoEdgeTo) pack<4>({closing.index, step, second, marks_[after]});
      });
    });
    for (const Edge& edge : incoming_[last]) marks_[edge.front] = kNoEdgeTo;
  }

  [[nodiscard]] bool is_between(NodeId node, NodeId first, NodeId last) const {
    return ranks_[first] < ranks_[node] && ranks_[node] < ranks_[last];
  }

  // Calls visit(back, edge) for the edges from `node` to nodes ranked between the two that have weight left,
  // as long as the closing edge has weight left.
  template <class Visit>
  void for_each_step(NodeId node, NodeId first, NodeId last, const Edge& closing, const Visit& visit) {
    for (std::uint32_t i = edges_.offsets[node]; i < edges_.offsets[node + 1]; ++i) {
      if (!(left_[closing.index] > 0)) return;
      if (left_[i] > 0 && is_between(edges_.backs[i], first, last)) visit(edges_.backs[i], i);
    }
  }

  template <std::size_t kLength>
  void pack(const std::array<std::uint32_t, kLength>& cycle) {
    float least = left_[cycle[0]];
    for (const std::uint32_t i : cycle) least = std::min(least, left_[i]);
    for (const std::uint32_t i : cycle) left_[i] -= least;
    packed_ += static_cast<double>(least);
  }

  const EdgeRows& edges_;
  std::vector<float> left_;  // of every weight
  std::span<const std::uint32_t> ranks_;
  std::vector<Edge> violated_;
  std::vector<std::vector<Edge>> incoming_;
  std::vector<std::uint32_t> marks_;  // per node: its edge to the front node of the violated edge
  std::uint64_t steps_ = 0;           // second ones of paths
  double packed_ = 0;
};

}  // namespace

double unavoidable_weight(const EdgeRows& edges, std::span<const std::uint32_t> ranks) {
  return CyclePacking(edges, ranks).run();
}

double unavoidable_in_cells(const OcclusionGraph& graph, const Clustering& clustering) {
  std::vector<double> bounds(graph.cells.size(), 0.0);
  parallel_loop(std::size_t{0}, graph.cells.size(), [&](std::size_t cell) {
    bounds[cell] =
        unavoidable_weight(graph.cells[cell].expanded(), clustering.ranks[clustering.cluster_of[cell]]);
  });
  double sum = 0;
  for (const double bound : bounds) sum += bound;
  return sum;
}

// ------------------------------------------------------------------------------------------ number of orders

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

// For each pair of opposite edges, two bits that say which of the two edges a cell has.
struct Directions {
  BitSet forward, backward;
};

std::vector<Directions> directions_of(const EdgeTable& table, std::span<const EdgeSet> cells) {
  // The first edge of every pair of opposite edges, by id.
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

// Grows a clique from `first`. Of the cells that contradict all chosen ones, the next is the one that leaves
// the most other cells possible.
std::vector<std::uint32_t> greedy_clique(const std::vector<BitSet>& contradicting, std::uint32_t first) {
  std::vector<std::uint32_t> clique{first};
  BitSet possible = contradicting[first];
  for (;;) {
    int most = -1;
    std::uint32_t best = 0;
    for (std::uint32_t cell = 0; cell < contradicting.size(); ++cell) {
      if ((possible[cell / 64] >> (cell % 64) & 1U) == 0) continue;
      int left = 0;
      for (std::size_t word = 0; word < possible.size(); ++word)
        left += std::popcount(possible[word] & contradicting[cell][word]);
      if (left > most) {
        most = left;
        best = cell;
      }
    }
    if (most < 0) return clique;
    clique.push_back(best);
    for (std::size_t word = 0; word < possible.size(); ++word) possible[word] &= contradicting[best][word];
  }
}

}  // namespace

std::vector<std::uint32_t> contradicting_cells(const EdgeTable& table, std::span<const EdgeSet> cells) {
  const std::vector<Directions> directions = directions_of(table, cells);
  std::vector<BitSet> contradicting(cells.size(), BitSet((cells.size() + 63) / 64, 0));
  parallel_loop(std::size_t{0}, cells.size(), [&](std::size_t cell) {
    for (std::size_t other = 0; other < cells.size(); ++other) {
      if (intersect(directions[cell].forward, directions[other].backward) ||
          intersect(directions[cell].backward, directions[other].forward)) {
        set_bit(contradicting[cell], other);
      }
    }
  });
  std::vector<std::vector<std::uint32_t>> cliques(cells.size());
  parallel_loop(std::size_t{0}, cells.size(), [&](std::size_t cell) {
    cliques[cell] = greedy_clique(contradicting, static_cast<std::uint32_t>(cell));
  });
  const auto largest = std::max_element(cliques.begin(), cliques.end(),
                                        [](const auto& a, const auto& b) { return a.size() < b.size(); });
  return largest == cliques.end() ? std::vector<std::uint32_t>{} : *largest;
}

}  // namespace pellucid
