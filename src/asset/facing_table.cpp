// Index triples to nodes: see facing_table.h.
#include "asset/facing_table.h"

#include <algorithm>
#include <tuple>

namespace pellucid {
namespace {

// The lexicographically smallest of the three rotations: unique, also where corners repeat.
Triangle smallest_rotation(const Triangle& t) {
  return std::min({t, Triangle{t[1], t[2], t[0]}, Triangle{t[2], t[0], t[1]}});
}

}  // namespace

FacingTable::FacingTable(const Mesh& mesh, Facing facing) {
  const NodeId step = facing == Facing::single ? 2 : 1;
  const auto node_end = static_cast<NodeId>(2 * mesh.triangles.size());

  // Counting sort by first corner.
  offsets_.assign(mesh.positions.size() + 1, 0);
  for (NodeId node = 0; node < node_end; node += step)
    ++offsets_[smallest_rotation(corners_of(mesh, node))[0] + 1];
  for (std::size_t v = 1; v < offsets_.size(); ++v) offsets_[v] += offsets_[v - 1];
  entries_.resize(offsets_.back());
  std::vector<std::size_t> next(offsets_.begin(), offsets_.end() - 1);
  for (NodeId node = 0; node < node_end; node += step) {
    const Triangle corners = smallest_rotation(corners_of(mesh, node));
    entries_[next[corners[0]]++] = {corners[1], corners[2], node};
  }

  const auto key = [](const Entry& e) {
    return std::tuple(e.second, e.third, is_flipped(e.node), triangle_of(e.node));
  };
  for (std::size_t v = 0; v + 1 < offsets_.size(); ++v) {
    std::sort(entries_.begin() + static_cast<std::ptrdiff_t>(offsets_[v]),
              entries_.begin() + static_cast<std::ptrdiff_t>(offsets_[v + 1]),
              [&](const Entry& a, const Entry& b) { return key(a) < key(b); });
  }
  taken_.resize(entries_.size());
}

void FacingTable::start_order() {
  for (const std::size_t entry : touched_) taken_[entry] = 0;
  touched_.clear();
}

std::optional<NodeId> FacingTable::take(const Triangle& corners) {
  const Triangle wanted = smallest_rotation(corners);
  if (wanted[0] + std::size_t{1} >= offsets_.size()) return std::nullopt;
  const auto begin = entries_.begin() + static_cast<std::ptrdiff_t>(offsets_[wanted[0]]);
  const auto end = entries_.begin() + static_cast<std::ptrdiff_t>(offsets_[wanted[0] + 1]);
  const auto first = std::lower_bound(begin, end, wanted, [](const Entry& e, const Triangle& t) {
    return std::tuple(e.second, e.third) < std::tuple(t[1], t[2]);
  });
  if (first == end) return std::nullopt;
  std::uint32_t& taken = taken_[static_cast<std::size_t>(first - entries_.begin())];
  if (taken >= end - first) return std::nullopt;
  const Entry& next = *(first + taken);
  if (next.second != wanted[1] || next.third != wanted[2]) return std::nullopt;
  if (taken++ == 0) touched_.push_back(static_cast<std::size_t>(first - entries_.begin()));
  return next.node;
}

}  // namespace pellucid
