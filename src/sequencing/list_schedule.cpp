// Implements list scheduling for the vertex cache: of all nodes that may be drawn next, it draws the one with
// the best score.
//
// Based on: list scheduling of instructions under register pressure, with a score as in Forsyth,
// "Linear-Speed Vertex Cache Optimisation", 2006. Differs in: a simulated first-in first-out cache, a set of
// ready nodes, and the height of a node, which is the longest chain of followers that wait for it.
#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

#include "sequencing/cache_order.h"

namespace pellucid {
namespace {

// Weights of the score, from a random search over the constraints of six meshes (docs/in-depth-buffers.md).
constexpr double kFree = 100;    // for a node without misses, which comes before all others
constexpr double kMiss = -0.86;  // for each vertex that is not in the cache
constexpr double kFewUsesLeft =
    1.34;                         // over the root of the undrawn nodes of a vertex, to finish vertices early
constexpr double kAge = 0.5;      // for the age of the oldest cached vertex; 1: about to leave the cache
constexpr double kHeight = 0.86;  // for the longest chain of followers; 1: the longest of all nodes
// Vertices with more nodes do not propose candidates, because large fans would make the search quadratic.
constexpr std::size_t kMostUsesToPropose = 64;

class ListScheduler {
 public:
  ListScheduler(const Mesh& mesh, const OrderConstraints& constraints, std::span<const std::uint32_t> ranks,
                std::span<const std::uint8_t> drawn, std::uint32_t cache_size)
      : mesh_(mesh),
        constraints_(constraints),
        ranks_(ranks),
        cache_size_(cache_size),
        around_(mesh, drawn),
        blockers_(drawn.size(), 0),
        heights_(heights(order_by_rank(ranks, drawn))),
        states_(drawn.size(), State::blocked),
        leaves_at_(mesh.positions.size(), 0),
        undrawn_around_(mesh.positions.size(), 0),
        ready_around_(mesh.positions.size(), 0) {
    for (const NodeId follower : constraints.followers) ++blockers_[follower];
    for (NodeId node = 0; node < drawn.size(); ++node) {
      if (drawn[node] == 0) continue;
      for (const std::uint32_t v : corners(node)) ++undrawn_around_[v];
      if (blockers_[node] == 0) become_ready(node);
    }
  }

  NodeSequence run() {
    for (NodeId node = next(); node != kNone; node = next()) draw(node);
    return std::move(order_);
  }

 private:
  enum class State : std::uint8_t { blocked, ready, done };
  static constexpr NodeId kNone = 0xFFFFFFFFU;

  [[nodiscard]] const Triangle& corners(NodeId node) const { return mesh_.triangles[triangle_of(node)]; }
  [[nodiscard]] bool cached(std::uint32_t vertex) const { return misses_ < leaves_at_[vertex]; }

  // Returns the length of the longest chain of followers of every node, relative to the longest of all.
  [[nodiscard]] std::vector<float> heights(const NodeSequence& topological) const {
    std::vector<std::uint32_t> lengths(blockers_.size(), 0);
    std::uint32_t longest = 1;
    for (std::size_t i = topological.size(); i-- > 0;) {
      const NodeId node = topological[i];
      for (const NodeId follower : constraints_.followers_of(node)) {
        lengths[node] = std::max(lengths[node], lengths[follower] + 1);
      }
      longest = std::max(longest, lengths[node]);
    }
    std::vector<float> shares(lengths.size());
    std::transform(lengths.begin(), lengths.end(), shares.begin(), [&](std::uint32_t length) {
      return static_cast<float>(length) / static_cast<float>(longest);
    });
    return shares;
  }

  void become_ready(NodeId node) {
    states_[node] = State::ready;
    for (const std::uint32_t v : corners(node)) ++ready_around_[v];
    ready_by_rank_.push({ranks_[node], node});
  }

  void draw(NodeId node) {
    states_[node] = State::done;
    order_.push_back(node);
    for (const std::uint32_t v : corners_of(mesh_, node)) {
      --ready_around_[v];
      --undrawn_around_[v];
      if (cached(v)) continue;
      ++misses_;
      leaves_at_[v] = misses_ + cache_size_;
      entered_.push_back(v);
    }
    for (const NodeId follower : constraints_.followers_of(node)) {
      if (--blockers_[follower] == 0) become_ready(follower);
    }
  }

  // Returns the best ready node around a cached vertex, or else the ready node of least rank.
  NodeId next() {
    NodeId best = kNone;
    double best_score = 0;
    const std::size_t newest = std::min<std::size_t>(entered_.size(), cache_size_);
    for (const std::uint32_t v : std::span(entered_).last(newest)) {
      if (ready_around_[v] == 0 || around_.of(v).size() > kMostUsesToPropose) continue;
      for (const NodeId node : around_.of(v)) {
        if (states_[node] != State::ready) continue;
        const double s = score(node);
        if (best == kNone || s > best_score || (s == best_score && ranks_[node] < ranks_[best])) {
          best = node;
          best_score = s;
        }
      }
    }
    return best != kNone ? best : next_by_rank();
  }

  NodeId next_by_rank() {
    while (!ready_by_rank_.empty()) {
      const NodeId node = ready_by_rank_.top().second;
      ready_by_rank_.pop();
      if (states_[node] == State::ready) return node;
    }
    return kNone;
  }

  [[nodiscard]] double score(NodeId node) const {
    double score = kHeight * static_cast<double>(heights_[node]);
    std::uint64_t oldest = 0;
    bool free = true;
    for (const std::uint32_t v : corners(node)) {
      score += kFewUsesLeft / std::sqrt(static_cast<double>(undrawn_around_[v]));
      if (cached(v)) {
        oldest = std::max(oldest, misses_ + cache_size_ - leaves_at_[v]);
      } else {
        score += kMiss;
        free = false;
      }
    }
    return score + kAge * static_cast<double>(oldest) / static_cast<double>(cache_size_) + (free ? kFree : 0);
  }

  const Mesh& mesh_;
  const OrderConstraints& constraints_;
  std::span<const std::uint32_t> ranks_;
  std::uint64_t cache_size_;
  VertexNodes around_;
  std::vector<std::uint32_t> blockers_;  // per node: predecessors that are not yet drawn
  std::vector<float> heights_;
  std::vector<State> states_;
  std::vector<std::uint64_t> leaves_at_;  // per vertex: the number of misses at which it leaves the cache
  std::vector<std::uint32_t> undrawn_around_, ready_around_;
  std::vector<std::uint32_t> entered_;  // vertices in the order of their misses
  using RankedNode = std::pair<std::uint32_t, NodeId>;
  std::priority_queue<RankedNode, std::vector<RankedNode>, std::greater<>> ready_by_rank_;
  std::uint64_t misses_ = 0;
  NodeSequence order_;
};

}  // namespace

NodeSequence list_schedule(const Mesh& mesh, const OrderConstraints& constraints,
                           std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn,
                           std::uint32_t cache_size) {
  return ListScheduler(mesh, constraints, ranks, drawn, cache_size).run();
}

}  // namespace pellucid
