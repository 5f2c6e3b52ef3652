// Implements the k-means clustering and the error-budget method of clustering.h: searches on a coarse mesh
// for the fewest orders that meet an error, and finishes them on the full mesh.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "base/parallel.h"
#include "metric/validation.h"
#include "transparency/cluster/clustering.h"
#include "transparency/upsample.h"

namespace pellucid {

// --------------------------------------------------------------------------------------- k-means over orders

namespace {

// The ranks of all orders, interleaved, so that one edge is compared under all of them at once.
struct RankTable {
  std::uint32_t order_count;
  std::vector<std::uint32_t> ranks;  // node * order_count + order
};

RankTable interleave(const std::vector<std::vector<std::uint32_t>>& ranks) {
  const auto order_count = static_cast<std::uint32_t>(ranks.size());
  RankTable table{order_count, std::vector<std::uint32_t>(ranks.front().size() * order_count)};
  for (std::uint32_t order = 0; order < order_count; ++order) {
    for (std::size_t node = 0; node < ranks[order].size(); ++node) {
      table.ranks[node * order_count + order] = ranks[order][node];
    }
  }
  return table;
}

void add_violations(const CompactRows& rows, const RankTable& table, double* costs) {
  const std::uint32_t orders = table.order_count;
  std::vector<float> row_costs(orders);
  const RowBlock block = rows.all();
  for (NodeId node = 0; node < rows.node_count(); ++node) {
    const std::uint32_t* front = &table.ranks[std::size_t{node} * orders];
    std::fill(row_costs.begin(), row_costs.end(), 0.0F);
    block.for_each(node, [&](NodeId back_node, float weight) {
      const std::uint32_t* back = &table.ranks[std::size_t{back_node} * orders];
      for (std::uint32_t order = 0; order < orders; ++order) {
        row_costs[order] += front[order] > back[order] ? weight : 0.0F;
      }
    });
    for (std::uint32_t order = 0; order < orders; ++order)
      costs[order] += static_cast<double>(row_costs[order]);
  }
}

// Sums the edges of the clusters whose cells have changed, and sifts their orders.
void reorder_clusters(const OcclusionGraph& graph, const KMeansOptions& options, float light,
                      const std::vector<std::uint8_t>& changed, Clustering& clustering) {
  const auto reorder = [&](std::uint32_t cluster) {
    advance_stage(options.progress, 1);
    if (changed[cluster] == 0) return;
    stop_if_requested(options.progress);
    const std::vector<std::uint32_t> cells = cells_of_cluster(clustering.cluster_of, cluster);
    const PairPreferences preferences =
        net_preferences(sum_cells(graph, cells, light * static_cast<float>(cells.size())));
    SiftOptions sifting = options.sift;
    sifting.progress = options.progress;
    sift(preferences, sifting, clustering.ranks[cluster]);
  };
  if (graph.spilled) {  // memory is short, so sum one cluster at a time
    for (std::uint32_t cluster = 0; cluster < clustering.cluster_count(); ++cluster) reorder(cluster);
  } else {
    parallel_loop(std::uint32_t{0}, clustering.cluster_count(), reorder);
  }
}

}  // namespace

std::vector<double> depth_keys(const Mesh& mesh, const BoundingSphere& sphere, const ViewPartition& partition,
                               std::span<const std::uint32_t> cells) {
  std::vector<double> keys(2 * mesh.triangles.size(), 0.0);
  std::vector<Vec3d> directions;
  directions.reserve(cells.size());
  for (const std::uint32_t cell : cells) directions.push_back(cell_direction(partition, cell));
  const double scale = sphere.radius > 0 ? 1.0 / sphere.radius : 0.0;
  parallel_loop(std::size_t{0}, mesh.triangles.size(), [&](std::size_t t) {
    const Triangle& corners = mesh.triangles[t];
    Vec3d centroid{};
    for (const std::uint32_t v : corners) centroid += to_double(mesh.positions[v]) - sphere.center;
    centroid = centroid * (scale / 3.0);
    const Vec3d normal = triangle_normal(mesh, static_cast<std::uint32_t>(t));
    double sums[2] = {0, 0};
    double weights[2] = {0, 0};
    for (const Vec3d& direction : directions) {
      // Head-on views have the largest weight, because there the face covers the most.
      const double cosine = dot(normal, direction);
      const int facing = cosine < 0 ? 1 : 0;
      sums[facing] -= dot(centroid, direction) * std::fabs(cosine);
      weights[facing] += std::fabs(cosine);
    }
    for (std::size_t facing = 0; facing < 2; ++facing) {
      keys[2 * t + facing] = weights[facing] > 0 ? sums[facing] / weights[facing] : 0.0;
    }
  });
  return keys;
}

std::vector<double> violation_table(const OcclusionGraph& graph,
                                    const std::vector<std::vector<std::uint32_t>>& ranks) {
  const RankTable table = interleave(ranks);
  std::vector<double> costs(graph.cells.size() * ranks.size(), 0.0);
  parallel_loop(std::size_t{0}, graph.cells.size(), [&](std::size_t cell) {
    add_violations(graph.cells[cell], table, &costs[cell * ranks.size()]);
  });
  return costs;
}

Clustering spread_start(const OcclusionGraph& graph, const Mesh& mesh, const BoundingSphere& sphere,
                        const ViewPartition& partition, std::uint32_t cluster_count, std::uint64_t seed) {
  Random random(seed);
  const std::vector<Vec3d> directions = spread_directions(cluster_count, random);
  Clustering start;
  start.cluster_of.resize(graph.cells.size());
  for (std::uint32_t cell = 0; cell < graph.cells.size(); ++cell) {
    start.cluster_of[cell] = nearest_direction(directions, cell_direction(partition, cell));
  }
  for (std::uint32_t c = 0; c < cluster_count; ++c) {
    start.ranks.push_back(
        ranks_by_key(depth_keys(mesh, sphere, partition, cells_of_cluster(start.cluster_of, c))));
  }
  return start;
}

Clustering improve_clustering(const OcclusionGraph& graph, Clustering start, const KMeansOptions& options) {
  OrderCosts costs;
  costs.approximate = options.light > 0;
  costs.table = [&](const std::vector<std::vector<std::uint32_t>>& ranks) {
    return violation_table(graph, ranks);
  };
  costs.reorder = [&](const std::vector<std::uint8_t>& changed, bool last, Clustering& clustering) {
    reorder_clusters(graph, options, last ? 0.0F : options.light, changed, clustering);
  };
  KOrders found = improve_orders(costs, std::move(start), {options.rounds, options.least_gain});
  if (options.partition != nullptr) {
    found.clustering.cost = join_neighbors(*options.partition, found.table, found.clustering.cluster_count(),
                                           options.contiguity, found.clustering.cluster_of);
  }
  return found.clustering;
}

// -------------------------------------------------------------------------------------- the number of orders

namespace {

constexpr std::uint32_t kCoarseStarts = 3;  // coarse restarts per number of clusters
constexpr std::uint32_t kTrialRounds = 2;   // of each start; then the best one goes on
constexpr std::uint32_t kUsualCount = 4;    // orders that most meshes need at the default error
constexpr std::uint32_t kFineRounds = 2;    // rounds on the full mesh
constexpr float kLight = 1e-6F;             // mean square radii: left out of all fine rounds but the last
// The expected error of the full mesh relative to that of the coarse mesh, before any is measured. Finer
// triangles leave a smaller error.
constexpr double kFinePerCoarse = 0.4;
// A cell may violate this much more than with its best order to have the order of its neighbours: a share of
// what it violates, or half a pixel of a 1024 x 1024 image.
constexpr ContiguityOptions kContiguity{0.05, 2e-6};
constexpr std::uint32_t kPatience = 3;  // the search ends after this many buffers that are not worthwhile

class OrderNumberSearch {
 public:
  OrderNumberSearch(const OrderProblem& coarse, const OrderProblem& fine, const ErrorBudgetOptions& options)
      : coarse_(coarse), fine_(fine), options_(options), max_error_(options.target.largest()) {
    if (!same_mesh()) coarse_nodes_ = nearest_coarse_nodes(*fine.mesh, *coarse.mesh);
  }

  ErrorBudgetResult run() {
    const std::uint32_t most = std::max(options_.max_buffers, options_.min_buffers);
    // The coarse mesh says which number is likely; the full mesh decides.
    std::uint32_t count = likely_count(options_.min_buffers, most);

    ErrorBudgetResult best = solve_fine(count);
    if (best.error <= max_error_) {
      while (count > options_.min_buffers && expected_error(count - 1) <= max_error_) {
        ErrorBudgetResult fewer = solve_fine(--count);
        if (fewer.error > max_error_) break;
        best = std::move(fewer);
      }
    } else {
      // The full mesh is now known to have a larger error than expected. Go on from the number that this
      // suggests.
      while (count < most && best.error > max_error_) {
        count = likely_count(count + 1, most);
        ErrorBudgetResult more = solve_fine(count);
        const bool worth_it = more.error < kWorthwhile * best.error;
        if (worth_it) best = std::move(more);
        if (!worth_it) break;
      }
    }
    return best;
  }

  std::vector<ErrorBudgetResult> run_all() {
    std::vector<ErrorBudgetResult> results;
    for (std::uint32_t count = options_.min_buffers; count <= options_.max_buffers; ++count) {
      results.push_back(solve_fine(count));
    }
    return results;
  }

 private:
  static std::string name_of(std::string step, std::uint32_t count) {
    return step.append("-").append(std::to_string(count));
  }
  [[nodiscard]] bool same_problem() const { return &coarse_ == &fine_; }
  [[nodiscard]] bool same_mesh() const { return coarse_.mesh == fine_.mesh; }

  // Returns the least number from `least` on that should meet the error by the coarse mesh, searched from the
  // usual result. If no number does (faces that intersect have no right order at all), returns the number
  // after which more buffers hardly help.
  std::uint32_t likely_count(std::uint32_t least, std::uint32_t most) {
    std::uint32_t count = std::clamp(kUsualCount, least, most);
    if (expected_error(count) <= max_error_) {
      while (count > least && expected_error(count - 1) <= max_error_) --count;
      return count;
    }
    std::uint32_t best = count;
    while (count < most && count - best < kPatience) {
      if (expected_error(++count) <= max_error_) return count;
      if (coarse_error(count) < kWorthwhile * coarse_error(best)) best = count;
    }
    while (best > least && coarse_error(best) > kWorthwhile * coarse_error(best - 1)) --best;
    return best;
  }

  // Returns the error of the full mesh that the coarse solution suggests. If the full mesh was measured for
  // another number, the error is taken in proportion to the violated weights.
  double expected_error(std::uint32_t count) {
    const double at_known_count = known_count_ == 0 ? 0 : solve_coarse(known_count_).cost;
    if (at_known_count > 0) return known_error_ * solve_coarse(count).cost / at_known_count;
    return (same_mesh() ? 1.0 : kFinePerCoarse) * coarse_error(count);
  }

  double coarse_error(std::uint32_t count) {
    const auto known = coarse_errors_.find(count);
    if (known != coarse_errors_.end()) return known->second;
    return coarse_errors_[count] = checkpointed(options_.records, name_of("coarse-error", count), [&] {
             return options_.target.error_of(measure(coarse_, solve_coarse(count)));
           });
  }

  const Clustering& solve_coarse(std::uint32_t count) {
    const auto known = coarse_solutions_.find(count);
    if (known != coarse_solutions_.end()) return known->second;
    return coarse_solutions_
        .emplace(count,
                 checkpointed(options_.records, name_of("coarse", count), [&] { return find_coarse(count); }))
        .first->second;
  }

  [[nodiscard]] Clustering find_coarse(std::uint32_t count) const {
    begin_stage(options_.progress, std::string("trying ").append(std::to_string(count)).append(" orders"), 0);
    // A single order has no start to choose.
    std::vector<Clustering> trials(count == 1 ? 1 : kCoarseStarts);
    parallel_loop(std::uint32_t{0}, static_cast<std::uint32_t>(trials.size()), [&](std::uint32_t trial) {
      stop_if_requested(options_.progress);
      const Clustering start = spread_start(coarse_.graph, *coarse_.mesh, coarse_.sphere, coarse_.partition,
                                            count, options_.seed * 1000 + trial);
      KMeansOptions first_rounds;
      first_rounds.rounds = kTrialRounds;
      first_rounds.progress = options_.progress;
      trials[trial] = improve_clustering(coarse_.graph, start, first_rounds);
    });
    const auto best =
        std::min_element(trials.begin(), trials.end(),
                         [](const Clustering& a, const Clustering& b) { return a.cost < b.cost; });
    KMeansOptions further;
    further.contiguity = kContiguity;
    further.partition = &coarse_.partition;
    further.progress = options_.progress;
    return improve_clustering(coarse_.graph, std::move(*best), further);
  }

  ErrorBudgetResult solve_fine(std::uint32_t count) {
    stop_if_requested(options_.progress);
    ErrorBudgetResult result =
        checkpointed(options_.records, name_of("fine", count), [&] { return find_fine(count); });
    known_count_ = count;
    known_error_ = result.error;
    return result;
  }

  ErrorBudgetResult find_fine(std::uint32_t count) {
    ErrorBudgetResult result;
    const Clustering& coarse = solve_coarse(count);
    // The steps are the rounds of sifting every order, and the measurement of the error.
    const std::uint64_t steps = same_problem() ? 1 : kFineRounds * count + 1;
    begin_stage(options_.progress, std::to_string(count).append(" orders"), steps);
    if (same_problem()) {
      result.clustering = coarse;
    } else {
      Clustering start;
      start.cluster_of = fine_cells(coarse.cluster_of);
      for (std::uint32_t c = 0; c < coarse.cluster_count(); ++c) {
        start.ranks.push_back(carry_ranks(coarse_, fine_, coarse_nodes_, coarse.ranks[c],
                                          cells_of_cluster(start.cluster_of, c)));
      }
      KMeansOptions options;
      options.rounds = kFineRounds;
      options.least_gain = 0.02;
      options.light = kLight;
      options.contiguity = kContiguity;
      options.partition = &fine_.partition;
      options.progress = options_.progress;
      result.clustering = improve_clustering(fine_.graph, std::move(start), options);
    }
    result.measured = measure(fine_, result.clustering);
    result.error = options_.target.error_of(result.measured);
    advance_stage(options_.progress, 1);
    return result;
  }

  // Returns the cluster of every fine cell. If the coarse partition has fewer levels, its cell f holds the
  // cells 4f .. 4f + 3 of the next level.
  [[nodiscard]] std::vector<std::uint32_t> fine_cells(const std::vector<std::uint32_t>& cluster_of) const {
    const std::uint32_t levels = fine_.partition.spec.level - coarse_.partition.spec.level;
    std::vector<std::uint32_t> result(fine_.partition.cell_count());
    for (std::uint32_t cell = 0; cell < result.size(); ++cell)
      result[cell] = cluster_of[cell >> (2 * levels)];
    return result;
  }

  [[nodiscard]] OrderError measure(const OrderProblem& problem, const Clustering& clustering) const {
    ValidationOptions validation =
        held_out_viewpoints(options_.range, options_.front_only, options_.seed, options_.progress);
    validation.image_alpha = options_.image_alpha;
    return measure_order_error(*problem.mesh, problem.sphere, problem.partition, clustering.cluster_of,
                               clustering.ranks, validation);
  }

  const OrderProblem& coarse_;
  const OrderProblem& fine_;
  const ErrorBudgetOptions& options_;
  double max_error_;  // by the target's measure, as all errors here
  std::vector<NodeId> coarse_nodes_;
  std::map<std::uint32_t, Clustering> coarse_solutions_;
  std::map<std::uint32_t, double> coarse_errors_;
  std::uint32_t known_count_ = 0;  // the last that was solved on the full mesh; 0: none yet
  double known_error_ = 0;
};

}  // namespace

std::vector<std::uint32_t> carry_ranks(const OrderProblem& coarse, const OrderProblem& fine,
                                       std::span<const NodeId> coarse_nodes,
                                       std::span<const std::uint32_t> coarse_ranks,
                                       std::span<const std::uint32_t> cells) {
  if (coarse.mesh == fine.mesh) return {coarse_ranks.begin(), coarse_ranks.end()};
  return ranks_by_key(
      upsampled_keys(coarse_nodes, coarse_ranks, depth_keys(*fine.mesh, fine.sphere, fine.partition, cells)));
}

ErrorBudgetResult find_fewest_orders(const OrderProblem& coarse, const OrderProblem& fine,
                                     const ErrorBudgetOptions& options) {
  return OrderNumberSearch(coarse, fine, options).run();
}

std::vector<ErrorBudgetResult> solve_every_number(const OrderProblem& coarse, const OrderProblem& fine,
                                                  const ErrorBudgetOptions& options) {
  return OrderNumberSearch(coarse, fine, options).run_all();
}

}  // namespace pellucid
