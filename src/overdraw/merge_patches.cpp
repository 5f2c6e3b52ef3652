// Implements merge_patches.h: joins consecutive patches in batches, and improves the orders after each batch.
#include "overdraw/merge_patches.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/parallel.h"

namespace pellucid {
namespace {

// One batch of joins saves this share of the misses that must go. The next batch is chosen with orders that
// include these joins. Smaller batches gain nothing.
constexpr double kMergeBatch = 0.3;

// Counts the misses of runs of patches that start with an empty cache. Vertices are numbered anew for every
// run, so that the cost of a count depends only on the size of the run.
class RunMisses {
 public:
  RunMisses(const OverdrawSubject& subject, const Patches& patches, std::uint32_t cache_size)
      : subject_(subject),
        patches_(patches),
        cache_size_(cache_size),
        local_(subject.frames.front().size(), kNone) {}

  double of(std::uint32_t first, std::uint32_t last) {
    triangles_.clear();
    for (std::uint32_t i = patches_.offsets[first]; i < patches_.offsets[last + 1]; ++i) {
      Triangle corners = subject_.triangles[patches_.sequence[i]];
      for (std::uint32_t& vertex : corners) vertex = number_of(vertex);
      triangles_.push_back(corners);
    }
    sequence_.resize(triangles_.size());
    std::iota(sequence_.begin(), sequence_.end(), 0U);
    const auto misses = static_cast<double>(
        cache_misses(triangles_, sequence_, static_cast<std::uint32_t>(used_.size()), cache_size_));
    for (const std::uint32_t vertex : used_) local_[vertex] = kNone;
    used_.clear();
    return misses;
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t number_of(std::uint32_t vertex) {
    if (local_[vertex] == kNone) {
      local_[vertex] = static_cast<std::uint32_t>(used_.size());
      used_.push_back(vertex);
    }
    return local_[vertex];
  }

  const OverdrawSubject& subject_;
  const Patches& patches_;
  std::uint32_t cache_size_;
  std::vector<std::uint32_t> local_, used_, sequence_;
  std::vector<Triangle> triangles_;
};

bool may_join(const Patches& patches, std::uint32_t patch) {
  return patch + 1 < patches.count() && patches.parts[patch] == patches.parts[patch + 1];
}

// Returns the misses that the successor of a patch saves if it is drawn directly after the patch.
std::vector<double> misses_saved(const OverdrawSubject& subject, const Patches& patches,
                                 std::uint32_t cache_size) {
  RunMisses misses(subject, patches, cache_size);
  std::vector<double> saved(patches.count(), 0.0);
  for (std::uint32_t patch = 0; patch < patches.count(); ++patch) {
    if (!may_join(patches, patch)) continue;
    saved[patch] = misses.of(patch, patch) + misses.of(patch + 1, patch + 1) - misses.of(patch, patch + 1);
  }
  return saved;
}

// The cost for a cluster of drawing a patch directly before its successor. One of the two moves to the other.
struct JoinCost {
  double excess = 0;     // kOverdrawUnit, summed over views
  bool at_first = true;  // it is cheaper to move the successor to the patch than the patch to its successor
};

std::vector<JoinCost> join_costs(const OrderedPatches& ordered, std::uint32_t cluster) {
  const Patches& patches = ordered.patches;
  const std::vector<std::uint32_t>& ranks = ordered.clustering.ranks[cluster];
  const std::vector<WeightedList> weighted =
      weigh_lists(ordered.lists, cells_of_cluster(ordered.clustering.cluster_of, cluster));
  LayerRows rows(ordered.lists.pool, weighted, patches.parts, ranks);
  const std::vector<double> positions(ranks.begin(), ranks.end());
  std::vector<JoinCost> costs(patches.count());
  for (std::uint32_t patch = 0; patch < patches.count(); ++patch) {
    if (!may_join(patches, patch)) continue;
    const std::uint32_t next = patch + 1;
    const bool reversed = ranks[patch] > ranks[next];
    const double to_next = cost_of_moving(rows.row(patch, positions), ranks, patch, next, reversed);
    const double to_patch = cost_of_moving(rows.row(next, positions), ranks, next, patch, reversed);
    costs[patch] = {std::max(0.0, std::min(to_next, to_patch)), to_patch < to_next};
  }
  return costs;
}

// Returns the joins with the least overdraw per saved miss that together save about this many misses. No two
// consecutive patches are joined.
std::vector<std::uint8_t> choose_joins(const Patches& patches, std::span<const double> excess,
                                       std::span<const double> saved, double misses) {
  std::vector<std::uint32_t> candidates;
  for (std::uint32_t patch = 0; patch < patches.count(); ++patch) {
    if (may_join(patches, patch) && saved[patch] > 0) candidates.push_back(patch);
  }
  std::sort(candidates.begin(), candidates.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double price_a = excess[a] / saved[a];
    const double price_b = excess[b] / saved[b];
    return price_a != price_b ? price_a < price_b : a < b;
  });
  std::vector<std::uint8_t> join(patches.count(), 0);
  double sum = 0;
  for (const std::uint32_t patch : candidates) {
    if (sum >= misses) break;
    if ((patch > 0 && join[patch - 1] != 0) || join[patch + 1] != 0) continue;
    join[patch] = 1;
    sum += saved[patch];
  }
  return join;
}

// A joined patch takes the place of the member to which the other moves at the lower cost.
std::vector<std::uint32_t> joined_ranks(std::span<const std::uint32_t> ranks,
                                        std::span<const std::uint8_t> join,
                                        std::span<const std::uint32_t> patch_of,
                                        std::span<const JoinCost> costs) {
  std::vector<double> keys(patch_of.back() + 1, 0.0);
  for (std::uint32_t patch = 0; patch < ranks.size(); ++patch) {
    const bool is_second = patch > 0 && join[patch - 1] != 0;
    const bool gives_way =
        (join[patch] != 0 && !costs[patch].at_first) || (is_second && costs[patch - 1].at_first);
    if (!gives_way) keys[patch_of[patch]] = ranks[patch];
  }
  return ranks_by_key(keys);
}

}  // namespace

double cost_of_moving(const PreferenceRow& row, std::span<const std::uint32_t> ranks, NodeId item,
                      NodeId target, bool pass_target) {
  const std::uint32_t from = ranks[item];
  const std::uint32_t to = ranks[target];
  double cost = 0;
  for (std::size_t i = 0; i < row.neighbors.size(); ++i) {
    if (row.neighbors[i] == target && !pass_target) continue;
    const std::uint32_t there = ranks[row.neighbors[i]];
    if (from < there && there <= to) cost += static_cast<double>(row.weights[i]);
    if (to <= there && there < from) cost -= static_cast<double>(row.weights[i]);
  }
  return cost;
}

std::vector<std::uint32_t> sequence_of(std::span<const std::uint32_t> ranks) {
  std::vector<std::uint32_t> sequence(ranks.size());
  for (std::uint32_t item = 0; item < ranks.size(); ++item) sequence[ranks[item]] = item;
  return sequence;
}

double mean_acmr(const OverdrawSubject& subject, const Patches& patches,
                 const std::vector<std::vector<std::uint32_t>>& ranks, std::uint32_t cache_size) {
  std::vector<std::uint64_t> misses(ranks.size());
  const auto vertices = static_cast<std::uint32_t>(subject.frames.front().size());
  parallel_loop(std::size_t{0}, ranks.size(), [&](std::size_t order) {
    misses[order] =
        cache_misses(subject.triangles, expand(patches, sequence_of(ranks[order])), vertices, cache_size);
  });
  return static_cast<double>(std::accumulate(misses.begin(), misses.end(), std::uint64_t{0})) /
         static_cast<double>(ranks.size() * subject.triangles.size());
}

std::vector<std::uint32_t> merge_patches(const OverdrawSubject& subject, const MergeOptions& options,
                                         OrderedPatches& ordered) {
  std::vector<std::uint32_t> patch_of(ordered.patches.count());
  std::iota(patch_of.begin(), patch_of.end(), 0U);
  Clustering& clustering = ordered.clustering;
  for (;;) {
    stop_if_requested(options.sift.progress);
    const double acmr = mean_acmr(subject, ordered.patches, clustering.ranks, options.cache_size);
    if (acmr <= options.acmr) break;
    std::vector<std::vector<JoinCost>> costs(clustering.cluster_count());
    parallel_loop(std::uint32_t{0}, clustering.cluster_count(),
                  [&](std::uint32_t cluster) { costs[cluster] = join_costs(ordered, cluster); });
    std::vector<double> excess(ordered.patches.count(), 0.0);
    for (const std::vector<JoinCost>& of_cluster : costs) {
      for (std::size_t patch = 0; patch < excess.size(); ++patch) excess[patch] += of_cluster[patch].excess;
    }
    const double to_save =
        kMergeBatch * (acmr - options.acmr) * static_cast<double>(subject.triangles.size());
    const std::vector<std::uint8_t> join =
        choose_joins(ordered.patches, excess, misses_saved(subject, ordered.patches, options.cache_size),
                     std::max(to_save, 1.0));
    if (std::find(join.begin(), join.end(), 1) == join.end()) break;

    JoinedPatches joined = join_patches(ordered.patches, join);
    for (std::uint32_t cluster = 0; cluster < clustering.cluster_count(); ++cluster) {
      clustering.ranks[cluster] =
          joined_ranks(clustering.ranks[cluster], join, joined.patch_of, costs[cluster]);
    }
    ordered.lists = joined_lists(ordered.lists, joined.patch_of);
    ordered.patches = std::move(joined.patches);
    for (std::uint32_t& patch : patch_of) patch = joined.patch_of[patch];
    clustering = improve_orders(measured_overdraw(ordered.lists, ordered.patches.parts, options.sift),
                                std::move(clustering), options.rounds)
                     .clustering;
  }
  return patch_of;
}

}  // namespace pellucid
