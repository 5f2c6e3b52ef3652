// What orders cannot avoid: see bounds.h.
//
// Every order violates an edge of every cycle. So if weights are taken away from the edges of a cycle, the
// same from each, cycle after cycle while something is left, then what was taken away once per cycle adds up
// to a lower bound: the local ratio form of Bar-Yehuda and Even, 1985, or a greedy fractional cycle packing.
// Every cycle has an edge that the given order violates: only around these, cycles of two, three and four
// nodes are looked for, heaviest edge first.
#include "transparency/cluster/bounds.h"

#include <algorithm>
#include <array>
#include <vector>

#include "base/parallel.h"

namespace pellucid {
namespace {

// The lightest violated edges, this share of the violated weight together, are not looked at: most of the
// edges, hardly any bound.
constexpr double kNegligible = 0.1;
// Cycles of four are looked for until this many edges have been followed for each edge that there is: dense
// graphs have more paths of two steps than one has time for.
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

  // Edges into the front nodes of violated ones.
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

  // Cycles that an edge closes with paths of the order, between the ranks of its ends.
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

  // visit(back, edge) for what is left of the edges from `node` to nodes ranked between, while something is
  // left of the closing edge.
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

}  // namespace pellucid
