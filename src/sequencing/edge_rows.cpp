// Implements the compact form of edges, and the cycles of graphs in rows.
#include "sequencing/edge_rows.h"

#include <algorithm>
#include <limits>

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
      // Round to the nearest. Areas are far from the largest and the smallest floats.
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
  words_ = std::vector<std::uint32_t>();  // assigning {} would not free the memory
}

// ---------------------------------------------------------------------------------------------------- cycles

bool has_cycle(std::span<const std::uint32_t> offsets, std::span<const std::uint32_t> targets) {
  if (offsets.empty()) return false;
  const std::size_t count = offsets.size() - 1;
  std::vector<std::uint32_t> waiting_for(count, 0);
  for (const std::uint32_t target : targets) ++waiting_for[target];
  std::vector<std::uint32_t> free;
  for (std::uint32_t node = 0; node < count; ++node) {
    if (waiting_for[node] == 0) free.push_back(node);
  }
  std::size_t freed = 0;
  while (!free.empty()) {
    const std::uint32_t node = free.back();
    free.pop_back();
    ++freed;
    for (std::uint32_t i = offsets[node]; i < offsets[node + 1]; ++i) {
      if (--waiting_for[targets[i]] == 0) free.push_back(targets[i]);
    }
  }
  return freed < count;
}

std::vector<std::uint32_t> strong_components(std::span<const std::uint32_t> offsets,
                                             std::span<const std::uint32_t> targets) {
  constexpr std::uint32_t kNew = std::numeric_limits<std::uint32_t>::max();
  const std::size_t count = offsets.empty() ? 0 : offsets.size() - 1;
  std::vector<std::uint32_t> component(count, kNew);
  std::vector<std::uint32_t> index(count, kNew);
  std::vector<std::uint32_t> low(count, 0);
  std::vector<std::uint32_t> open;  // visited, component not known yet
  struct Visit {
    std::uint32_t node, next_edge;
  };
  std::vector<Visit> path;
  std::uint32_t visited = 0;
  std::uint32_t components = 0;
  for (std::uint32_t root = 0; root < count; ++root) {
    if (index[root] != kNew) continue;
    path.push_back({root, offsets[root]});
    while (!path.empty()) {
      const std::uint32_t node = path.back().node;
      if (index[node] == kNew) {
        index[node] = low[node] = visited++;
        open.push_back(node);
      }
      std::uint32_t& edge = path.back().next_edge;
      if (edge < offsets[node + 1]) {
        const std::uint32_t target = targets[edge++];
        if (index[target] == kNew) {
          path.push_back({target, offsets[target]});
        } else if (component[target] == kNew) {
          low[node] = std::min(low[node], index[target]);
        }
        continue;
      }
      path.pop_back();
      if (!path.empty()) low[path.back().node] = std::min(low[path.back().node], low[node]);
      if (low[node] != index[node]) continue;
      while (component[node] == kNew) {
        component[open.back()] = components;
        open.pop_back();
      }
      ++components;
    }
  }
  return component;
}

}  // namespace pellucid
