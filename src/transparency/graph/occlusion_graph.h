// Builds the occlusion graph of every view cell: the union of the edges that are seen from its samples, with
// their mean weights. In: a mesh and a view partition. Out: one set of edge rows per cell.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/sequencing.h"
#include "pellucid/transparency.h"
#include "pellucid/view.h"
#include "sequencing/edge_rows.h"
#include "transparency/run_records.h"

namespace pellucid {

struct OcclusionGraph {
  std::uint32_t node_count = 0;    // 2 * triangles
  std::vector<CompactRows> cells;  // one per view cell
  bool spilled = false;            // some of them are in a file to save memory
  std::uint64_t viewpoint_count = 0;
  std::uint64_t viewpoint_edges = 0;  // summed over viewpoints
  std::uint64_t intersecting = 0;     // intersecting pairs, summed over viewpoints
  double total_weight = 0;            // summed over cells
  double pruned_weight = 0;           // share of total_weight that lay in edges too light to keep
};

struct GraphOptions {
  std::vector<double> distances;  // bounding radii
  // true: every sample is seen from every distance. false: the samples of a cell alternate between the
  // distances, which finds nearly the same edges.
  bool all_distances = false;
  double tolerance = 0;
  // Edges lighter than this (mean square radii) are left out.
  float least_weight = 0;
  OcclusionSource source = OcclusionSource::exact;
  std::uint32_t raster_size = 512;
  double alpha = 0;  // OrderOptions::alpha
  bool front_only = false;
  // The memory budget of the cells in bytes. Cells that do not fit go to a temporary file. 0: all stay in
  // memory.
  std::uint64_t memory = 0;
  // T[n], R[n]: the edges of all viewpoints of a cell between these distances are found, bounding radii.
  // Edges have the weights that the samples show, but at least kUnseenWeight. No edge is left out because it
  // is light.
  double solid_from = 0, solid_to = 0;
  Progress* progress = nullptr;
  RunRecords records{};  // keeps every batch of cells
};
// The weight of edges that no sample shows, square radii, mean over a cell. It is the weight of the lightest
// edges that are kept of S[n,m].
constexpr float kUnseenWeight = 3e-7F;

// Builds the graph. Takes O(viewpoints * (triangles + pairs)) time, and memory for the edges of all cells (4
// bytes each) and for the edges of the viewpoints of a few cells at a time.
OcclusionGraph build_occlusion_graph(const Mesh& mesh, const BoundingSphere& sphere,
                                     const ViewPartition& partition, const GraphOptions& options);

// Sums rows of many graphs without sorting: a dense accumulator per row (Gustavson's sparse accumulator),
// with two levels of marks that find the used entries in order.
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
  // Appends the row to `rows`, sorted by back node and without entries below `least`, and clears it. Returns
  // the weight that was left out.
  double flush(EdgeRows& rows, float least);

 private:
  std::vector<float> sums_;
  std::vector<std::uint64_t> marks_;         // one bit a node
  std::vector<std::uint64_t> marked_words_;  // one bit a word of marks_
};

// Returns the sum of the graphs of some cells, without edges that weigh less than `least` in total.
EdgeRows sum_cells(const OcclusionGraph& graph, std::span<const std::uint32_t> cells, float least = 0);

}  // namespace pellucid
