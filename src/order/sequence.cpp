// From a partial order to a drawing sequence: see sequence.h.
#include "sequence.h"

#include <algorithm>
#include <functional>
#include <queue>

namespace pellucid {
namespace {

class Tipsifier {
 public:
  Tipsifier(const Mesh& mesh, const SequenceConstraints& constraints, std::span<const std::uint32_t> ranks,
            std::span<const std::uint8_t> drawn, std::uint32_t cache_size)
      : mesh_(mesh),
        constraints_(constraints),
        ranks_(ranks),
        drawn_(drawn),
        cache_size_(cache_size),
        predecessors_(drawn.size(), 0),
        emitted_(drawn.size(), 0),
        entered_(mesh.positions.size(), 0),
        ready_around_(mesh.positions.size(), 0),
        clock_(cache_size + 1) {
    for (const NodeId follower : constraints.followers) ++predecessors_[follower];
    list_nodes_around_vertices();
    for (NodeId node = 0; node < drawn.size(); ++node) {
      if (drawn[node] != 0 && predecessors_[node] == 0) become_ready(node);
    }
  }

  NodeSequence run() {
    for (std::uint32_t vertex = next_after_dead_end(); vertex != kNoVertex; vertex = next_vertex())
      fan(vertex);
    return std::move(sequence_);
  }

 private:
  static constexpr std::uint32_t kNoVertex = 0xFFFFFFFFU;

  void list_nodes_around_vertices() {
    around_offsets_.assign(mesh_.positions.size() + 1, 0);
    for_each_drawn([&](NodeId node) {
      for (const std::uint32_t v : mesh_.triangles[triangle_of(node)]) ++around_offsets_[v + 1];
    });
    for (std::size_t v = 0; v + 1 < around_offsets_.size(); ++v) around_offsets_[v + 1] += around_offsets_[v];
    around_.resize(around_offsets_.back());
    std::vector<std::uint32_t> cursor(around_offsets_.begin(), around_offsets_.end() - 1);
    for_each_drawn([&](NodeId node) {
      for (const std::uint32_t v : mesh_.triangles[triangle_of(node)]) around_[cursor[v]++] = node;
    });
  }

  template <class Function>
  void for_each_drawn(const Function& function) {
    for (NodeId node = 0; node < drawn_.size(); ++node) {
      if (drawn_[node] != 0) function(node);
    }
  }

  void become_ready(NodeId node) {
    for (const std::uint32_t v : mesh_.triangles[triangle_of(node)]) ++ready_around_[v];
    ready_by_rank_.push({ranks_[node], node});
  }

  // Draw everything ready around a vertex; drawing one node may make the next one ready.
  void fan(std::uint32_t vertex) {
    candidates_.clear();
    while (ready_around_[vertex] > 0) {
      for (std::uint32_t i = around_offsets_[vertex]; i < around_offsets_[vertex + 1]; ++i) {
        const NodeId node = around_[i];
        if (emitted_[node] == 0 && predecessors_[node] == 0) emit(node);
      }
    }
  }

  void emit(NodeId node) {
    emitted_[node] = 1;
    sequence_.push_back(node);
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

  // Of the vertices just used, the one longest in the cache that will still be there after its fan.
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

  // The most recently used vertex with something ready around it, else the ready node of least rank.
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
  const SequenceConstraints& constraints_;
  std::span<const std::uint32_t> ranks_;
  std::span<const std::uint8_t> drawn_;
  std::uint64_t cache_size_;
  std::vector<std::uint32_t> predecessors_;  // not yet drawn, per node
  std::vector<std::uint8_t> emitted_;
  std::vector<std::uint32_t> around_offsets_;  // nodes around a vertex
  std::vector<NodeId> around_;
  std::vector<std::uint64_t> entered_;       // clock when the vertex last entered the cache
  std::vector<std::uint32_t> ready_around_;  // ready nodes around a vertex, not yet drawn
  std::vector<std::uint32_t> candidates_, recent_;
  using RankedNode = std::pair<std::uint32_t, NodeId>;
  std::priority_queue<RankedNode, std::vector<RankedNode>, std::greater<>> ready_by_rank_;
  std::uint64_t clock_;
  NodeSequence sequence_;
};

}  // namespace

SequenceConstraints agreeing_edges(const EdgeRows& edges, std::span<const std::uint32_t> ranks,
                                   std::span<const std::uint8_t> drawn, float least) {
  SequenceConstraints constraints;
  constraints.offsets.reserve(edges.offsets.size());
  constraints.offsets.push_back(0);
  for (NodeId front = 0; front < edges.node_count(); ++front) {
    for (std::uint32_t i = edges.offsets[front]; drawn[front] != 0 && i < edges.offsets[front + 1]; ++i) {
      const NodeId back = edges.backs[i];
      if (drawn[back] != 0 && edges.weights[i] >= least && ranks[front] < ranks[back]) {
        constraints.followers.push_back(back);
      }
    }
    constraints.offsets.push_back(static_cast<std::uint32_t>(constraints.followers.size()));
  }
  return constraints;
}

NodeSequence cache_aware_sequence(const Mesh& mesh, const SequenceConstraints& constraints,
                                  std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn,
                                  std::uint32_t cache_size) {
  return Tipsifier(mesh, constraints, ranks, drawn, cache_size).run();
}

NodeSequence rank_sequence(std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn) {
  NodeSequence sequence;
  for (NodeId node = 0; node < drawn.size(); ++node) {
    if (drawn[node] != 0) sequence.push_back(node);
  }
  std::sort(sequence.begin(), sequence.end(), [&](NodeId a, NodeId b) { return ranks[a] < ranks[b]; });
  return sequence;
}

}  // namespace pellucid
