// Implements overdraw_costs.h: counts shaded fragments on stored lists, and improves orders by sifting.
#include "overdraw/overdraw_costs.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/parallel.h"

namespace pellucid {
namespace {

constexpr std::uint32_t kNever = std::numeric_limits<std::uint32_t>::max();

// The number of orders whose ranks are compared at once.
constexpr std::size_t kLanes = 8;
using RankRow = std::array<std::uint32_t, kLanes>;

// Counts the shaded fragments of a list under kLanes orders.
RankRow shaded_in_lanes(std::span<const Layer> list, const std::vector<RankRow>& ranks) {
  RankRow shaded{};
  RankRow first;
  first.fill(kNever);
  for (std::size_t i = 0; i < list.size();) {
    RankRow group = ranks[patch_of_layer(list[i])];
    for (++i; i < list.size() && is_tied(list[i]); ++i) {
      const RankRow& tied = ranks[patch_of_layer(list[i])];
      for (std::size_t lane = 0; lane < kLanes; ++lane) group[lane] = std::min(group[lane], tied[lane]);
    }
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      shaded[lane] += group[lane] <= first[lane] ? 1U : 0U;
      first[lane] = std::min(first[lane], group[lane]);
    }
  }
  return shaded;
}

// Interleaves the ranks of the orders `begin` .. begin + kLanes - 1. Lanes without an order repeat the first.
std::vector<RankRow> side_by_side(const std::vector<std::vector<std::uint32_t>>& ranks, std::size_t begin) {
  std::vector<RankRow> rows(ranks.front().size());
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const auto& order = ranks[begin + lane < ranks.size() ? begin + lane : begin];
    for (std::size_t patch = 0; patch < rows.size(); ++patch) rows[patch][lane] = order[patch];
  }
  return rows;
}

}  // namespace

std::uint32_t shaded_layers(std::span<const Layer> list, std::span<const std::uint32_t> ranks) {
  std::uint32_t shaded = 0;
  std::uint32_t first = kNever;
  for (std::size_t i = 0; i < list.size();) {
    std::uint32_t rank = ranks[patch_of_layer(list[i])];
    for (++i; i < list.size() && is_tied(list[i]); ++i) rank = std::min(rank, ranks[patch_of_layer(list[i])]);
    if (rank > first) continue;
    first = rank;
    ++shaded;
  }
  return shaded;
}

std::vector<double> overdraw_table(const LayerLists& lists,
                                   const std::vector<std::vector<std::uint32_t>>& ranks) {
  const std::size_t orders = ranks.size();
  std::vector<double> table(lists.view_count() * orders, 0.0);
  std::vector<std::array<std::uint16_t, kLanes>> excess(lists.pool.count());
  for (std::size_t begin = 0; begin < orders; begin += kLanes) {
    const std::vector<RankRow> rows = side_by_side(ranks, begin);
    const std::size_t lanes = std::min(kLanes, orders - begin);
    parallel_ranges(std::uint32_t{0}, lists.pool.count(), 4096, [&](std::uint32_t first, std::uint32_t last) {
      for (std::uint32_t i = first; i < last; ++i) {
        const RankRow shaded = shaded_in_lanes(lists.pool.list(i), rows);
        for (std::size_t lane = 0; lane < kLanes; ++lane)
          excess[i][lane] = static_cast<std::uint16_t>(std::min(shaded[lane] - 1, 65535U));
      }
    });
    parallel_loop(std::uint32_t{0}, lists.view_count(), [&](std::uint32_t view) {
      std::array<std::uint64_t, kLanes> sums{};
      for (const ListUse& use : lists.uses_of(view)) {
        for (std::size_t lane = 0; lane < kLanes; ++lane)
          sums[lane] += std::uint64_t{use.pixels} * excess[use.list][lane];
      }
      const double scale = lists.covered[view] > 0 ? 1.0 / static_cast<double>(lists.covered[view]) : 0.0;
      for (std::size_t lane = 0; lane < lanes; ++lane)
        table[view * orders + begin + lane] = static_cast<double>(sums[lane]) * scale;
    });
  }
  return table;
}

std::vector<WeightedList> weigh_lists(const LayerLists& lists, std::span<const std::uint32_t> views) {
  std::vector<std::int64_t> weights(lists.pool.count(), 0);
  for (const std::uint32_t view : views) {
    if (lists.covered[view] == 0) continue;
    const std::int64_t unit = kOverdrawUnit / static_cast<std::int64_t>(lists.covered[view]);
    for (const ListUse& use : lists.uses_of(view)) weights[use.list] += unit * use.pixels;
  }
  std::vector<WeightedList> weighted;
  for (std::uint32_t i = 0; i < weights.size(); ++i) {
    if (weights[i] > 0) weighted.push_back({i, weights[i]});
  }
  return weighted;
}

std::int64_t excess_of(const ListPool& pool, std::span<const WeightedList> weighted,
                       std::span<const std::uint32_t> ranks) {
  std::int64_t excess = 0;
  for (const WeightedList& entry : weighted)
    excess += entry.weight * (shaded_layers(pool.list(entry.list), ranks) - 1);
  return excess;
}

// ------------------------------------------------------------------------------------------------- rows

LayerRows::LayerRows(const ListPool& pool, std::span<const WeightedList> weighted,
                     std::span<const std::uint32_t> patch_parts, std::span<const std::uint32_t> ranks)
    : pool_(pool),
      weighted_(weighted),
      patch_parts_(patch_parts),
      offsets_(patch_parts.size() + 1, 0),
      sums_(patch_parts.size(), 0),
      met_(patch_parts.size(), 0) {
  std::vector<std::uint32_t> last(patch_parts.size(), kNever);  // list that a patch was last seen in
  const auto visit = [&](const auto& use) {
    std::fill(last.begin(), last.end(), kNever);
    for (std::uint32_t i = 0; i < weighted.size(); ++i) {
      for (const Layer layer : pool.list(weighted[i].list)) {
        const std::uint32_t patch = patch_of_layer(layer);
        if (last[patch] != i) use(patch, i);
        last[patch] = i;
      }
    }
  };
  visit([&](std::uint32_t patch, std::uint32_t) { ++offsets_[patch + 1]; });
  std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
  lists_of_.resize(offsets_.back());
  std::vector<std::uint64_t> next(offsets_.begin(), offsets_.end() - 1);
  visit([&](std::uint32_t patch, std::uint32_t list) { lists_of_[next[patch]++] = list; });

  for (std::uint32_t patch = 0; patch < patch_parts.size(); ++patch) {
    const double rank = ranks[patch];
    if (patch_parts[patch] >= free_ranges_.size())
      free_ranges_.resize(patch_parts[patch] + 1, {1e300, -1e300});
    // The ranges of neighbouring parts meet half a rank beyond the last patch.
    auto& [first, last_rank] = free_ranges_[patch_parts[patch]];
    first = std::min(first, rank - 0.5);
    last_rank = std::max(last_rank, rank + 0.5);
  }
}

void LayerRows::add(NodeId neighbor, std::int64_t weight) {
  if (met_[neighbor] == 0) {
    met_[neighbor] = 1;
    neighbors_.push_back(neighbor);
  }
  sums_[neighbor] += weight;
}

void LayerRows::gather(std::span<const Layer> list, NodeId patch, std::int64_t weight,
                       std::span<const double> positions) {
  constexpr double kBehindAll = std::numeric_limits<double>::infinity();
  double first = kBehindAll;  // the first drawn of all nearer layers but the patch's own
  NodeId first_patch = kNever;
  bool met = false;  // true once a layer of the patch has been passed
  for (std::size_t i = 0; i < list.size();) {
    bool own = false;
    double group = kBehindAll;
    NodeId group_patch = kNever;
    do {
      const NodeId layer = patch_of_layer(list[i]);
      if (layer == patch) {
        own = true;
      } else if (positions[layer] < group) {
        group = positions[layer];
        group_patch = layer;
      }
      ++i;
    } while (i < list.size() && is_tied(list[i]));
    const bool group_first = group <= first && group_patch != kNever;
    if (own && !group_first && first_patch != kNever) add(first_patch, -weight);
    if (!own && met && group_first) add(group_patch, weight);
    if (group_first) {
      first = group;
      first_patch = group_patch;
    }
    met = met || own;
  }
}

PreferenceRow LayerRows::row(NodeId patch, std::span<const double> positions) {
  for (const NodeId neighbor : neighbors_) {
    sums_[neighbor] = 0;
    met_[neighbor] = 0;
  }
  neighbors_.clear();
  weights_.clear();
  for (std::uint64_t i = offsets_[patch]; i < offsets_[patch + 1]; ++i) {
    const WeightedList& entry = weighted_[lists_of_[i]];
    gather(pool_.list(entry.list), patch, entry.weight, positions);
  }
  // Patches of other parts are never passed.
  std::erase_if(neighbors_, [&](NodeId neighbor) {
    const bool same_part = patch_parts_[neighbor] == patch_parts_[patch];
    if (!same_part) {
      sums_[neighbor] = 0;
      met_[neighbor] = 0;
    }
    return !same_part;
  });
  for (const NodeId neighbor : neighbors_) weights_.push_back(static_cast<float>(sums_[neighbor]));
  return {neighbors_, weights_};
}

// ----------------------------------------------------------------------------------------------- orders

PatchCentroids::PatchCentroids(const OverdrawSubject& subject, const Patches& patches)
    : patches_(patches.count()), centroids_(subject.frames.size() * patches.count()) {
  parallel_loop(std::size_t{0}, subject.frames.size(), [&](std::size_t frame) {
    const std::vector<Vec3f>& positions = subject.frames[frame];
    for (std::uint32_t patch = 0; patch < patches_; ++patch) {
      Vec3d sum;
      for (const std::uint32_t triangle : patches.triangles_of(patch)) {
        for (const std::uint32_t vertex : subject.triangles[triangle]) sum += to_double(positions[vertex]);
      }
      const auto corners = static_cast<double>(3 * patches.triangles_of(patch).size());
      centroids_[frame * patches_ + patch] = to_float(sum / corners);
    }
  });
}

std::vector<double> summed_distances(const PatchCentroids& centroids, std::span<const OverdrawView> views,
                                     std::span<const std::uint32_t> chosen,
                                     std::span<const BoundingSphere> spheres) {
  std::vector<double> sums(centroids.patch_count(), 0.0);
  std::vector<Vec3d> eyes;
  for (const std::uint32_t v : chosen) {
    const OverdrawView& view = views[v];
    eyes.push_back(spheres[view.frame].center +
                   view.viewpoint.direction * (view.viewpoint.distance * spheres[view.frame].radius));
  }
  parallel_loop(std::uint32_t{0}, centroids.patch_count(), [&](std::uint32_t patch) {
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const Vec3d at = to_double(centroids.at(views[chosen[i]].frame, patch));
      if (std::isfinite(at.x + at.y + at.z)) sums[patch] += length(at - eyes[i]);
    }
  });
  return sums;
}

std::vector<std::uint32_t> ranks_by_part(std::span<const double> keys,
                                         std::span<const std::uint32_t> patch_parts) {
  struct Mean {
    double sum = 0, count = 0;
  };
  std::vector<Mean> means(patch_parts.empty() ? 0 : patch_parts.back() + 1);
  for (std::size_t patch = 0; patch < keys.size(); ++patch) {
    means[patch_parts[patch]].sum += keys[patch];
    means[patch_parts[patch]].count += 1;
  }
  std::vector<double> part_keys;
  part_keys.reserve(means.size());
  for (const Mean& mean : means) part_keys.push_back(mean.count > 0 ? mean.sum / mean.count : 0);
  const std::vector<std::uint32_t> part_ranks = ranks_by_key(part_keys);
  std::vector<std::uint32_t> sequence(keys.size());
  std::iota(sequence.begin(), sequence.end(), 0U);
  std::sort(sequence.begin(), sequence.end(), [&](std::uint32_t a, std::uint32_t b) {
    const std::uint32_t part_a = part_ranks[patch_parts[a]];
    const std::uint32_t part_b = part_ranks[patch_parts[b]];
    if (part_a != part_b) return part_a < part_b;
    return keys[a] != keys[b] ? keys[a] < keys[b] : a < b;
  });
  std::vector<std::uint32_t> ranks(keys.size());
  for (std::uint32_t rank = 0; rank < sequence.size(); ++rank) ranks[sequence[rank]] = rank;
  return ranks;
}

namespace {

// Returns edges between parts: the pixels where a layer of one part lies before a layer of the other.
EdgeRows part_edges(const ListPool& pool, std::span<const WeightedList> weighted,
                    std::span<const std::uint32_t> patch_parts, std::uint32_t part_count) {
  std::vector<std::int64_t> weights(std::size_t{part_count} * part_count, 0);
  std::vector<std::uint32_t> parts;
  for (const WeightedList& entry : weighted) {
    parts.clear();
    for (const Layer layer : pool.list(entry.list)) {
      const std::uint32_t part = patch_parts[patch_of_layer(layer)];
      if (std::find(parts.begin(), parts.end(), part) == parts.end()) parts.push_back(part);
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      for (std::size_t j = i + 1; j < parts.size(); ++j)
        weights[std::size_t{parts[i]} * part_count + parts[j]] += entry.weight;
    }
  }
  EdgeRows rows;
  rows.offsets.push_back(0);
  for (std::uint32_t front = 0; front < part_count; ++front) {
    for (std::uint32_t back = 0; back < part_count; ++back) {
      const std::int64_t weight = weights[std::size_t{front} * part_count + back];
      if (weight == 0) continue;
      rows.backs.push_back(back);
      rows.weights.push_back(static_cast<float>(weight));
    }
    rows.offsets.push_back(static_cast<std::uint32_t>(rows.backs.size()));
  }
  return rows;
}

// Changes the order of the parts if that shades fewer fragments.
void sift_parts(const ListPool& pool, std::span<const WeightedList> weighted,
                std::span<const std::uint32_t> patch_parts, std::vector<std::uint32_t>& ranks) {
  const std::uint32_t part_count = patch_parts.back() + 1;
  if (part_count < 2) return;
  constexpr std::uint32_t kMostParts = 2048;  // pairs are counted in a square
  if (part_count > kMostParts) return;
  // The rank of a part is the rank of its first patch.
  std::vector<double> keys(part_count, std::numeric_limits<double>::max());
  for (std::size_t patch = 0; patch < ranks.size(); ++patch)
    keys[patch_parts[patch]] = std::min<double>(keys[patch_parts[patch]], ranks[patch]);
  std::vector<std::uint32_t> part_ranks = ranks_by_key(keys);
  sift(net_preferences(part_edges(pool, weighted, patch_parts, part_count)), {}, part_ranks);

  std::vector<std::uint32_t> sizes(part_count, 0);
  for (const std::uint32_t part : patch_parts) ++sizes[part];
  std::vector<std::uint32_t> sequence(part_count);
  for (std::uint32_t part = 0; part < part_count; ++part) sequence[part_ranks[part]] = part;
  std::vector<std::uint32_t> begins(part_count, 0);
  std::uint32_t begin = 0;
  for (const std::uint32_t part : sequence) {
    begins[part] = begin;
    begin += sizes[part];
  }
  std::vector<std::uint32_t> trial(ranks.size());
  for (std::size_t patch = 0; patch < ranks.size(); ++patch) {
    const std::uint32_t part = patch_parts[patch];
    trial[patch] = begins[part] + ranks[patch] - static_cast<std::uint32_t>(keys[part]);
  }
  if (excess_of(pool, weighted, trial) < excess_of(pool, weighted, ranks)) ranks = std::move(trial);
}

}  // namespace

void sift_layers(const LayerLists& lists, std::span<const std::uint32_t> views,
                 std::span<const std::uint32_t> patch_parts, const SiftLayersOptions& options,
                 std::vector<std::uint32_t>& ranks) {
  const std::vector<WeightedList> weighted = weigh_lists(lists, views);
  sift_parts(lists.pool, weighted, patch_parts, ranks);
  const std::int64_t before = excess_of(lists.pool, weighted, ranks);
  std::vector<std::uint32_t> trial = ranks;
  LayerRows rows(lists.pool, weighted, patch_parts, trial);
  Sifter sifter(rows, SiftOptions{}, trial);
  auto left = static_cast<double>(before);
  for (std::uint32_t sweep = 0; sweep < options.sweeps && left > 0; ++sweep) {
    stop_if_requested(options.progress);
    const double saved = sifter.sweep();
    if (saved <= options.least_gain * left) break;
    left -= saved;
  }
  if (excess_of(lists.pool, weighted, trial) < before) ranks = std::move(trial);
}

OrderCosts measured_overdraw(const LayerLists& lists, std::span<const std::uint32_t> patch_parts,
                             const SiftLayersOptions& options) {
  OrderCosts costs;
  costs.table = [&lists](const std::vector<std::vector<std::uint32_t>>& ranks) {
    return overdraw_table(lists, ranks);
  };
  costs.reorder = [&lists, patch_parts, options](const std::vector<std::uint8_t>& flagged, bool /*last*/,
                                                 Clustering& clustering) {
    parallel_loop(std::uint32_t{0}, clustering.cluster_count(), [&](std::uint32_t cluster) {
      if (flagged[cluster] == 0) return;
      sift_layers(lists, cells_of_cluster(clustering.cluster_of, cluster), patch_parts, options,
                  clustering.ranks[cluster]);
    });
  };
  return costs;
}

}  // namespace pellucid
