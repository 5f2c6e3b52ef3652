// Implements occlusion_graph.h: finds the edges of every viewpoint, sums them to the edges of view cells, and
// stores these in memory or in a file.
#include "transparency/graph/occlusion_graph.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <mutex>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "transparency/graph/region_edges.h"
#include "transparency/graph/viewpoint_edges.h"

namespace pellucid {
namespace {

// Neighbouring cells share samples. Cells are processed in batches of neighbours (their numbering follows the
// subdivision). The edges of a sample are found when the first cell needs them, and freed after the last.
constexpr std::uint32_t kCellsPerBatch = 16;
// Finding the edges that no sample of a cell shows takes about as long as this many viewpoints.
constexpr std::uint32_t kViewsPerRegion = 10;

// The record of a batch of cells.
struct BatchEdges {
  std::span<CompactRows> cells;
  std::span<double> weights, pruned;  // per cell
  // Counts over the viewpoints that no earlier batch needed.
  std::uint64_t viewpoint_edges = 0, intersecting = 0;
};
template <class Archive, RecordOf<BatchEdges> T>
void fields(Archive& archive, T& batch) {
  for (CompactRows& cell : batch.cells) archive(cell);
  for (double& weight : batch.weights) archive(weight);
  for (double& weight : batch.pruned) archive(weight);
  archive(batch.viewpoint_edges, batch.intersecting);
}

class GraphBuilder {
 public:
  GraphBuilder(const Mesh& mesh, const BoundingSphere& sphere, const ViewPartition& partition,
               const GraphOptions& options)
      : scene_{mesh,
               sphere,
               unit_positions(mesh, sphere),
               options.front_only,
               options.tolerance,
               options.raster_size,
               options.alpha},
        partition_(partition),
        options_(options),
        views_per_sample_(options.all_distances ? options.distances.size() : 1),
        views_(partition.samples.size() * views_per_sample_),
        counted_(views_.size(), 0),
        uses_left_(partition.samples.size(), 0),
        accumulators_(
            [n = mesh.triangles.size()] { return RowAccumulator(static_cast<std::uint32_t>(2 * n)); }) {
    for (const std::uint32_t sample : partition.cell_samples) ++uses_left_[sample];
    if (is_continuous(partition.spec)) {
      region_.emplace(mesh.triangles, scene_.positions, partition, options.front_only, options.tolerance,
                      options.solid_from, options.solid_to);
    }
  }

  OcclusionGraph build() {
    OcclusionGraph graph;
    graph.node_count = static_cast<std::uint32_t>(2 * scene_.mesh.triangles.size());
    graph.cells.resize(partition_.cell_count());
    graph.viewpoint_count = views_.size();
    begin_stage(options_.progress, "occlusion graph",
                views_.size() + (region_ ? kViewsPerRegion * partition_.cell_count() : 0));
    std::vector<double> weights(partition_.cell_count());
    std::vector<double> pruned(partition_.cell_count());
    for (std::uint32_t begin = 0; begin < partition_.cell_count(); begin += kCellsPerBatch) {
      const std::uint32_t end = std::min(begin + kCellsPerBatch, partition_.cell_count());
      const std::uint32_t count = end - begin;
      BatchEdges batch{std::span(graph.cells).subspan(begin, count), std::span(weights).subspan(begin, count),
                       std::span(pruned).subspan(begin, count)};
      const std::string name = std::string("graph-").append(std::to_string(begin / kCellsPerBatch));
      const std::vector<std::size_t> views = views_of(begin, end);
      if (restore(name, batch)) {
        advance_stage(options_.progress, count_views(views));
      } else {
        find_missing(views, batch);
        parallel_loop(begin, end, [&](std::uint32_t cell) {
          unite_cell(cell, graph.cells[cell], weights[cell], pruned[cell]);
        });
        record(options_.records, name, batch);
        count_views(views);
      }
      graph.viewpoint_edges += batch.viewpoint_edges;
      graph.intersecting += batch.intersecting;
      for (CompactRows& cell : batch.cells) keep_within_memory(cell);
      release_views(begin, end);
    }
    graph.spilled = spill_file_ != nullptr;
    graph.total_weight = std::accumulate(weights.begin(), weights.end(), 0.0);
    const double left_out = std::accumulate(pruned.begin(), pruned.end(), 0.0);
    graph.pruned_weight = graph.total_weight > 0 ? left_out / graph.total_weight : 0;
    return graph;
  }

 private:
  [[nodiscard]] std::size_t view_index(std::uint32_t sample, std::size_t nth) const {
    return sample * views_per_sample_ + nth;
  }

  // Returns the views of some cells, each once.
  [[nodiscard]] std::vector<std::size_t> views_of(std::uint32_t begin, std::uint32_t end) const {
    std::vector<std::size_t> views;
    for (std::uint32_t cell = begin; cell < end; ++cell) {
      for (const std::uint32_t sample : partition_.samples_of(cell)) {
        for (std::size_t d = 0; d < views_per_sample_; ++d) views.push_back(view_index(sample, d));
      }
    }
    std::sort(views.begin(), views.end());
    views.erase(std::unique(views.begin(), views.end()), views.end());
    return views;
  }

  void find_missing(std::vector<std::size_t> views, BatchEdges& batch) {
    std::erase_if(views, [&](std::size_t view) { return !views_[view].offsets.empty(); });
    parallel_loop(std::size_t{0}, views.size(), [&](std::size_t i) {
      stop_if_requested(options_.progress);
      find_view(views[i]);
      if (counted_[views[i]] == 0) advance_stage(options_.progress, 1);
    });
    for (const std::size_t view : views) {
      // A restored batch has already counted the views that it shares with this one.
      if (counted_[view] != 0) continue;
      batch.viewpoint_edges += views_[view].backs.size();
      batch.intersecting += views_[view].intersecting;
    }
  }

  bool restore(const std::string& name, BatchEdges& batch) {
    const std::optional<std::vector<std::byte>> bytes = options_.records.load(name);
    if (!bytes) return false;
    if (RecordReader(*bytes).read(batch)) return true;
    options_.records.refuse(name);
    batch.viewpoint_edges = batch.intersecting = 0;
    return false;
  }

  // Marks views as counted. Returns the number of views that had not been counted before.
  std::uint64_t count_views(const std::vector<std::size_t>& views) {
    std::uint64_t fresh = 0;
    for (const std::size_t view : views) fresh += counted_[view] == 0 ? 1U : 0U;
    for (const std::size_t view : views) counted_[view] = 1;
    return fresh;
  }

  void find_view(std::size_t view) {
    // With one view per sample, view numbers are sample numbers, and neighbouring samples alternate between
    // distances.
    const Viewpoint viewpoint{partition_.samples[view / views_per_sample_],
                              options_.distances[view % options_.distances.size()]};
    OcclusionScratch& scratch = scratch_.local();
    if (options_.source == OcclusionSource::exact) {
      find_edges_exactly(scene_, viewpoint, scratch, views_[view]);
    } else {
      find_edges_by_raster(scene_, viewpoint, scratch, views_[view]);
    }
  }

  void unite_cell(std::uint32_t cell, CompactRows& compact, double& weight, double& pruned) {
    std::vector<const ViewpointEdges*> views;
    for (const std::uint32_t sample : partition_.samples_of(cell)) {
      for (std::size_t d = 0; d < views_per_sample_; ++d) views.push_back(&views_[view_index(sample, d)]);
    }
    const float scale = 1.0F / static_cast<float>(views.size());
    RowAccumulator& accumulator = accumulators_.local();
    const std::size_t triangle_count = scene_.mesh.triangles.size();
    EdgeRows rows;
    rows.offsets.reserve(2 * triangle_count + 1);
    rows.offsets.push_back(0);
    for (std::uint32_t t = 0; t < triangle_count; ++t) {
      for (std::uint8_t facing = 0; facing < 2; ++facing) {
        for (const ViewpointEdges* view : views) {
          if (view->front_flipped[t] != facing) continue;
          const std::uint32_t first = view->offsets[t];
          const std::uint32_t count = view->offsets[t + 1] - first;
          accumulator.add({view->backs.data() + first, count}, {view->areas.data() + first, count}, scale);
        }
        pruned += accumulator.flush(rows, region_ ? 0.0F : options_.least_weight);
      }
    }
    if (region_) {
      stop_if_requested(options_.progress);
      rows = region_->complete(cell, rows);
      advance_stage(options_.progress, kViewsPerRegion);
    }
    compact = CompactRows(rows);
    weight = pruned + std::accumulate(rows.weights.begin(), rows.weights.end(), 0.0);
  }

  void keep_within_memory(CompactRows& cell) {
    if (options_.memory == 0) return;
    const std::uint64_t bytes = cell.memory_bytes();
    if (memory_taken_.fetch_add(bytes) + bytes <= options_.memory) return;
    std::call_once(spill_once_, [&] { spill_file_ = std::make_shared<SpillFile>(); });
    cell.move_to(spill_file_);
    memory_taken_.fetch_sub(bytes - cell.memory_bytes());
  }

  void release_views(std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t cell = begin; cell < end; ++cell) {
      for (const std::uint32_t sample : partition_.samples_of(cell)) {
        if (--uses_left_[sample] > 0) continue;
        for (std::size_t d = 0; d < views_per_sample_; ++d) views_[view_index(sample, d)] = {};
      }
    }
  }

  OcclusionScene scene_;
  const ViewPartition& partition_;
  const GraphOptions& options_;
  std::optional<RegionEdges> region_;  // T[n], R[n]
  std::size_t views_per_sample_;
  std::vector<ViewpointEdges>
      views_;  // by sample and distance; empty before its first use and after its last
  std::vector<std::uint8_t> counted_;  // by sample and distance: in the counts of a batch
  std::vector<std::uint32_t> uses_left_;
  PerThread<OcclusionScratch> scratch_;
  PerThread<RowAccumulator> accumulators_;
  std::atomic<std::uint64_t> memory_taken_ = 0;  // by finished cells, bytes
  std::once_flag spill_once_;
  std::shared_ptr<SpillFile> spill_file_;  // null if everything fits into memory
};

}  // namespace

double RowAccumulator::flush(EdgeRows& rows, float least) {
  double left_out = 0;
  for (std::uint32_t group = 0; group < marked_words_.size(); ++group) {
    for (std::uint64_t words = marked_words_[group]; words != 0; words &= words - 1) {
      const std::uint32_t word = 64 * group + static_cast<std::uint32_t>(std::countr_zero(words));
      for (std::uint64_t bits = marks_[word]; bits != 0; bits &= bits - 1) {
        const NodeId back = 64 * word + static_cast<NodeId>(std::countr_zero(bits));
        const float weight = sums_[back];
        sums_[back] = 0.0F;
        if (weight < least) {
          left_out += static_cast<double>(weight);
          continue;
        }
        rows.backs.push_back(back);
        rows.weights.push_back(weight);
      }
      marks_[word] = 0;
    }
    marked_words_[group] = 0;
  }
  rows.offsets.push_back(static_cast<std::uint32_t>(rows.backs.size()));
  return left_out;
}

OcclusionGraph build_occlusion_graph(const Mesh& mesh, const BoundingSphere& sphere,
                                     const ViewPartition& partition, const GraphOptions& options) {
  return GraphBuilder(mesh, sphere, partition, options).build();
}

EdgeRows sum_cells(const OcclusionGraph& graph, std::span<const std::uint32_t> cells, float least) {
  // Sum blocks of rows in parallel, then append them in order.
  constexpr std::uint32_t kRowsPerBlock = 1024;
  const std::uint32_t blocks = (graph.node_count + kRowsPerBlock - 1) / kRowsPerBlock;
  std::vector<EdgeRows> parts(blocks);
  PerThread<RowAccumulator> accumulators([&] { return RowAccumulator(graph.node_count); });
  parallel_loop(std::uint32_t{0}, blocks, [&](std::uint32_t block) {
    RowAccumulator& accumulator = accumulators.local();
    const NodeId begin = block * kRowsPerBlock;
    const NodeId end = std::min(begin + kRowsPerBlock, graph.node_count);
    std::vector<RowBlock> parts_of_cells;
    parts_of_cells.reserve(cells.size());
    for (const std::uint32_t cell : cells) parts_of_cells.push_back(graph.cells[cell].block(begin, end));
    for (NodeId node = begin; node < end; ++node) {
      for (const RowBlock& rows : parts_of_cells) {
        rows.for_each(node, [&](NodeId back, float weight) { accumulator.add(back, weight); });
      }
      accumulator.flush(parts[block], least);
    }
  });
  EdgeRows sum;
  sum.offsets.reserve(graph.node_count + 1);
  sum.offsets.push_back(0);
  std::uint64_t edges = 0;
  for (const EdgeRows& part : parts) edges += part.edge_count();
  sum.backs.reserve(edges);
  sum.weights.reserve(edges);
  for (EdgeRows& part : parts) {
    const auto base = static_cast<std::uint32_t>(sum.backs.size());
    for (const std::uint32_t offset : part.offsets) sum.offsets.push_back(base + offset);
    sum.backs.insert(sum.backs.end(), part.backs.begin(), part.backs.end());
    sum.weights.insert(sum.weights.end(), part.weights.begin(), part.weights.end());
    part = {};
  }
  return sum;
}

}  // namespace pellucid
