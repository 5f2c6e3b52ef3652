// Weighted edges between nodes, in rows by front node: as they are worked on, and as they are kept.
#pragma once

#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/record.h"
#include "base/spill_file.h"
#include "pellucid/sequencing.h"

namespace pellucid {

// Weighted edges front -> back between nodes, in rows by front node. The weight of an edge is the area of the
// picture (square bounding radii) in which front covers back, averaged over the viewpoints that the graph
// stands for; with GraphOptions::alpha, times the light that reaches the front.
struct EdgeRows {
  std::vector<std::uint32_t> offsets;  // nodes + 1
  std::vector<NodeId> backs;
  std::vector<float> weights;

  [[nodiscard]] std::uint32_t node_count() const {
    return static_cast<std::uint32_t>(offsets.empty() ? 0 : offsets.size() - 1);
  }
  [[nodiscard]] std::uint64_t edge_count() const { return backs.size(); }
};

template <class Archive, RecordOf<EdgeRows> T>
void fields(Archive& archive, T& rows) {
  archive(rows.offsets, rows.backs, rows.weights);
}

// Some rows of CompactRows, in memory while this lives.
class RowBlock {
 public:
  RowBlock(RowBlock&&) = default;
  RowBlock& operator=(RowBlock&&) = default;

  // visit(back, weight) for the edges of a row, sorted by back node.
  template <typename Visit>
  void for_each(NodeId front, Visit visit) const {
    NodeId back = 0;
    const std::uint32_t end = offsets_[front - begin_ + 1] - offsets_[0];
    for (std::uint32_t i = offsets_[front - begin_] - offsets_[0]; i < end; ++i) {
      const std::uint32_t word = words_[i];
      back += word & kDistanceMask;
      const auto weight = std::bit_cast<float>(word & ~kDistanceMask);
      if (weight > 0) visit(back, weight);
    }
  }

  static constexpr std::uint32_t kDistanceMask = 0xFFFF;

 private:
  friend class CompactRows;
  RowBlock() = default;

  NodeId begin_ = 0;
  const std::uint32_t* offsets_ = nullptr;  // of the rows from begin_ on
  const std::uint32_t* words_ = nullptr;    // of the first row
  std::vector<std::uint32_t> read_;         // what words_ points to, where it came from a file
};

// EdgeRows sorted by back node, in half the memory: a word an edge, of which the upper half is the weight
// (the upper 16 bits of the float, rounded: an error of 0.4 % at most) and the lower half the distance to the
// row's last back node. An edge that is farther away comes after some of weight zero, which bridge the
// distance.
class CompactRows {
 public:
  CompactRows() = default;
  explicit CompactRows(const EdgeRows& rows);

  [[nodiscard]] std::uint32_t node_count() const {
    return static_cast<std::uint32_t>(offsets_.empty() ? 0 : offsets_.size() - 1);
  }
  [[nodiscard]] std::uint64_t edge_count() const { return edge_count_; }
  [[nodiscard]] std::uint64_t memory_bytes() const {
    return (offsets_.capacity() + words_.capacity()) * sizeof(std::uint32_t);
  }
  // The rows begin .. end - 1.
  [[nodiscard]] RowBlock block(NodeId begin, NodeId end) const;
  [[nodiscard]] RowBlock all() const { return block(0, node_count()); }
  [[nodiscard]] EdgeRows expanded() const;

  // Keep the words in a file from now on; blocks read them from there.
  void move_to(const std::shared_ptr<SpillFile>& file);

 private:
  // While the words are in memory.
  template <class Archive, RecordOf<CompactRows> T>
  friend void fields(Archive& archive, T& rows) {
    archive(rows.offsets_, rows.words_, rows.edge_count_);
  }

  std::vector<std::uint32_t> offsets_;  // nodes + 1
  std::vector<std::uint32_t> words_;
  std::uint64_t edge_count_ = 0;
  std::shared_ptr<SpillFile> file_;  // null: words_ holds them
  std::uint64_t file_position_ = 0;  // words
};

}  // namespace pellucid
