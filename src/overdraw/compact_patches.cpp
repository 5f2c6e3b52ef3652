// Implements compact_patches.h: joins small patches under a rising price per cache miss, and moves triangles
// between neighbouring patches.
#include "overdraw/compact_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "overdraw/compact_sets.h"

namespace pellucid {
namespace {

// The number of triangles of a patch at the start.
constexpr double kFirstSize = 6;
// The largest patches have this many triangles times the square of the cache size. Wider rows do not fit into
// the cache.
constexpr double kMostSize = 0.55;
// The first price of a miss, in shares of the excess per triangle, and the factor by which it rises. With a
// lower first price, patches become ragged for a little less overdraw and do not recover.
constexpr double kFirstPrice = 2, kPriceStep = 1.5;
// One batch of joins saves this share of the misses that must go, and at least kLeastBatch misses per
// triangle.
constexpr double kBatch = 0.65, kLeastBatch = 0.001;
constexpr int kMostStages = 80;
// Sweeps over all triangles. Later sweeps look only at neighbours of triangles that moved.
constexpr int kMoveSweeps = 3;
// Batches per sweep. The triangles of a batch are judged as if none of them had moved.
constexpr std::size_t kMoveBatches = 16;
// Small meshes are cheap and depend much on chance. They get several starts, with this many triangles in
// total.
constexpr std::size_t kTrialTriangles = 16'000, kMostTrials = 16;

class CompactPatches {
 public:
  CompactPatches(const OverdrawSubject& subject, const LayerLists& lists, const CompactOptions& options,
                 std::uint64_t seed)
      : subject_(subject),
        options_(options),
        links_(subject),
        parts_(part_of_triangles(subject)),
        lists_(lists),
        finders_([this] { return RunFinder(links_, options_.cache_size); }),
        random_(seed),
        places_(subject.triangles.size(), 0) {
    views_.resize(lists.view_count());
    std::iota(views_.begin(), views_.end(), 0U);
    weighted_ = weigh_lists(lists, views_);
    index_lists();
    most_size_ = static_cast<std::size_t>(std::max(2.0, kMostSize * options.cache_size * options.cache_size));
  }

  std::optional<OrderedPatches> run() {
    patch_of_ = compact_sets(links_, kFirstSize, random_);
    runs_.resize(*std::max_element(patch_of_.begin(), patch_of_.end()) + 1);
    find_runs(std::vector<std::uint8_t>(runs_.size(), 1));
    ranks_ = options_.first_ranks(patches());
    OrderedPatches ordered = sifted();
    price_ = kFirstPrice * excess_ / triangles();
    for (int stage = 0; stage < kMostStages; ++stage) {
      stop_if_requested(options_.sift.progress);
      const double acmr = mean_acmr(subject_, ordered.patches, {ranks_}, options_.cache_size);
      if (acmr <= options_.acmr) return finished(std::move(ordered));
      std::vector<std::uint8_t> changed(runs_.size(), 0);
      join(ordered, triangles() * std::max(kBatch * (acmr - options_.acmr), kLeastBatch), changed);
      move_triangles(changed);
      if (std::find(changed.begin(), changed.end(), 1) == changed.end()) {
        if (no_joins_) break;
        continue;
      }
      number_anew(changed);
      ordered = sifted();
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] double triangles() const { return static_cast<double>(patch_of_.size()); }

  // Indexes the lists by the triangles that they hold.
  void index_lists() {
    offsets_.assign(subject_.triangles.size() + 1, 0);
    const auto visit = [&](const auto& use) {
      for (std::uint32_t i = 0; i < weighted_.size(); ++i) {
        for (const Layer layer : lists_.pool.list(weighted_[i].list)) use(patch_of_layer(layer), i);
      }
    };
    visit([&](std::uint32_t triangle, std::uint32_t) { ++offsets_[triangle + 1]; });
    std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
    lists_of_.resize(offsets_.back());
    std::vector<std::uint64_t> next(offsets_.begin(), offsets_.end() - 1);
    visit([&](std::uint32_t triangle, std::uint32_t list) { lists_of_[next[triangle]++] = list; });
  }

  // ---------------------------------------------------------------------------------------------- patches

  [[nodiscard]] Patches patches() const {
    Patches patches;
    patches.offsets.push_back(0);
    for (const std::vector<std::uint32_t>& run : runs_) {
      patches.sequence.insert(patches.sequence.end(), run.begin(), run.end());
      patches.offsets.push_back(static_cast<std::uint32_t>(patches.sequence.size()));
      patches.parts.push_back(parts_[run.front()]);
    }
    return patches;
  }

  // Finds the runs of the patches that changed.
  void find_runs(const std::vector<std::uint8_t>& changed) {
    for (std::size_t patch = 0; patch < runs_.size(); ++patch) {
      if (changed[patch] != 0) runs_[patch].clear();
    }
    for (std::uint32_t triangle = 0; triangle < patch_of_.size(); ++triangle) {
      if (changed[patch_of_[triangle]] != 0) runs_[patch_of_[triangle]].push_back(triangle);
    }
    parallel_loop(std::size_t{0}, runs_.size(), [&](std::size_t patch) {
      if (changed[patch] != 0) runs_[patch] = finders_.local().find(runs_[patch]);
    });
  }

  // Renumbers the patches, without those that have no triangles left.
  void number_anew(std::vector<std::uint8_t>& changed) {
    find_runs(changed);
    std::vector<std::uint32_t> numbers(runs_.size(), MeshLinks::kNone);
    std::vector<double> keys;
    for (std::size_t patch = 0; patch < runs_.size(); ++patch) {
      if (runs_[patch].empty()) continue;
      numbers[patch] = static_cast<std::uint32_t>(keys.size());
      keys.push_back(ranks_[patch]);
    }
    for (std::uint32_t& patch : patch_of_) patch = numbers[patch];
    std::erase_if(runs_, [](const std::vector<std::uint32_t>& run) { return run.empty(); });
    ranks_ = ranks_by_key(keys);
  }

  OrderedPatches sifted() {
    OrderedPatches ordered;
    ordered.patches = patches();
    ordered.lists = lists_of_patches(lists_, places_of(ordered.patches));
    sift_layers(ordered.lists, views_, ordered.patches.parts, options_.sift, ranks_);
    excess_ = static_cast<double>(excess_of(ordered.lists.pool, weigh_lists(ordered.lists, views_), ranks_));
    return ordered;
  }

  [[nodiscard]] OrderedPatches finished(OrderedPatches ordered) const {
    ordered.clustering.cluster_of.assign(views_.size(), 0);
    ordered.clustering.ranks = {ranks_};
    const std::vector<double> table = overdraw_table(ordered.lists, ordered.clustering.ranks);
    ordered.clustering.cost = std::accumulate(table.begin(), table.end(), 0.0);
    return ordered;
  }

  // ------------------------------------------------------------------------------------------------ joins

  // Two patches that share vertices.
  struct Join {
    std::uint32_t first, second;
    std::uint32_t vertices;  // misses saved
    double excess;           // kOverdrawUnit, summed over views
    bool at_first;           // cheaper where the first is than where the second is
    [[nodiscard]] double price() const { return excess / vertices; }
  };

  [[nodiscard]] std::vector<Join> possible_joins() const {
    std::vector<std::array<std::uint32_t, 2>> pairs;
    std::vector<std::uint32_t> at_vertex;
    for (std::uint32_t vertex = 0; vertex < links_.vertex_count(); ++vertex) {
      at_vertex.clear();
      for (const std::uint32_t triangle : links_.around(vertex)) at_vertex.push_back(patch_of_[triangle]);
      std::sort(at_vertex.begin(), at_vertex.end());
      at_vertex.erase(std::unique(at_vertex.begin(), at_vertex.end()), at_vertex.end());
      // If very many patches share a vertex, only some of their pairs are tried.
      constexpr std::size_t kMostAtVertex = 16;
      for (std::size_t i = 0; i < at_vertex.size(); ++i) {
        for (std::size_t j = i + 1; j < std::min(at_vertex.size(), i + kMostAtVertex); ++j)
          pairs.push_back({at_vertex[i], at_vertex[j]});
      }
    }
    std::sort(pairs.begin(), pairs.end());
    std::vector<Join> joins;
    for (std::size_t begin = 0; begin < pairs.size();) {
      std::size_t end = begin;
      while (end < pairs.size() && pairs[end] == pairs[begin]) ++end;
      const auto [a, b] = pairs[begin];
      const bool same_part = parts_[runs_[a].front()] == parts_[runs_[b].front()];
      if (same_part && end - begin > 1 && runs_[a].size() + runs_[b].size() <= most_size_)
        joins.push_back({a, b, static_cast<std::uint32_t>(end - begin), 0, true});
      begin = end;
    }
    return joins;
  }

  void price_joins(const OrderedPatches& ordered, std::vector<Join>& joins) const {
    const std::vector<WeightedList> weighted = weigh_lists(ordered.lists, views_);
    const std::vector<double> positions(ranks_.begin(), ranks_.end());
    // Every thread has its own rows, because a LayerRows makes one row at a time.
    PerThread<LayerRows> rows(
        [&] { return LayerRows(ordered.lists.pool, weighted, ordered.patches.parts, ranks_); });
    std::vector<std::vector<std::uint32_t>> of_patch(runs_.size());
    for (std::uint32_t i = 0; i < joins.size(); ++i) {
      of_patch[joins[i].first].push_back(i);
      of_patch[joins[i].second].push_back(i);
    }
    std::vector<std::array<double, 2>> costs(joins.size());
    parallel_loop(std::uint32_t{0}, static_cast<std::uint32_t>(runs_.size()), [&](std::uint32_t patch) {
      if (of_patch[patch].empty()) return;
      const PreferenceRow row = rows.local().row(patch, positions);
      for (const std::uint32_t i : of_patch[patch]) {
        const bool is_first = joins[i].first == patch;
        costs[i][is_first ? 0 : 1] =
            cost_of_moving(row, ranks_, patch, is_first ? joins[i].second : joins[i].first, false);
      }
    });
    for (std::size_t i = 0; i < joins.size(); ++i) {
      joins[i].excess = std::max(0.0, std::min(costs[i][0], costs[i][1]));
      joins[i].at_first = costs[i][1] < costs[i][0];
    }
  }

  // Makes the cheapest joins whose cost is within the price, which together save about `misses`. No patch is
  // joined twice. If there are none, the price rises, at least to that of the cheapest join.
  void join(const OrderedPatches& ordered, double misses, std::vector<std::uint8_t>& changed) {
    std::vector<Join> joins = possible_joins();
    price_joins(ordered, joins);
    std::sort(joins.begin(), joins.end(), [](const Join& a, const Join& b) {
      if (a.price() != b.price()) return a.price() < b.price();
      if (a.vertices != b.vertices) return a.vertices > b.vertices;
      return std::pair(a.first, a.second) < std::pair(b.first, b.second);
    });
    no_joins_ = joins.empty();
    if (no_joins_ || joins.front().price() > price_) price_ *= kPriceStep;
    if (!no_joins_) price_ = std::max(price_, joins.front().price());
    double saved = 0;
    for (const Join& join : joins) {
      if (saved >= misses || join.price() > price_) break;
      if (changed[join.first] != 0 || changed[join.second] != 0) continue;
      changed[join.first] = changed[join.second] = 1;
      const auto [from, to] =
          join.at_first ? std::pair(join.second, join.first) : std::pair(join.first, join.second);
      for (const std::uint32_t triangle : runs_[from]) patch_of_[triangle] = to;
      saved += join.vertices;
    }
  }

  // ------------------------------------------------------------------------------------------------ moves

  // The patches beside a triangle, and the change of the excess overdraw if it moves there: kOverdrawUnit,
  // summed over views.
  struct Offers {
    std::array<std::uint32_t, 3> to{MeshLinks::kNone, MeshLinks::kNone, MeshLinks::kNone};
    std::array<double, 3> excess{};
  };

  // A list as one triangle sees it: for each depth the first place of the other layers there.
  struct Surroundings {
    std::vector<std::uint32_t> places;
    std::size_t own = 0;  // the depth at which the triangle lies

    // Returns twice the number of fragments that are shaded if the triangle is at this place. The number is
    // doubled because the nearer one of two fragments of a patch is drawn first in half of the cases.
    [[nodiscard]] std::int64_t shaded_twice(std::uint32_t place) const {
      std::int64_t shaded = 0;
      std::uint32_t first = MeshLinks::kNone;
      for (std::size_t i = 0; i < places.size(); ++i) {
        const std::uint32_t here = i == own ? std::min(place, places[i]) : places[i];
        shaded += here < first ? 2 : here == first ? 1 : 0;
        first = std::min(first, here);
      }
      return shaded;
    }
  };

  void look_around(std::span<const Layer> list, std::uint32_t triangle, Surroundings& around) const {
    around.places.clear();
    for (const Layer layer : list) {
      if (!is_tied(layer)) around.places.push_back(MeshLinks::kNone);
      if (patch_of_layer(layer) == triangle) {
        around.own = around.places.size() - 1;
      } else {
        around.places.back() = std::min(around.places.back(), places_[patch_of_layer(layer)]);
      }
    }
  }

  [[nodiscard]] Offers offers_for(std::uint32_t triangle, Surroundings& around) const {
    Offers offers;
    std::size_t count = 0;
    for (const std::uint32_t beside : links_.across(triangle)) {
      if (beside == MeshLinks::kNone || patch_of_[beside] == patch_of_[triangle]) continue;
      const auto known = offers.to.begin() + static_cast<std::ptrdiff_t>(count);
      if (std::find(offers.to.begin(), known, patch_of_[beside]) == known)
        offers.to[count++] = patch_of_[beside];
    }
    if (count == 0) return offers;
    std::array<std::int64_t, 3> sums{};
    for (std::uint64_t use = offsets_[triangle]; use < offsets_[triangle + 1]; ++use) {
      const WeightedList& entry = weighted_[lists_of_[use]];
      look_around(lists_.pool.list(entry.list), triangle, around);
      const std::int64_t here = around.shaded_twice(places_[triangle]);
      for (std::size_t i = 0; i < count; ++i)
        sums[i] += entry.weight * (around.shaded_twice(ranks_[offers.to[i]]) - here);
    }
    for (std::size_t i = 0; i < count; ++i) offers.excess[i] = 0.5 * static_cast<double>(sums[i]);
    return offers;
  }

  // Moves triangles to a neighbouring patch where that lowers the total cost.
  void move_triangles(std::vector<std::uint8_t>& changed) {
    std::vector<std::uint32_t> sizes(runs_.size(), 0);
    for (std::size_t triangle = 0; triangle < patch_of_.size(); ++triangle) {
      ++sizes[patch_of_[triangle]];
      places_[triangle] = ranks_[patch_of_[triangle]];
    }
    std::vector<std::uint32_t> queue(patch_of_.size());
    std::iota(queue.begin(), queue.end(), 0U);
    for (int sweep = 0; sweep < kMoveSweeps && !queue.empty(); ++sweep) {
      for (std::size_t i = queue.size(); i-- > 1;) std::swap(queue[i], queue[random_.below(i + 1)]);
      const std::size_t batch = (queue.size() + kMoveBatches - 1) / kMoveBatches;
      std::vector<std::uint32_t> beside;
      for (std::size_t begin = 0; begin < queue.size(); begin += batch)
        move_batch(std::span(queue).subspan(begin, std::min(batch, queue.size() - begin)), sizes, changed,
                   beside);
      std::sort(beside.begin(), beside.end());
      beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
      queue = std::move(beside);
    }
  }

  void move_batch(std::span<const std::uint32_t> batch, std::vector<std::uint32_t>& sizes,
                  std::vector<std::uint8_t>& changed, std::vector<std::uint32_t>& beside) {
    std::vector<Offers> offers(batch.size());
    parallel_ranges(std::size_t{0}, batch.size(), 64, [&](std::size_t begin, std::size_t end) {
      Surroundings around;
      for (std::size_t i = begin; i < end; ++i) offers[i] = offers_for(batch[i], around);
    });
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const std::uint32_t triangle = batch[i];
      std::uint32_t best = MeshLinks::kNone;
      double least = 0;
      for (std::size_t k = 0; k < 3 && offers[i].to[k] != MeshLinks::kNone; ++k) {
        const std::uint32_t to = offers[i].to[k];
        if (sizes[to] >= most_size_) continue;
        const double cost = offers[i].excess[k] - price_ * vertices_saved(links_, patch_of_, triangle, to);
        if (cost >= least) continue;
        least = cost;
        best = to;
      }
      if (best == MeshLinks::kNone) continue;
      changed[patch_of_[triangle]] = changed[best] = 1;
      --sizes[patch_of_[triangle]];
      ++sizes[best];
      patch_of_[triangle] = best;
      places_[triangle] = ranks_[best];
      for (const std::uint32_t vertex : links_.corners(triangle)) {
        const auto around = links_.around(vertex);
        beside.insert(beside.end(), around.begin(), around.end());
      }
    }
  }

  const OverdrawSubject& subject_;
  const CompactOptions& options_;
  MeshLinks links_;
  std::vector<std::uint32_t> parts_;  // by triangle
  const LayerLists& lists_;           // of triangles
  std::vector<std::uint32_t> views_;  // all of the lists
  std::vector<WeightedList> weighted_;
  std::vector<std::uint64_t> offsets_;   // triangles + 1
  std::vector<std::uint32_t> lists_of_;  // indices into weighted_, by triangle
  PerThread<RunFinder> finders_;
  Random random_;
  std::size_t most_size_ = 0;
  std::vector<std::uint32_t> patch_of_;           // by triangle
  std::vector<std::uint32_t> places_;             // by triangle: the rank of its patch, while triangles move
  std::vector<std::vector<std::uint32_t>> runs_;  // by patch
  std::vector<std::uint32_t> ranks_;              // by patch
  double excess_ = 0;                             // kOverdrawUnit, summed over views
  double price_ = 0;                              // of a miss, in the same unit
  bool no_joins_ = false;
};

}  // namespace

std::optional<OrderedPatches> compact_patches(const OverdrawSubject& subject, const LayerLists& lists,
                                              const CompactOptions& options) {
  const std::size_t trials =
      std::clamp<std::size_t>(kTrialTriangles / subject.triangles.size(), 1, kMostTrials);
  std::optional<OrderedPatches> best;
  for (std::size_t trial = 0; trial < trials; ++trial) {
    std::optional<OrderedPatches> found = CompactPatches(subject, lists, options, options.seed + trial).run();
    if (found && (!best || found->clustering.cost < best->clustering.cost)) best = std::move(found);
  }
  return best;
}

Patches single_triangles(const OverdrawSubject& subject) {
  Patches patches;
  patches.sequence.resize(subject.triangles.size());
  std::iota(patches.sequence.begin(), patches.sequence.end(), 0U);
  patches.offsets.resize(patches.sequence.size() + 1);
  std::iota(patches.offsets.begin(), patches.offsets.end(), 0U);
  patches.parts = part_of_triangles(subject);
  return patches;
}

}  // namespace pellucid
