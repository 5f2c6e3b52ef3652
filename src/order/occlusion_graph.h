// The occlusion graph of every view cell: the union of the edges seen from its samples, weighted.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/order.h"
#include "pellucid/view.h"

namespace pellucid {

// Weighted edges front -> back between nodes, in rows by front node. The weight of an edge is the area of the
// picture (square bounding radii) in which front covers back, averaged over the viewpoints that the graph
// stands for.
struct EdgeRows {
  std::vector<std::uint32_t> offsets;  // nodes + 1
  std::vector<NodeId> backs;
  std::vector<float> weights;

  [[nodiscard]] std::uint32_t node_count() const {
    return static_cast<std::uint32_t>(offsets.empty() ? 0 : offsets.size() - 1);
  }
  [[nodiscard]] std::uint64_t edge_count() const { return backs.size(); }
};

// The same in half the memory: a word an edge, of which the upper half is the weight (its upper 16 bits as a
// float, an error of 0.4 % at most) and the lower half the distance to the row's last back node. An edge that
// is farther away comes after a few of weight zero, which say nothing but bridge the distance.
class CompactRows {
 public:
  CompactRows() = default;
  explicit CompactRows(const EdgeRows& rows);  // sorted by back node

  [[nodiscard]] std::uint32_t node_count() const {
    return static_cast<std::uint32_t>(offsets_.empty() ? 0 : offsets_.size() - 1);
  }
  [[nodiscard]] std::uint64_t edge_count() const { return edge_count_; }
  [[nodiscard]] EdgeRows expanded() const;

  // visit(back, weight) for the row's edges, sorted by back node.
  template <typename Visit>
  void for_each(NodeId front, Visit visit) const {
    NodeId back = 0;
    for (std::uint32_t i = offsets_[front]; i < offsets_[front + 1]; ++i) {
      const std::uint32_t word = words_[i];
      back += word & kDistanceMask;
      const auto weight = std::bit_cast<float>(word & ~kDistanceMask);
      if (weight > 0) visit(back, weight);
    }
  }

 private:
  static constexpr std::uint32_t kDistanceMask = 0xFFFF;

  std::vector<std::uint32_t> offsets_;  // nodes + 1
  std::vector<std::uint32_t> words_;
  std::uint64_t edge_count_ = 0;
};

struct OcclusionGraph {
  std::uint32_t node_count = 0;    // 2 * triangles
  std::vector<CompactRows> cells;  // one per view cell
  std::uint64_t viewpoint_count = 0;
  std::uint64_t viewpoint_edges = 0;  // summed over viewpoints
  std::uint64_t intersecting = 0;     // intersecting pairs, summed over viewpoints
  double total_weight = 0;            // summed over cells
  double pruned_weight = 0;           // share of total_weight that lay in edges too light to keep
};

struct GraphOptions {
  std::vector<double> distances;  // bounding radii
  // Every sample at every distance; else the samples of a cell take turns, which finds nearly the same edges.
  bool all_distances = false;
  double tolerance = 0;
  // Edges lighter than this (mean square radii) are left out.
  float least_weight = 0;
  OcclusionSource source = OcclusionSource::exact;
  std::uint32_t raster_size = 512;
  bool front_only = false;
  Progress* progress = nullptr;
};

// O(viewpoints * (triangles + pairs)); memory: the cells' edges (4 bytes each) and the edges of the
// viewpoints of a few cells at a time.
OcclusionGraph build_occlusion_graph(const Mesh& mesh, const BoundingSphere& sphere,
                                     const ViewPartition& partition, const GraphOptions& options);

// Adds up rows of many graphs without sorting keys: a dense accumulator per row (Gustavson's sparse
// accumulator), with two levels of marks to find what was touched, in order.
class RowAccumulator {
 public:
  explicit RowAccumulator(std::uint32_t node_count)
      : sums_(node_count, 0.0F), marks_(node_count / 64 + 1, 0), marked_words_(marks_.size() / 64 + 1, 0) {}

  void add(std::span<const NodeId> backs, std::span<const float> weights, float scale) {
    for (std::size_t i = 0; i < backs.size(); ++i) add(backs[i], weights[i] * scale);
  }
  void add(NodeId back, float weight) {
    sums_[back] += weight;
    marks_[back / 64] |= std::uint64_t{1} << (back % 64);
    marked_words_[back / 4096] |= std::uint64_t{1} << (back / 64 % 64);
  }
  // Append the row to `rows`, sorted by back node, without entries below `least`, and clear. Returns the
  // weight left out.
  double flush(EdgeRows& rows, float least);

 private:
  std::vector<float> sums_;
  std::vector<std::uint64_t> marks_;         // one bit a node
  std::vector<std::uint64_t> marked_words_;  // one bit a word of marks_
};

// Sum of the graphs of some cells, without edges that weigh less than `least` in total.
EdgeRows sum_cells(const OcclusionGraph& graph, std::span<const std::uint32_t> cells, float least = 0);

}  // namespace pellucid
