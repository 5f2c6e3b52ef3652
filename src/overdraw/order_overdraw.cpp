// Implements order_overdraw() and cheapest_orders() of pellucid/overdraw.h: makes patches, lists the layers
// of the training views, finds orders, and chooses one for every view.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "overdraw/compact_patches.h"
#include "overdraw/merge_patches.h"
#include "overdraw/overdraw_costs.h"
#include "pellucid/metric.h"
#include "pellucid/overdraw.h"

namespace pellucid {
namespace {

void check_arguments(const OverdrawSubject& subject, const OverdrawOptions& options) {
  if (subject.triangles.empty() || subject.frames.empty() || subject.parts.empty())
    throw Error(ErrorKind::nothing_to_do, "overdraw: there are no triangles to order");
  const auto refuse = [](const char* what) { throw Error(ErrorKind::bad_argument, what); };
  if (options.buffers < 1 || options.buffers > 256) refuse("overdraw: 1 to 256 buffers are possible");
  if (options.cache_size < 3) refuse("overdraw: the vertex cache must hold 3 vertices or more");
  if (options.view_level > 5) refuse("overdraw: the level of the icosphere of viewpoints must be 0 to 5");
  if (!(options.lambda > 0)) refuse("overdraw: lambda must be positive");
  if (!(options.min_distance > 1) || !(options.max_distance >= options.min_distance) ||
      !std::isfinite(options.max_distance)) {
    refuse("overdraw: distances must be finite, more than one bounding radius, the least first");
  }
  if (options.acmr && !(*options.acmr >= 0))
    refuse("overdraw: the misses per triangle must be a number, 0 or more");
  const std::size_t vertices = subject.frames.front().size();
  for (const std::vector<Vec3f>& positions : subject.frames) {
    if (positions.size() != vertices) refuse("overdraw: all frames must have the same vertices");
  }
  for (const Triangle& triangle : subject.triangles) {
    if (std::max({triangle[0], triangle[1], triangle[2]}) >= vertices)
      refuse("overdraw: a triangle has a vertex index that is out of range");
  }
  const auto& parts = subject.parts;
  if (parts.front() != 0 || !std::is_sorted(parts.begin(), parts.end()) ||
      parts.back() > subject.triangles.size()) {
    refuse("overdraw: parts must ascend from triangle 0");
  }
  if (!subject.double_sided.empty() && subject.double_sided.size() != subject.triangles.size())
    refuse("overdraw: double_sided must be empty or have one entry per triangle");
  if (options.most_views < 1) refuse("overdraw: one view or more must get an order of its own");
  if (options.size < 16 || options.size > 4096)
    refuse("overdraw: images must have 16 to 4096 pixels per side");
}

// Spreads distances over the range by the golden ratio, with another sequence for every pose.
double distance_of(const OverdrawOptions& options, std::uint32_t frame, std::uint32_t cell) {
  const double golden = 0.6180339887498949;
  double whole = 0;
  const double place = std::modf(golden * (cell + 1) + golden * golden * frame, &whole);
  return options.min_distance + (options.max_distance - options.min_distance) * place;
}

// Returns whether item i of `all` items belongs to an evenly spread selection of about `most` items.
bool among(std::uint64_t i, std::uint64_t all, std::uint64_t most) {
  double whole = 0;
  const double place = std::modf(0.6180339887498949 * static_cast<double>(i), &whole);
  return all <= most || place * static_cast<double>(all) < static_cast<double>(most);
}

// Returns options for smaller images, which are enough to find the cheapest of a few orders.
ListOptions choice_options(const OverdrawOptions& options) {
  return {std::max(options.size / 2, 64U), 1, options.progress};
}

// Returns the cheapest order for every view. A few thousand views are processed at a time, so that their
// lists fit into memory.
std::vector<std::uint32_t> cheapest_for(const OverdrawSubject& subject,
                                        std::span<const BoundingSphere> spheres, const Patches& patches,
                                        const std::vector<std::vector<std::uint32_t>>& ranks,
                                        std::span<const OverdrawView> views, const ListOptions& options) {
  constexpr std::size_t kViewsAtOnce = 2048;
  std::vector<std::uint32_t> cheapest;
  for (std::size_t begin = 0; begin < views.size(); begin += kViewsAtOnce) {
    const std::span<const OverdrawView> some =
        views.subspan(begin, std::min(kViewsAtOnce, views.size() - begin));
    const std::vector<double> table =
        overdraw_table(list_layers(subject, spheres, patches, some, options), ranks);
    for (std::size_t i = 0; i < some.size(); ++i) {
      const double* costs = &table[i * ranks.size()];
      cheapest.push_back(static_cast<std::uint32_t>(std::min_element(costs, costs + ranks.size()) - costs));
    }
  }
  return cheapest;
}

class OverdrawOrderer {
 public:
  OverdrawOrderer(const OverdrawSubject& subject, const OverdrawOptions& options)
      : subject_(subject),
        options_(options),
        partition_(make_partition({PartitionKind::viewpoints, options.view_level, 0})),
        spheres_(pose_spheres(subject)) {
    sift_.progress = options.progress;
    make_views();
  }

  OverdrawOrders run() {
    const Stopwatch watch;
    Stopwatch lap;
    const Patches coarse = cut_patches(subject_, cache_order(subject_, options_.cache_size), options_.lambda,
                                       options_.cache_size);
    if (options_.method == OverdrawMethod::paper) {
      run_.seconds.patches = lap.lap();
      rasterize_training(coarse);
      run_.seconds.raster = lap.lap();
      run_paper();
    } else if (!refine_single(coarse, lap)) {
      const Patches fine =
          options_.lambda >= kNoCache
              ? coarse
              : cut_patches(subject_,
                            best_cache_order(subject_, options_.cache_size, options_.seed, options_.progress),
                            std::max(kFineLambda, options_.lambda), options_.cache_size);
      run_.seconds.patches = lap.lap();
      rasterize_training(fine);
      run_.seconds.raster = lap.lap();
      refine(coarse);
    }
    run_.seconds.cluster = lap.lap();
    OverdrawOrders orders = collected();
    run_.seconds.assign = lap.lap();
    run_.seconds.total = watch.seconds();
    run_.peak_rss_bytes = peak_rss_bytes();
    orders.run = run_;
    return orders;
  }

 private:
  void make_views() {
    const std::uint32_t cells = partition_.cell_count();
    const std::uint64_t all = std::uint64_t{cells} * subject_.frames.size();
    const std::uint64_t most = options_.most_training_views == 0 ? all : options_.most_training_views;
    for (std::uint32_t frame = 0; frame < subject_.frames.size(); ++frame) {
      for (std::uint32_t cell = 0; cell < cells; ++cell) {
        const Viewpoint viewpoint{cell_direction(partition_, cell), distance_of(options_, frame, cell)};
        const bool trains = among(std::uint64_t{frame} * cells + cell, all, most);
        if (trains) {
          training_.push_back({frame, cell, viewpoint});
        } else if (gets_own_order(frame)) {
          others_.push_back({frame, cell, viewpoint});
        }
      }
    }
    run_.views = all;
    run_.training_views = training_.size();
  }

  // Chooses key frames at even steps, so that they have at most options.most_views views in total.
  [[nodiscard]] bool gets_own_order(std::uint32_t frame) const { return nearest_own(frame) == frame; }
  [[nodiscard]] std::uint32_t nearest_own(std::uint32_t frame) const {
    const std::uint64_t views = std::uint64_t{partition_.cell_count()} * subject_.frames.size();
    const auto step = static_cast<std::uint32_t>((views + options_.most_views - 1) / options_.most_views);
    const std::uint32_t nearest = (frame + step / 2) / step * step;
    return nearest < subject_.frames.size() ? nearest : nearest - step;
  }

  void rasterize_training(const Patches& patches) {
    begin_stage(options_.progress, "raster", training_.size());
    ordered_.patches = patches;
    ordered_.lists = list_layers(subject_, spheres_, patches, training_,
                                 {options_.size, affordable_share(patches), options_.progress});
  }

  // Returns the share of the pixels with which the lists of all training views stay within
  // options.most_layers.
  [[nodiscard]] double affordable_share(const Patches& patches) const {
    std::vector<OverdrawView> pilot;
    for (std::size_t i = 0; i < training_.size(); ++i) {
      if (among(i, training_.size(), kPilotViews)) pilot.push_back(training_[i]);
    }
    const LayerLists lists = list_layers(subject_, spheres_, patches, pilot, {options_.size, 1, nullptr});
    std::uint64_t layers = 0;
    for (const ListUse& use : lists.uses) layers += lists.pool.list(use.list).size() + 1;
    const double all = static_cast<double>(layers) * static_cast<double>(training_.size()) /
                       static_cast<double>(pilot.size());
    return all > static_cast<double>(options_.most_layers) ? static_cast<double>(options_.most_layers) / all
                                                           : 1;
  }

  // Bootstraps Algorithm 1 of the paper: spread-out directions, and orders by the distances of the mean pose.
  [[nodiscard]] Clustering start_clusters(const PatchCentroids& centroids, Random& random) const {
    const std::vector<Vec3d> directions = spread_directions(options_.buffers, random);
    Clustering start;
    for (const OverdrawView& view : training_)
      start.cluster_of.push_back(nearest_direction(directions, view.viewpoint.direction));
    const double distance = 0.5 * (options_.min_distance + options_.max_distance);
    for (const Vec3d& direction : directions) {
      std::vector<double> keys(centroids.patch_count(), 0.0);
      for (std::uint32_t patch = 0; patch < keys.size(); ++patch) {
        Vec3d mean;
        double radius = 0;
        for (std::uint32_t frame = 0; frame < spheres_.size(); ++frame) {
          mean += to_double(centroids.at(frame, patch)) - spheres_[frame].center;
          radius += spheres_[frame].radius;
        }
        keys[patch] = length(mean - direction * (distance * radius));
      }
      start.ranks.push_back(ranks_by_part(keys, ordered_.patches.parts));
    }
    return start;
  }

  // Runs the rest of Algorithm 1: patches by their distances, summed over the views of a cluster. `views` are
  // the training views of the lists.
  [[nodiscard]] Clustering cluster_by_distance(const OrderedPatches& ordered,
                                               std::span<const std::uint32_t> views,
                                               const PatchCentroids& centroids, Clustering start) const {
    OrderCosts costs;
    costs.table = [&](const auto& ranks) { return overdraw_table(ordered.lists, ranks); };
    costs.reorder = [&](const std::vector<std::uint8_t>& flagged, bool /*last*/, Clustering& clustering) {
      for (std::uint32_t cluster = 0; cluster < clustering.cluster_count(); ++cluster) {
        stop_if_requested(options_.progress);
        if (flagged[cluster] == 0) continue;
        std::vector<std::uint32_t> own = cells_of_cluster(clustering.cluster_of, cluster);
        for (std::uint32_t& view : own) view = views[view];
        clustering.ranks[cluster] =
            ranks_by_part(summed_distances(centroids, training_, own, spheres_), ordered.patches.parts);
      }
    };
    return improve_orders(costs, std::move(start), {kDistanceRounds, 0.0}).clustering;
  }

  void run_paper() {
    begin_stage(options_.progress, "cluster", 0);
    Random random(options_.seed);
    const PatchCentroids centroids(subject_, ordered_.patches);
    std::vector<std::uint32_t> all(training_.size());
    std::iota(all.begin(), all.end(), 0U);
    ordered_.clustering = cluster_by_distance(ordered_, all, centroids, start_clusters(centroids, random));
  }

  // Returns the misses per triangle of the paper's orders for these clusters of some training views.
  [[nodiscard]] double paper_acmr(const Patches& coarse, const Clustering& clustering,
                                  std::span<const std::uint32_t> some) const {
    const PatchCentroids centroids(subject_, coarse);
    std::vector<std::vector<std::uint32_t>> ranks;
    for (std::uint32_t cluster = 0; cluster < clustering.cluster_count(); ++cluster) {
      std::vector<std::uint32_t> views;
      for (const std::uint32_t i : cells_of_cluster(clustering.cluster_of, cluster)) views.push_back(some[i]);
      ranks.push_back(ranks_by_part(summed_distances(centroids, training_, views, spheres_), coarse.parts));
    }
    return mean_acmr(subject_, coarse, ranks, options_.cache_size);
  }

  [[nodiscard]] OrderCosts costs_of(const OrderedPatches& ordered, std::uint32_t sweeps) const {
    SiftLayersOptions sifting = sift_;
    sifting.sweeps = sweeps;
    return measured_overdraw(ordered.lists, ordered.patches.parts, sifting);
  }

  // Makes patches and first orders from some of the views, and then orders from all views.
  void refine(const Patches& coarse) {
    begin_stage(options_.progress, "cluster", 0);
    std::vector<std::uint32_t> some;
    for (std::uint32_t view = 0; view < training_.size(); ++view) {
      if (among(view, training_.size(), kPatchViews)) some.push_back(view);
    }
    OrderedPatches few{ordered_.patches, lists_of_views(ordered_.lists, some), {}};
    few.clustering = best_start(few, some);
    if (options_.lambda < kNoCache) {
      MergeOptions merging;
      merging.acmr =
          kAcmrMargin * (options_.acmr ? *options_.acmr : paper_acmr(coarse, few.clustering, some));
      merging.cache_size = options_.cache_size;
      merging.sift = sift_;
      merging.sift.sweeps = first_sweeps();
      const std::vector<std::uint32_t> patch_of = merge_patches(subject_, merging, few);
      ordered_.lists = joined_lists(ordered_.lists, patch_of);
      ordered_.patches = few.patches;
    }
    // A view for which all orders cost the same keeps the order of the views of its direction.
    Clustering all;
    all.cluster_of = start_of_best_;
    all.ranks = std::move(few.clustering.ranks);
    ordered_.clustering =
        improve_orders(costs_of(ordered_, kLastSweeps), std::move(all), {5, 2e-3}).clustering;
  }

  // Makes one order for one pose from compact patches, which need no runs of a cache order. Returns false if
  // it does not apply to the options, or if it cannot reach the number of misses.
  bool refine_single(const Patches& coarse, Stopwatch& lap) {
    if (subject_.frames.size() > 1 || options_.buffers > 1 || options_.lambda >= kNoCache) return false;
    if (subject_.triangles.size() > kMostCompactTriangles) return false;
    run_.seconds.patches = lap.lap();
    rasterize_training(single_triangles(subject_));
    run_.seconds.raster = lap.lap();
    begin_stage(options_.progress, "cluster", 0);
    std::vector<std::uint32_t> all(training_.size());
    std::iota(all.begin(), all.end(), 0U);
    CompactOptions compact;
    compact.cache_size = options_.cache_size;
    compact.seed = options_.seed;
    compact.sift = sift_;
    compact.sift.sweeps = kFirstSweeps;
    compact.first_ranks = [&](const Patches& patches) {
      return ranks_by_part(summed_distances(PatchCentroids(subject_, patches), training_, all, spheres_),
                           patches.parts);
    };
    compact.acmr = options_.acmr
                       ? *options_.acmr
                       : mean_acmr(subject_, coarse, {compact.first_ranks(coarse)}, options_.cache_size);
    std::optional<OrderedPatches> found = compact_patches(subject_, ordered_.lists, compact);
    if (!found) return false;
    ordered_ = *std::move(found);
    return true;
  }

  // Returns the number of sweeps in intermediate steps. A single pose is cheap, so it gets as many as in the
  // last step.
  [[nodiscard]] std::uint32_t first_sweeps() const {
    return subject_.frames.size() == 1 ? kLastSweeps : kFirstSweeps;
  }

  // From each of several starts, runs the paper's clustering and a few rounds of ours. Returns the best
  // result.
  [[nodiscard]] Clustering best_start(const OrderedPatches& few, std::span<const std::uint32_t> some) {
    Random random(options_.seed);
    const PatchCentroids centroids(subject_, few.patches);
    std::optional<Clustering> best;
    for (int trial = 0; trial < (options_.buffers > 1 ? kStarts : 1); ++trial) {
      Clustering start = start_clusters(centroids, random);
      std::vector<std::uint32_t> cluster_of;
      for (const std::uint32_t view : some) cluster_of.push_back(start.cluster_of[view]);
      std::swap(start.cluster_of, cluster_of);
      // Distances order the patches that hardly any of the stored pixels shows.
      start = cluster_by_distance(few, some, centroids, std::move(start));
      Clustering found =
          improve_orders(costs_of(few, first_sweeps()), std::move(start), {kStartRounds, 0.02}).clustering;
      if (best && found.cost >= best->cost) continue;
      best = std::move(found);
      start_of_best_ = std::move(cluster_of);
    }
    return *best;
  }

  // Finds the best order for all views together. Parts stay as in the mesh.
  [[nodiscard]] std::vector<std::uint32_t> base_ranks() const {
    std::vector<std::uint32_t> some;
    for (std::uint32_t view = 0; view < training_.size(); ++view) {
      if (among(view, training_.size(), kPatchViews)) some.push_back(view);
    }
    const Patches& patches = ordered_.patches;
    std::vector<std::uint32_t> ranks = ordered_.clustering.ranks.front();
    if (options_.method == OverdrawMethod::paper) {
      ranks = ranks_by_part(summed_distances(PatchCentroids(subject_, patches), training_, some, spheres_),
                            patches.parts);
    } else if (ordered_.clustering.cluster_count() > 1) {
      const LayerLists lists = lists_of_views(ordered_.lists, some);
      std::vector<std::uint32_t> all(some.size());
      std::iota(all.begin(), all.end(), 0U);
      sift_layers(lists, all, patches.parts, sift_, ranks);
    }
    return ranks;
  }

  [[nodiscard]] OverdrawOrders collected() {
    const Patches& patches = ordered_.patches;
    std::vector<std::uint32_t> base(patches.count());
    std::iota(base.begin(), base.end(), 0U);
    const std::vector<std::uint32_t> ranks = base_ranks();
    std::sort(base.begin(), base.end(), [&](std::uint32_t a, std::uint32_t b) {
      return patches.parts[a] != patches.parts[b] ? patches.parts[a] < patches.parts[b] : ranks[a] < ranks[b];
    });
    std::vector<std::uint32_t> number(base.size());
    for (std::uint32_t i = 0; i < base.size(); ++i) number[base[i]] = i;

    OverdrawOrders orders;
    orders.spheres = spheres_;
    orders.sequence = expand(patches, base);
    orders.patch_offsets.push_back(0);
    for (const std::uint32_t patch : base) {
      orders.patch_offsets.push_back(orders.patch_offsets.back() +
                                     static_cast<std::uint32_t>(patches.triangles_of(patch).size()));
      orders.patch_parts.push_back(patches.parts[patch]);
    }
    ordered_.clustering = without_unused_orders(std::move(ordered_.clustering));
    const Clustering& clustering = ordered_.clustering;
    for (const std::vector<std::uint32_t>& of_cluster : clustering.ranks) {
      orders.orders.push_back(sequence_of(of_cluster));
      for (std::uint32_t& patch : orders.orders.back()) patch = number[patch];
    }
    orders.cell_orders = cell_orders();
    run_.patches = patches.count();
    run_.lists = ordered_.lists.pool.count();
    run_.iterations = clustering.rounds;
    run_.training_overdraw = 1 + clustering.cost / static_cast<double>(training_.size());
    run_.acmr = mean_acmr(subject_, patches, clustering.ranks, options_.cache_size);
    return orders;
  }

  // Gives orders to the views that were not trained on: the order of the same viewpoint in the trained key
  // frames before and after if these agree, or else the cheapest order.
  [[nodiscard]] std::vector<std::uint32_t> cell_orders() const {
    const std::uint32_t cells = partition_.cell_count();
    const Clustering& clustering = ordered_.clustering;
    std::vector<std::uint32_t> orders(std::size_t{cells} * subject_.frames.size(), kUnknown);
    if (clustering.cluster_count() < 2) return std::vector<std::uint32_t>(orders.size(), 0);
    for (std::size_t i = 0; i < training_.size(); ++i)
      orders[std::size_t{training_[i].frame} * cells + training_[i].cell] = clustering.cluster_of[i];
    fill_between(orders);

    std::vector<OverdrawView> views;
    for (const OverdrawView& view : others_) {
      if (orders[std::size_t{view.frame} * cells + view.cell] == kUnknown) views.push_back(view);
    }
    begin_stage(options_.progress, "assign", views.size());
    const std::vector<std::uint32_t> cheapest =
        cheapest_for(subject_, spheres_, ordered_.patches, clustering.ranks, views, choice_options(options_));
    for (std::size_t i = 0; i < views.size(); ++i)
      orders[std::size_t{views[i].frame} * cells + views[i].cell] = cheapest[i];
    for (std::size_t i = 0; i < orders.size(); ++i) {
      const auto frame = static_cast<std::uint32_t>(i / cells);
      if (orders[i] == kUnknown) orders[i] = orders[std::size_t{nearest_own(frame)} * cells + i % cells];
    }
    return orders;
  }

  void fill_between(std::vector<std::uint32_t>& orders) const {
    const std::size_t cells = partition_.cell_count();
    for (std::size_t cell = 0; cell < cells; ++cell) {
      std::size_t last = orders.size();  // entry of the last key frame that is known
      for (std::size_t i = cell; i < orders.size(); i += cells) {
        if (orders[i] == kUnknown) continue;
        if (last < orders.size() && orders[last] == orders[i]) {
          for (std::size_t k = last + cells; k < i; k += cells) orders[k] = orders[i];
        }
        last = i;
      }
    }
  }
  static constexpr std::uint32_t kUnknown = 0xFFFFFFFFU;

  // The patches that the refined method starts from have about this many misses per triangle by themselves.
  static constexpr double kFineLambda = 1.6;
  // With this lambda or more, the cache has no influence.
  static constexpr double kNoCache = 3;
  // Views that patches are chosen on. More views hardly change the patches.
  static constexpr std::uint64_t kPatchViews = 1000;
  // Views that the mean number of layers is estimated on.
  static constexpr std::uint64_t kPilotViews = 32;
  // Larger single poses are cut into runs, because moving single triangles takes more than a minute per
  // 100,000.
  static constexpr std::size_t kMostCompactTriangles = 100'000;
  // Orders for all views have slightly different misses than orders for some views.
  static constexpr double kAcmrMargin = 0.994;
  static constexpr int kStarts = 3;
  static constexpr std::uint32_t kStartRounds = 6;
  static constexpr std::uint32_t kDistanceRounds = 30;  // it converges in a few
  // Sweeps of sifting in intermediate steps, whose orders change again, and in the last step.
  static constexpr std::uint32_t kFirstSweeps = 3, kLastSweeps = 8;

  const OverdrawSubject& subject_;
  const OverdrawOptions& options_;
  ViewPartition partition_;
  std::vector<BoundingSphere> spheres_;  // by frame
  SiftLayersOptions sift_;
  std::vector<OverdrawView> training_, others_;
  OrderedPatches ordered_;                    // for the training views
  std::vector<std::uint32_t> start_of_best_;  // clusters of the training views by direction
  OverdrawRun run_;
};

}  // namespace

OverdrawOrders order_overdraw(const OverdrawSubject& subject, const OverdrawOptions& options) {
  check_arguments(subject, options);
  return OverdrawOrderer(subject, options).run();
}

std::vector<std::uint32_t> cheapest_orders(const OverdrawSubject& poses, const OverdrawOrders& orders,
                                           const OverdrawOptions& options) {
  const ViewPartition partition = make_partition({PartitionKind::viewpoints, options.view_level, 0});
  std::vector<OverdrawView> views;
  for (std::uint32_t frame = 0; frame < poses.frames.size(); ++frame) {
    for (std::uint32_t cell = 0; cell < partition.cell_count(); ++cell)
      views.push_back({frame, cell, {cell_direction(partition, cell), distance_of(options, frame, cell)}});
  }
  std::vector<std::vector<std::uint32_t>> ranks;
  for (const std::vector<std::uint32_t>& order : orders.orders) ranks.push_back(triangle_ranks(order));
  return cheapest_for(poses, pose_spheres(poses), {orders.sequence, orders.patch_offsets, orders.patch_parts},
                      ranks, views, choice_options(options));
}

std::vector<std::uint32_t> triangle_order(const OverdrawOrders& orders, std::uint32_t order) {
  return expand({orders.sequence, orders.patch_offsets, orders.patch_parts}, orders.orders[order]);
}

}  // namespace pellucid
