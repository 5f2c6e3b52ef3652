// Implements tipsify under constraints: only nodes all of whose predecessors are drawn may be drawn.
//
// Based on: Han, Chen, Nehab, Sander, "In-Depth Buffers", PACMCGIT 1(1), 2018, section 4, after Sander,
// Nehab, Barczak, "Fast Triangle Reordering for Vertex Locality and Reduced Overdraw", SIGGRAPH 2007.
#include <functional>
#include <queue>
#include <utility>

#include "sequencing/cache_order.h"

namespace pellucid {
namespace {

class Tipsifier {
 public:
  Tipsifier(const Mesh& mesh, const OrderConstraints& constraints, std::span<const std::uint32_t> ranks,
            std::span<const std::uint8_t> drawn, std::uint32_t cache_size)
      : mesh_(mesh),
        constraints_(constraints),
        ranks_(ranks),
        cache_size_(cache_size),
        predecessors_(drawn.size(), 0),
        emitted_(drawn.size(), 0),
        around_(mesh, drawn),
        entered_(mesh.positions.size(), 0),
        ready_around_(mesh.positions.size(), 0),
        clock_(cache_size + 1) {
    for (const NodeId follower : constraints.followers) ++predecessors_[follower];
    for (NodeId node = 0; node < drawn.size(); ++node) {
      if (drawn[node] != 0 && predecessors_[node] == 0) become_ready(node);
    }
  }

  NodeSequence run() {
    for (std::uint32_t vertex = next_after_dead_end(); vertex != kNoVertex; vertex = next_vertex())
      fan(vertex);
    return std::move(order_);
  }

 private:
  static constexpr std::uint32_t kNoVertex = 0xFFFFFFFFU;

  void become_ready(NodeId node) {
    for (const std::uint32_t v : mesh_.triangles[triangle_of(node)]) ++ready_around_[v];
    ready_by_rank_.push({ranks_[node], node});
  }

  // Draws all ready nodes around a vertex. Drawing a node may make others ready.
  void fan(std::uint32_t vertex) {
    candidates_.clear();
    while (ready_around_[vertex] > 0) {
      for (const NodeId node : around_.of(vertex)) {
        if (emitted_[node] == 0 && predecessors_[node] == 0) emit(node);
      }
    }
  }

  void emit(NodeId node) {
    emitted_[node] = 1;
    order_.push_back(node);
    for (const std::uint32_t v : mesh_.triangles[triangle_of(node)]) {
      --ready_around_[v];
      candidates_.push_back(v);
      recent_.push_back(v);
      if (clock_ - entered_[v] > cache_size_) entered_[v] = clock_++;
    }
    for (std::uint32_t i = constraints_.offsets[node]; i < constraints_.offsets[node + 1]; ++i) {
      const NodeId follower = constraints_.followers[i];
      if (--predecessors_[follower] == 0) become_ready(follower);
    }
  }

  // Returns the next vertex: of the vertices just used, the one longest in the cache that stays there while
  // its nodes are drawn.
  std::uint32_t next_vertex() {
    std::uint32_t best = kNoVertex;
    std::uint64_t best_age = 0;
    bool best_survives = false;
    for (const std::uint32_t v : candidates_) {
      if (ready_around_[v] == 0) continue;
      const std::uint64_t age = clock_ - entered_[v];
      const bool survives = age + 2 * std::uint64_t{ready_around_[v]} <= cache_size_;
      if (best == kNoVertex || (survives && !best_survives) ||
          (survives == best_survives && survives && age > best_age)) {
        best = v;
        best_age = age;
        best_survives = survives;
      }
    }
    return best != kNoVertex ? best : next_after_dead_end();
  }

  // Returns the most recently used vertex with a ready node, or else a vertex of the ready node of least
  // rank.
  std::uint32_t next_after_dead_end() {
    while (!recent_.empty()) {
      const std::uint32_t v = recent_.back();
      recent_.pop_back();
      if (ready_around_[v] > 0) return v;
    }
    while (!ready_by_rank_.empty()) {
      const NodeId node = ready_by_rank_.top().second;
      ready_by_rank_.pop();
      if (emitted_[node] == 0) return mesh_.triangles[triangle_of(node)][0];
    }
    return kNoVertex;
  }

  const Mesh& mesh_;
  const OrderConstraints& constraints_;
  std::span<const std::uint32_t> ranks_;
  std::uint64_t cache_size_;
  std::vector<std::uint32_t> predecessors_;  // per node: predecessors that are not yet drawn
  std::vector<std::uint8_t> emitted_;
  VertexNodes around_;
  std::vector<std::uint64_t> entered_;       // per vertex: the clock when it last entered the cache
  std::vector<std::uint32_t> ready_around_;  // per vertex: ready nodes that are not yet drawn
  std::vector<std::uint32_t> candidates_, recent_;
  using RankedNode = std::pair<std::uint32_t, NodeId>;
  std::priority_queue<RankedNode, std::vector<RankedNode>, std::greater<>> ready_by_rank_;
  std::uint64_t clock_;
  NodeSequence order_;
};

}  // namespace

NodeSequence tipsify(const Mesh& mesh, const OrderConstraints& constraints,
                     std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn,
                     std::uint32_t cache_size) {
  return Tipsifier(mesh, constraints, ranks, drawn, cache_size).run();
}

}  // namespace pellucid
