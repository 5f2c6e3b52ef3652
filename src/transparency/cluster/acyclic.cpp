// Implements the acyclic clustering of clustering.h: merges clusters of view cells as long as the union of
// their edges has no cycle, and then relaxes them.
//
// Based on: Han, Chen, Nehab, Sander, "In-Depth Buffers", PACMCGIT 1(1), 2018, section 3.2. Differs in: edges
// that two other edges of a cell imply are left out of its set. These are about half of the edges; the orders
// are the same, and priorities count the remaining edges. Pairs that were found infeasible are not tried
// again while both clusters only grow.
#include <algorithm>
#include <map>
#include <queue>
#include <set>

#include "base/parallel.h"
#include "sequencing/linear_order.h"
#include "transparency/cluster/clustering.h"
#include "transparency/cluster/edge_set.h"

namespace pellucid {
namespace {

// The state of the search between two rounds of relaxation. Edges are left out because they are the union of
// those of the cells.
struct SearchState {
  std::vector<std::uint32_t> numbers;  // of the live clusters
  std::vector<std::vector<std::uint32_t>> cells, ranks;
  std::map<std::uint32_t, std::uint32_t> losses;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> refused;
  std::uint64_t random = 0;
  std::uint32_t fruitless = 0, rounds = 0, clusters_before = 0;
};
template <class Archive, RecordOf<SearchState> T>
void fields(Archive& archive, T& state) {
  archive(state.numbers, state.cells, state.ranks, state.losses, state.refused, state.random, state.fruitless,
          state.rounds, state.clusters_before);
}

struct Cluster {
  std::vector<std::uint32_t> cells;  // sorted; empty if the cluster was merged into another one
  EdgeSet edges;
  std::vector<std::uint32_t> ranks;  // topological
};

class AcyclicClustering {
 public:
  AcyclicClustering(const OrderProblem& problem, const OrderOptions& options, OrderStatistics& statistics,
                    const RunRecords& records)
      : partition_(problem.partition),
        graph_(problem.graph),
        options_(options),
        statistics_(statistics),
        records_(records),
        random_(options.seed),
        table_(make_edge_table(problem.graph)),
        cell_edges_(problem.graph.cells.size()),
        cluster_of_(problem.graph.cells.size()) {}

  Clustering run() {
    make_cells();
    if (const auto state = recorded<SearchState>(records_, "clusters")) {
      restore(*state);
    } else {
      merge_greedily();
      statistics_.clusters_before_relaxation = static_cast<std::uint32_t>(live_clusters().size());
      record_state();
    }
    relax();
    statistics_.clusters_lower_bound =
        static_cast<std::uint32_t>(contradicting_cells(table_, cell_edges_).size());
    return result();
  }

 private:
  // ------------------------------------------------------------------------------------------------ cells

  void make_cells() {
    const std::size_t count = graph_.cells.size();
    clusters_.resize(count);
    std::vector<std::uint64_t> dropped(count, 0);
    std::vector<double> dropped_weight(count, 0.0);
    begin_stage(options_.progress, "cells", count);
    parallel_loop(std::size_t{0}, count, [&](std::size_t cell) {
      stop_if_requested(options_.progress);
      cell_edges_[cell] = edges_of_cell(table_, graph_.cells[cell]);
      Cluster& cluster = clusters_[cell];
      if (!topological_ranks(table_, cell_edges_[cell], cluster.ranks)) {
        break_cycles(graph_.cells[cell].expanded(), cell_edges_[cell], dropped[cell], dropped_weight[cell]);
        topological_ranks(table_, cell_edges_[cell], cluster.ranks);
      }
      cell_edges_[cell] = without_shortcuts(table_, cell_edges_[cell]);
      cluster.cells = {static_cast<std::uint32_t>(cell)};
      cluster.edges = cell_edges_[cell];
      cluster_of_[cell] = static_cast<std::uint32_t>(cell);
      advance_stage(options_.progress, 1);
    });
    for (std::size_t cell = 0; cell < count; ++cell) {
      statistics_.cyclic_cells += dropped[cell] > 0 ? 1U : 0U;
      statistics_.dropped_edges += dropped[cell];
      if (graph_.total_weight > 0) statistics_.dropped_weight += dropped_weight[cell] / graph_.total_weight;
    }
  }

  // Removes the edges that a good order violates. This removes all cycles with little weight.
  static void break_cycles(const EdgeRows& cell, EdgeSet& edges, std::uint64_t& dropped,
                           double& dropped_weight) {
    std::vector<double> keys(cell.node_count(), 0.0);
    for (NodeId front = 0; front < cell.node_count(); ++front) {
      for (std::uint32_t i = cell.offsets[front]; i < cell.offsets[front + 1]; ++i) {
        keys[front] -= static_cast<double>(cell.weights[i]);
        keys[cell.backs[i]] += static_cast<double>(cell.weights[i]);
      }
    }
    std::vector<std::uint32_t> ranks = ranks_by_key(keys);
    SiftOptions options;
    options.sweeps = 30;
    options.least_gain = 0;
    sift(net_preferences(cell), options, ranks);
    EdgeSet kept;
    kept.rows.push_back(0);
    for (NodeId front = 0; front < cell.node_count(); ++front) {
      for (std::uint32_t i = cell.offsets[front]; i < cell.offsets[front + 1]; ++i) {
        if (ranks[front] < ranks[cell.backs[i]]) {
          kept.ids.push_back(edges.ids[i]);
        } else {
          ++dropped;
          dropped_weight += static_cast<double>(cell.weights[i]);
        }
      }
      kept.rows.push_back(static_cast<std::uint32_t>(kept.ids.size()));
    }
    edges = std::move(kept);
  }

  // ---------------------------------------------------------------------------------------------- merging

  // Returns the priority of a merge. Smaller is better.
  [[nodiscard]] double priority(const EdgeSet& i, const EdgeSet& j) const {
    const auto common = static_cast<double>(intersection_size(i, j));
    const double together = static_cast<double>(i.size()) + static_cast<double>(j.size()) - common;
    switch (options_.priority) {
      case MergePriority::intersection:
        return -common;
      case MergePriority::difference:
        return together - common;
      case MergePriority::union_size:
        break;
    }
    return together;
  }

  struct Candidate {
    double priority;
    std::uint32_t a, b;  // a < b
    bool operator>(const Candidate& other) const {
      if (priority != other.priority) return priority > other.priority;
      return a != other.a ? a > other.a : b > other.b;
    }
  };

  static std::pair<std::uint32_t, std::uint32_t> ordered(std::uint32_t a, std::uint32_t b) {
    return {std::min(a, b), std::max(a, b)};
  }

  void push_candidates(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) {
    std::vector<double> priorities(pairs.size());
    parallel_loop(std::size_t{0}, pairs.size(), [&](std::size_t i) {
      priorities[i] = priority(clusters_[pairs[i].first].edges, clusters_[pairs[i].second].edges);
    });
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      candidates_.push({priorities[i], pairs[i].first, pairs[i].second});
    }
  }

  void merge_greedily() {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (std::uint32_t cell = 0; cell < partition_.cell_count(); ++cell) {
      for (const std::uint32_t neighbor : partition_.neighbors_of(cell)) {
        if (cell < neighbor) pairs.emplace_back(cell, neighbor);
      }
    }
    push_candidates(pairs);
    begin_stage(options_.progress, "merging", clusters_.size());
    while (!candidates_.empty()) {
      stop_if_requested(options_.progress);
      const Candidate best = candidates_.top();
      candidates_.pop();
      // Merged clusters get a new number: entries of the old ones are stale.
      if (clusters_[best.a].cells.empty() || clusters_[best.b].cells.empty()) continue;
      if (!try_merge(best.a, best.b)) dead_.insert({best.a, best.b});
    }
  }

  bool try_merge(std::uint32_t a, std::uint32_t b) {
    const bool a_larger = clusters_[a].edges.size() >= clusters_[b].edges.size();
    const Cluster& large = clusters_[a_larger ? a : b];
    const Cluster& small = clusters_[a_larger ? b : a];
    std::vector<std::uint32_t> ranks = large.ranks;
    if (!extend_ranks(table_, large.edges, small.edges, ranks)) return false;

    Cluster merged;
    std::merge(large.cells.begin(), large.cells.end(), small.cells.begin(), small.cells.end(),
               std::back_inserter(merged.cells));
    merged.edges = unite(large.edges, small.edges);
    merged.ranks = std::move(ranks);
    const auto number = static_cast<std::uint32_t>(clusters_.size());
    for (const std::uint32_t cell : merged.cells) cluster_of_[cell] = number;
    clusters_[a] = {};
    clusters_[b] = {};
    clusters_.push_back(std::move(merged));

    // A cluster that could not be merged with a part cannot be merged with the whole.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const std::uint32_t neighbor : neighbors_of_cluster(number)) {
      if (dead_.contains(ordered(a, neighbor)) || dead_.contains(ordered(b, neighbor))) {
        dead_.insert(ordered(number, neighbor));
      } else {
        pairs.push_back(ordered(number, neighbor));
      }
    }
    push_candidates(pairs);
    advance_stage(options_.progress, 1);
    return true;
  }

  [[nodiscard]] std::set<std::uint32_t> neighbors_of_cluster(std::uint32_t cluster) const {
    std::set<std::uint32_t> found;
    for (const std::uint32_t cell : clusters_[cluster].cells) {
      for (const std::uint32_t neighbor : partition_.neighbors_of(cell)) {
        if (cluster_of_[neighbor] != cluster) found.insert(cluster_of_[neighbor]);
      }
    }
    return found;
  }

  [[nodiscard]] std::vector<std::uint32_t> live_clusters() const {
    std::vector<std::uint32_t> live;
    for (std::uint32_t c = 0; c < clusters_.size(); ++c) {
      if (!clusters_[c].cells.empty()) live.push_back(c);
    }
    return live;
  }

  // ------------------------------------------------------------------------------------------- relaxation

  // Makes rounds over all clusters in random order, until several rounds in a row remove no cluster.
  void relax() {
    begin_stage(options_.progress, "relaxation", 0);
    while (fruitless_ < options_.fruitless_rounds && live_clusters().size() > 1) {
      const std::size_t before = live_clusters().size();
      std::vector<std::uint32_t> order = live_clusters();
      for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random_.below(i)]);
      for (const std::uint32_t cluster : order) {
        if (!clusters_[cluster].cells.empty()) relax_cluster(cluster);
        advance_stage(options_.progress, 1);
      }
      ++statistics_.iterations;
      fruitless_ = live_clusters().size() < before ? 0 : fruitless_ + 1;
      record_state();
    }
  }

  // Moves cells of the 1-ring out to the 2-ring, and then the cells of S out to the 1-ring.
  void relax_cluster(std::uint32_t s) {
    const std::set<std::uint32_t> ring1 = neighbors_of_cluster(s);
    std::set<std::uint32_t> inner = ring1;
    inner.insert(s);
    std::vector<std::uint32_t> ring1_cells;
    for (const std::uint32_t cluster : ring1) {
      ring1_cells.insert(ring1_cells.end(), clusters_[cluster].cells.begin(), clusters_[cluster].cells.end());
    }
    move_cells(ring1_cells, [&](std::uint32_t target) { return !inner.contains(target); });
    move_cells(clusters_[s].cells, [&](std::uint32_t target) { return target != s; });
  }

  // Moves cells of the list to neighbouring clusters that `allowed` accepts, at random, until none can move.
  template <class Allowed>
  void move_cells(std::vector<std::uint32_t> cells, const Allowed& allowed) {
    std::sort(cells.begin(), cells.end());
    for (bool moved = true; moved;) {
      moved = false;
      std::vector<std::pair<std::uint32_t, std::uint32_t>> moves;
      for (const std::uint32_t cell : cells) {
        std::set<std::uint32_t> targets;
        for (const std::uint32_t neighbor : partition_.neighbors_of(cell)) {
          const std::uint32_t target = cluster_of_[neighbor];
          if (target != cluster_of_[cell] && allowed(target) && !known_refused(cell, target)) {
            targets.insert(target);
          }
        }
        for (const std::uint32_t target : targets) moves.emplace_back(cell, target);
      }
      for (std::size_t i = moves.size(); i > 1; --i) std::swap(moves[i - 1], moves[random_.below(i)]);
      std::set<std::uint32_t> gone;
      for (const auto& [cell, target] : moves) {
        stop_if_requested(options_.progress);
        if (gone.contains(cell)) continue;
        if (!try_move(cell, target)) {
          refused_[{cell, target}] = losses_[target];
          continue;
        }
        gone.insert(cell);
        moved = true;
      }
      std::erase_if(cells, [&](std::uint32_t cell) { return gone.contains(cell); });
    }
  }

  bool try_move(std::uint32_t cell, std::uint32_t target_number) {
    refresh(target_number);
    Cluster& target = clusters_[target_number];
    if (!extend_ranks(table_, target.edges, cell_edges_[cell], target.ranks)) return false;
    target.edges = unite(target.edges, cell_edges_[cell]);
    target.cells.insert(std::lower_bound(target.cells.begin(), target.cells.end(), cell), cell);
    Cluster& source = clusters_[cluster_of_[cell]];
    std::erase(source.cells, cell);
    stale_.insert(cluster_of_[cell]);
    ++losses_[cluster_of_[cell]];
    cluster_of_[cell] = target_number;
    return true;
  }

  // Returns whether the cluster is known to refuse the cell: it did so, and has not lost a cell since.
  [[nodiscard]] bool known_refused(std::uint32_t cell, std::uint32_t target) const {
    const auto found = refused_.find({cell, target});
    const auto losses = losses_.find(target);
    return found != refused_.end() && found->second == (losses == losses_.end() ? 0 : losses->second);
  }

  // Computes the edges of a cluster anew if it has lost cells. This is delayed until its edges are needed.
  void refresh(std::uint32_t cluster) {
    if (stale_.erase(cluster) == 0) return;
    clusters_[cluster].edges = edges_of(clusters_[cluster].cells);
  }

  // ---------------------------------------------------------------------------------------------- records

  void record_state() {
    if (!records_.kept()) return;
    SearchState state;
    state.numbers = live_clusters();
    for (const std::uint32_t number : state.numbers) {
      state.cells.push_back(clusters_[number].cells);
      state.ranks.push_back(clusters_[number].ranks);
    }
    state.losses = losses_;
    state.refused = refused_;
    state.random = random_.state();
    state.fruitless = fruitless_;
    state.rounds = statistics_.iterations;
    state.clusters_before = statistics_.clusters_before_relaxation;
    record(records_, "clusters", state);
  }

  void restore(const SearchState& state) {
    clusters_.assign(state.numbers.empty() ? 0 : state.numbers.back() + 1, {});
    for (std::size_t i = 0; i < state.numbers.size(); ++i) {
      Cluster& cluster = clusters_[state.numbers[i]];
      cluster.cells = state.cells[i];
      cluster.ranks = state.ranks[i];
      for (const std::uint32_t cell : cluster.cells) cluster_of_[cell] = state.numbers[i];
      cluster.edges = edges_of(cluster.cells);
    }
    losses_ = state.losses;
    refused_ = state.refused;
    random_ = Random(state.random);
    fruitless_ = state.fruitless;
    statistics_.iterations = state.rounds;
    statistics_.clusters_before_relaxation = state.clusters_before;
  }

  [[nodiscard]] EdgeSet edges_of(const std::vector<std::uint32_t>& cells) const {
    std::vector<const EdgeSet*> parts;
    parts.reserve(cells.size());
    for (const std::uint32_t cell : cells) parts.push_back(&cell_edges_[cell]);
    return unite_all(table_, parts);
  }

  Clustering result() {
    Clustering clustering;
    clustering.cluster_of.resize(cluster_of_.size());
    for (const std::uint32_t number : live_clusters()) {
      for (const std::uint32_t cell : clusters_[number].cells) {
        clustering.cluster_of[cell] = clustering.cluster_count();
      }
      clustering.ranks.push_back(clusters_[number].ranks);
    }
    const std::vector<double> costs = violation_table(graph_, clustering.ranks);
    for (std::size_t cell = 0; cell < clustering.cluster_of.size(); ++cell) {
      clustering.cost += costs[cell * clustering.cluster_count() + clustering.cluster_of[cell]];
    }
    return clustering;
  }

  const ViewPartition& partition_;
  const OcclusionGraph& graph_;
  const OrderOptions& options_;
  OrderStatistics& statistics_;
  const RunRecords& records_;
  Random random_;
  std::uint32_t fruitless_ = 0;  // rounds of relaxation since one removed a cluster
  EdgeTable table_;
  std::vector<EdgeSet> cell_edges_;
  std::vector<Cluster> clusters_;  // merged ones are appended; relaxation only moves cells between live ones
  std::vector<std::uint32_t> cluster_of_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> dead_;
  std::set<std::uint32_t> stale_;
  std::map<std::uint32_t, std::uint32_t> losses_;  // cells that a cluster has lost so far
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>
      refused_;  // (cell, cluster) -> its losses then
};

}  // namespace

Clustering cluster_acyclically(const OrderProblem& problem, const OrderOptions& options,
                               OrderStatistics& statistics, const RunRecords& records) {
  return AcyclicClustering(problem, options, statistics, records).run();
}

}  // namespace pellucid
