// Weighted edges between nodes, in rows by front node: in a plain form for computations and in a compact form
// for storage, which can be in a file. Also finds the cycles of a graph in rows.
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
// image in which the front node covers the back node, in square bounding radii, averaged over the viewpoints
// of the graph. It is multiplied by the light transmittance in front of it if the graph was made for a given
// opacity.
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

// Some rows of CompactRows in memory.
class RowBlock {
 public:
  RowBlock(RowBlock&&) = default;
  RowBlock& operator=(RowBlock&&) = default;

  // Calls visit(back, weight) for the edges of a row, sorted by back node.
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
  const std::uint32_t* offsets_ = nullptr;  // for the rows from begin_ on
  const std::uint32_t* words_ = nullptr;    // the words of the first row
  std::vector<std::uint32_t> read_;         // the words, if they were read from a file
};

// EdgeRows in half the memory, sorted by back node. Each edge is a word. Its upper half is the weight: the
// upper 16 bits of the float, rounded, with a relative error of at most 0.4 %. Its lower half is the distance
// from the previous back node of the row. Edges of weight zero bridge larger distances.
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
  // Returns the rows begin .. end - 1.
  [[nodiscard]] RowBlock block(NodeId begin, NodeId end) const;
  [[nodiscard]] RowBlock all() const { return block(0, node_count()); }
  // Returns the edges in the plain form.
  [[nodiscard]] EdgeRows expanded() const;

  // Moves the words to a file. Blocks read them from there afterwards.
  void move_to(const std::shared_ptr<SpillFile>& file);

 private:
  // Only while the words are in memory.
  template <class Archive, RecordOf<CompactRows> T>
  friend void fields(Archive& archive, T& rows) {
    archive(rows.offsets_, rows.words_, rows.edge_count_);
  }

  std::vector<std::uint32_t> offsets_;  // nodes + 1
  std::vector<std::uint32_t> words_;
  std::uint64_t edge_count_ = 0;
  std::shared_ptr<SpillFile> file_;  // null while the words are in memory
  std::uint64_t file_position_ = 0;  // words
};

// ---------------------------------------------------------------------------------------------------- cycles

// These functions take a directed graph in rows: the edges of node n lead to targets[offsets[n]] ..
// targets[offsets[n + 1] - 1]. They take O(nodes + edges).

// Returns whether the graph has a cycle.
bool has_cycle(std::span<const std::uint32_t> offsets, std::span<const std::uint32_t> targets);

// Returns the index of the strongly connected component of every node. The indices are a reverse topological
// order: edges between components lead to smaller indices. Based on: Tarjan, "Depth-first search and linear
// graph algorithms", SIAM J. Comput. 1972, without recursion.
std::vector<std::uint32_t> strong_components(std::span<const std::uint32_t> offsets,
                                             std::span<const std::uint32_t> targets);

}  // namespace pellucid
