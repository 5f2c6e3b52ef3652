// Unweighted edge sets of view cells and clusters of them: see edge_set.h.
#include "edge_set.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

namespace pellucid {
namespace {

std::uint32_t node_count_of(const EdgeTable& table) {
  return static_cast<std::uint32_t>(table.row_ids.size() - 1);
}

// Call visit(back) for every edge of a node.
template <class Visit>
void for_each_back(const EdgeTable& table, const EdgeSet& edges, NodeId front, const Visit& visit) {
  for (std::uint32_t i = edges.rows[front]; i < edges.rows[front + 1]; ++i) visit(table.backs[edges.ids[i]]);
}

// Kahn's algorithm over the nodes sequence[begin .. end) and those edges of two sets that stay inside.
// `position` is the inverse of `sequence`. On success the window of the sequence is replaced by a topological
// order.
bool sort_window(const EdgeTable& table, const EdgeSet& a, const EdgeSet* b, std::uint32_t begin,
                 std::uint32_t end, const std::vector<std::uint32_t>& position,
                 std::vector<NodeId>& sequence) {
  const auto inside = [&](NodeId node) { return position[node] >= begin && position[node] < end; };
  std::vector<std::uint32_t> predecessors(end - begin, 0);
  const auto for_each_edge_of = [&](NodeId front, const auto& visit) {
    const auto visit_inside = [&](NodeId back) {
      if (inside(back)) visit(back);
    };
    for_each_back(table, a, front, visit_inside);
    if (b != nullptr) for_each_back(table, *b, front, visit_inside);
  };
  for (std::uint32_t i = begin; i < end; ++i) {
    for_each_edge_of(sequence[i], [&](NodeId back) { ++predecessors[position[back] - begin]; });
  }
  std::vector<NodeId> sorted;
  sorted.reserve(end - begin);
  for (std::uint32_t i = begin; i < end; ++i) {
    if (predecessors[i - begin] == 0) sorted.push_back(sequence[i]);
  }
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    for_each_edge_of(sorted[i], [&](NodeId back) {
      if (--predecessors[position[back] - begin] == 0) sorted.push_back(back);
    });
  }
  if (sorted.size() != end - begin) return false;
  std::copy(sorted.begin(), sorted.end(), sequence.begin() + begin);
  return true;
}

std::vector<NodeId> inverse(const std::vector<std::uint32_t>& ranks) {
  std::vector<NodeId> sequence(ranks.size());
  for (NodeId node = 0; node < ranks.size(); ++node) sequence[ranks[node]] = node;
  return sequence;
}

}  // namespace

EdgeTable make_edge_table(const OcclusionGraph& graph) {
  std::vector<std::vector<NodeId>> rows(graph.node_count);
  tbb::parallel_for(std::uint32_t{0}, graph.node_count, [&](NodeId front) {
    std::vector<NodeId>& row = rows[front];
    for (const EdgeRows& cell : graph.cells) {
      row.insert(row.end(), cell.backs.begin() + cell.offsets[front],
                 cell.backs.begin() + cell.offsets[front + 1]);
    }
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    row.shrink_to_fit();
  });
  EdgeTable table;
  table.row_ids.reserve(graph.node_count + 1);
  table.row_ids.push_back(0);
  for (const std::vector<NodeId>& row : rows) {
    table.row_ids.push_back(table.row_ids.back() + static_cast<std::uint32_t>(row.size()));
  }
  table.backs.reserve(table.row_ids.back());
  for (const std::vector<NodeId>& row : rows) table.backs.insert(table.backs.end(), row.begin(), row.end());
  table.reverse.resize(table.backs.size());
  tbb::parallel_for(std::uint32_t{0}, graph.node_count, [&](NodeId front) {
    for (std::uint32_t id = table.row_ids[front]; id < table.row_ids[front + 1]; ++id) {
      const auto begin = table.backs.begin() + table.row_ids[table.backs[id]];
      const auto end = table.backs.begin() + table.row_ids[table.backs[id] + 1];
      const auto found = std::lower_bound(begin, end, front);
      table.reverse[id] =
          found != end && *found == front ? static_cast<std::uint32_t>(found - table.backs.begin()) : kNoEdge;
    }
  });
  return table;
}

EdgeSet edges_of_cell(const EdgeTable& table, const EdgeRows& cell) {
  EdgeSet set;
  set.rows = cell.offsets;
  set.ids.reserve(cell.backs.size());
  for (NodeId front = 0; front < cell.node_count(); ++front) {
    // Both rows are sorted by back node.
    std::uint32_t id = table.row_ids[front];
    for (std::uint32_t i = cell.offsets[front]; i < cell.offsets[front + 1]; ++i) {
      while (table.backs[id] != cell.backs[i]) ++id;
      set.ids.push_back(id);
    }
  }
  return set;
}

EdgeSet unite(const EdgeSet& a, const EdgeSet& b) {
  EdgeSet set;
  set.ids.reserve(std::max(a.ids.size(), b.ids.size()));
  set.rows.reserve(a.rows.size());
  set.rows.push_back(0);
  for (std::size_t node = 0; node + 1 < a.rows.size(); ++node) {
    std::set_union(a.ids.begin() + a.rows[node], a.ids.begin() + a.rows[node + 1],
                   b.ids.begin() + b.rows[node], b.ids.begin() + b.rows[node + 1],
                   std::back_inserter(set.ids));
    set.rows.push_back(static_cast<std::uint32_t>(set.ids.size()));
  }
  return set;
}

EdgeSet unite_all(const EdgeTable& table, std::span<const EdgeSet* const> sets) {
  std::vector<std::uint64_t> marks((table.backs.size() + 63) / 64, 0);
  for (const EdgeSet* set : sets) {
    for (const std::uint32_t id : set->ids) marks[id / 64] |= std::uint64_t{1} << (id % 64);
  }
  EdgeSet all;
  all.rows.reserve(table.row_ids.size());
  all.rows.push_back(0);
  for (NodeId node = 0; node < node_count_of(table); ++node) {
    for (std::uint32_t id = table.row_ids[node]; id < table.row_ids[node + 1]; ++id) {
      if ((marks[id / 64] >> (id % 64) & 1U) != 0) all.ids.push_back(id);
    }
    all.rows.push_back(static_cast<std::uint32_t>(all.ids.size()));
  }
  return all;
}

std::uint64_t intersection_size(const EdgeSet& a, const EdgeSet& b) {
  std::uint64_t count = 0;
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.ids.size() && j < b.ids.size()) {
    const std::uint32_t x = a.ids[i];
    const std::uint32_t y = b.ids[j];
    count += x == y ? 1U : 0U;
    i += x <= y ? 1U : 0U;
    j += y <= x ? 1U : 0U;
  }
  return count;
}

bool topological_ranks(const EdgeTable& table, const EdgeSet& edges, std::vector<std::uint32_t>& ranks) {
  std::vector<std::uint32_t> position(node_count_of(table));
  std::iota(position.begin(), position.end(), 0U);
  std::vector<NodeId> sequence = position;
  if (!sort_window(table, edges, nullptr, 0, node_count_of(table), position, sequence)) return false;
  ranks = inverse(sequence);
  return true;
}

bool extend_ranks(const EdgeTable& table, const EdgeSet& base, const EdgeSet& added,
                  std::vector<std::uint32_t>& ranks) {
  // The window from the least rank that must move back to the greatest that must move forward.
  std::uint32_t begin = node_count_of(table);
  std::uint32_t end = 0;
  for (NodeId front = 0; front < node_count_of(table); ++front) {
    const std::uint32_t rank = ranks[front];
    for (std::uint32_t i = added.rows[front]; i < added.rows[front + 1]; ++i) {
      const std::uint32_t id = added.ids[i];
      const NodeId back = table.backs[id];
      if (ranks[back] > rank) continue;
      // Most conflicts are as short as can be: the reverse edge.
      if (table.reverse[id] != kNoEdge &&
          std::binary_search(base.ids.begin() + base.rows[back], base.ids.begin() + base.rows[back + 1],
                             table.reverse[id])) {
        return false;
      }
      begin = std::min(begin, ranks[back]);
      end = std::max(end, rank + 1);
    }
  }
  if (begin >= end) return true;
  std::vector<NodeId> sequence = inverse(ranks);
  if (!sort_window(table, base, &added, begin, end, ranks, sequence)) return false;
  for (std::uint32_t i = begin; i < end; ++i) ranks[sequence[i]] = i;
  return true;
}

}  // namespace pellucid
