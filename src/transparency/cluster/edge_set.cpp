// Implements edge_set.h: unions, cycles and topological orders of sets of edges.
#include "transparency/cluster/edge_set.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "base/parallel.h"

namespace pellucid {
namespace {

std::uint32_t node_count_of(const EdgeTable& table) {
  return static_cast<std::uint32_t>(table.row_ids.size() - 1);
}

// A depth-first search over the union of two edge sets, among nodes of rank < end. It stops at the first
// cycle.
class CycleSearch {
 public:
  CycleSearch(const EdgeTable& table, const EdgeSet& a, const EdgeSet& b,
              const std::vector<std::uint32_t>& ranks, std::uint32_t end)
      : table_(table), a_(a), b_(b), ranks_(ranks), end_(end), state_(ranks.size(), State::unseen) {}

  // Visits all nodes that `root` reaches. Returns false if a cycle is found.
  bool visit(NodeId root) {
    if (state_[root] != State::unseen) return true;
    enter(root);
    while (!stack_.empty()) {
      Frame& frame = stack_.back();
      NodeId back = 0;
      if (frame.next_a < a_.rows[frame.node + 1]) {
        back = table_.backs[a_.ids[frame.next_a++]];
      } else if (frame.next_b < b_.rows[frame.node + 1]) {
        back = table_.backs[b_.ids[frame.next_b++]];
      } else {
        state_[frame.node] = State::done;
        finished_.push_back(frame.node);
        stack_.pop_back();
        continue;
      }
      if (ranks_[back] >= end_) continue;
      if (state_[back] == State::open) return false;
      if (state_[back] == State::unseen) enter(back);
    }
    return true;
  }

  [[nodiscard]] bool seen(NodeId node) const { return state_[node] == State::done; }
  // Returns the nodes in the order in which they were finished: every node after all nodes that it reaches.
  [[nodiscard]] const std::vector<NodeId>& finished() const { return finished_; }

 private:
  enum class State : std::uint8_t { unseen, open, done };
  struct Frame {
    NodeId node;
    std::uint32_t next_a, next_b;
  };
  void enter(NodeId node) {
    state_[node] = State::open;
    stack_.push_back({node, a_.rows[node], b_.rows[node]});
  }

  const EdgeTable& table_;
  const EdgeSet& a_;
  const EdgeSet& b_;
  const std::vector<std::uint32_t>& ranks_;
  std::uint32_t end_;
  std::vector<State> state_;
  std::vector<Frame> stack_;
  std::vector<NodeId> finished_;
};

std::vector<NodeId> inverse(const std::vector<std::uint32_t>& ranks) {
  std::vector<NodeId> sequence(ranks.size());
  for (NodeId node = 0; node < ranks.size(); ++node) sequence[ranks[node]] = node;
  return sequence;
}

}  // namespace

EdgeTable make_edge_table(const OcclusionGraph& graph) {
  constexpr std::uint32_t kRowsPerBlock = 1024;
  std::vector<std::vector<NodeId>> rows(graph.node_count);
  const std::uint32_t blocks = (graph.node_count + kRowsPerBlock - 1) / kRowsPerBlock;
  parallel_loop(std::uint32_t{0}, blocks, [&](std::uint32_t block) {
    const NodeId begin = block * kRowsPerBlock;
    const NodeId end = std::min(begin + kRowsPerBlock, graph.node_count);
    std::vector<RowBlock> cells;
    cells.reserve(graph.cells.size());
    for (const CompactRows& cell : graph.cells) cells.push_back(cell.block(begin, end));
    for (NodeId front = begin; front < end; ++front) {
      std::vector<NodeId>& row = rows[front];
      for (const RowBlock& cell : cells) {
        cell.for_each(front, [&](NodeId back, float) { row.push_back(back); });
      }
      std::sort(row.begin(), row.end());
      row.erase(std::unique(row.begin(), row.end()), row.end());
      row.shrink_to_fit();
    }
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
  parallel_loop(std::uint32_t{0}, graph.node_count, [&](NodeId front) {
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

EdgeSet edges_of_cell(const EdgeTable& table, const CompactRows& cell) {
  EdgeSet set;
  set.rows.reserve(cell.node_count() + 1);
  set.rows.push_back(0);
  set.ids.reserve(cell.edge_count());
  const RowBlock block = cell.all();
  for (NodeId front = 0; front < cell.node_count(); ++front) {
    // Both rows are sorted by back node.
    std::uint32_t id = table.row_ids[front];
    block.for_each(front, [&](NodeId back, float) {
      while (table.backs[id] != back) ++id;
      set.ids.push_back(id);
    });
    set.rows.push_back(static_cast<std::uint32_t>(set.ids.size()));
  }
  return set;
}

EdgeSet without_shortcuts(const EdgeTable& table, const EdgeSet& edges) {
  EdgeSet kept;
  kept.rows.reserve(edges.rows.size());
  kept.rows.push_back(0);
  kept.ids.reserve(edges.ids.size() / 2);
  constexpr NodeId kNobody = 0xFFFFFFFFU;
  std::vector<NodeId> reached_from(edges.rows.size(),
                                   kNobody);  // the node that reaches this one in two steps
  for (NodeId front = 0; front < node_count_of(table); ++front) {
    for (std::uint32_t i = edges.rows[front]; i < edges.rows[front + 1]; ++i) {
      const NodeId middle = table.backs[edges.ids[i]];
      for (std::uint32_t j = edges.rows[middle]; j < edges.rows[middle + 1]; ++j) {
        reached_from[table.backs[edges.ids[j]]] = front;
      }
    }
    for (std::uint32_t i = edges.rows[front]; i < edges.rows[front + 1]; ++i) {
      if (reached_from[table.backs[edges.ids[i]]] != front) kept.ids.push_back(edges.ids[i]);
    }
    kept.rows.push_back(static_cast<std::uint32_t>(kept.ids.size()));
  }
  return kept;
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
  for (std::size_t word = 0; word < marks.size(); ++word) {
    for (std::uint64_t bits = marks[word]; bits != 0; bits &= bits - 1) {
      all.ids.push_back(static_cast<std::uint32_t>(64 * word) +
                        static_cast<std::uint32_t>(std::countr_zero(bits)));
    }
  }
  all.rows.reserve(table.row_ids.size());
  std::size_t i = 0;
  for (const std::uint32_t first : table.row_ids) {
    while (i < all.ids.size() && all.ids[i] < first) ++i;
    all.rows.push_back(static_cast<std::uint32_t>(i));
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
  const std::uint32_t nodes = node_count_of(table);
  const EdgeSet none{std::vector<std::uint32_t>(nodes + 1, 0), {}};
  const std::vector<std::uint32_t> unranked(nodes, 0);
  CycleSearch search(table, edges, none, unranked, nodes);
  for (NodeId node = nodes; node-- > 0;) {
    if (!search.visit(node)) return false;
  }
  ranks.resize(nodes);
  for (std::uint32_t i = 0; i < nodes; ++i) ranks[search.finished()[i]] = nodes - 1 - i;
  return true;
}

bool extend_ranks(const EdgeTable& table, const EdgeSet& base, const EdgeSet& added,
                  std::vector<std::uint32_t>& ranks) {
  // Find the window from the least rank that must move back to the greatest that must move forward. A cycle
  // contains an edge that disagrees, and stays inside the window.
  std::vector<NodeId> heads;
  std::uint32_t begin = node_count_of(table);
  std::uint32_t end = 0;
  for (NodeId front = 0; front < node_count_of(table); ++front) {
    const std::uint32_t rank = ranks[front];
    for (std::uint32_t i = added.rows[front]; i < added.rows[front + 1]; ++i) {
      const std::uint32_t id = added.ids[i];
      const NodeId back = table.backs[id];
      if (ranks[back] > rank) continue;
      // Most conflicts are cycles of two: the reverse edge.
      if (table.reverse[id] != kNoEdge &&
          std::binary_search(base.ids.begin() + base.rows[back], base.ids.begin() + base.rows[back + 1],
                             table.reverse[id])) {
        return false;
      }
      heads.push_back(back);
      begin = std::min(begin, ranks[back]);
      end = std::max(end, rank + 1);
    }
  }
  if (heads.empty()) return true;

  CycleSearch search(table, base, added, ranks, end);
  for (const NodeId head : heads) {
    if (!search.visit(head)) return false;
  }
  // The nodes that the heads of disagreeing edges reach go behind the rest of the window. Both parts keep
  // their order.
  const std::vector<NodeId> sequence = inverse(ranks);
  std::uint32_t rank = begin;
  for (std::uint32_t i = begin; i < end; ++i) {
    if (!search.seen(sequence[i])) ranks[sequence[i]] = rank++;
  }
  const std::vector<NodeId>& finished = search.finished();
  for (auto node = finished.rbegin(); node != finished.rend(); ++node) ranks[*node] = rank++;
  return true;
}

}  // namespace pellucid
