// Rows of edges, kept compactly: see edge_rows.h.
#include "sequencing/edge_rows.h"

namespace pellucid {

CompactRows::CompactRows(const EdgeRows& rows) : edge_count_(rows.edge_count()) {
  constexpr std::uint32_t kMask = RowBlock::kDistanceMask;
  offsets_.reserve(rows.offsets.size());
  words_.reserve(rows.edge_count());
  offsets_.push_back(0);
  for (NodeId front = 0; front < rows.node_count(); ++front) {
    NodeId previous = 0;
    for (std::uint32_t i = rows.offsets[front]; i < rows.offsets[front + 1]; ++i) {
      NodeId distance = rows.backs[i] - previous;
      for (; distance > kMask; distance -= kMask) words_.push_back(kMask);
      // To the nearest: areas are far from the largest and the smallest floats.
      const std::uint32_t rounded = std::bit_cast<std::uint32_t>(rows.weights[i]) + (kMask + 1) / 2;
      words_.push_back((rounded & ~kMask) | distance);
      previous = rows.backs[i];
    }
    offsets_.push_back(static_cast<std::uint32_t>(words_.size()));
  }
  words_.shrink_to_fit();
}

RowBlock CompactRows::block(NodeId begin, NodeId end) const {
  RowBlock block;
  block.begin_ = begin;
  block.offsets_ = offsets_.data() + begin;
  if (file_ == nullptr) {
    block.words_ = words_.data() + offsets_[begin];
  } else {
    block.read_.resize(offsets_[end] - offsets_[begin]);
    file_->read(file_position_ + offsets_[begin], block.read_);
    block.words_ = block.read_.data();
  }
  return block;
}

EdgeRows CompactRows::expanded() const {
  EdgeRows rows;
  rows.offsets.reserve(offsets_.size());
  rows.backs.reserve(edge_count_);
  rows.weights.reserve(edge_count_);
  rows.offsets.push_back(0);
  const RowBlock block = all();
  for (NodeId front = 0; front < node_count(); ++front) {
    block.for_each(front, [&](NodeId back, float weight) {
      rows.backs.push_back(back);
      rows.weights.push_back(weight);
    });
    rows.offsets.push_back(static_cast<std::uint32_t>(rows.backs.size()));
  }
  return rows;
}

void CompactRows::move_to(const std::shared_ptr<SpillFile>& file) {
  file_position_ = file->append(words_);
  file_ = file;
  words_ = std::vector<std::uint32_t>();  // assigning {} would keep the memory
}

}  // namespace pellucid
