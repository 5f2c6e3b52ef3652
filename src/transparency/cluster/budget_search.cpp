// The fewest orders that meet an error: see budget_search.h.
#include "transparency/cluster/budget_search.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "transparency/cluster/validation.h"
#include "transparency/upsample/upsample.h"

namespace pellucid {
namespace {

constexpr std::uint32_t kCoarseStarts = 3;  // coarse restarts per number of clusters
constexpr std::uint32_t kTrialRounds = 2;   // of each start; then the best one goes on
constexpr std::uint32_t kUsualCount = 4;    // orders that most meshes need at the default error
constexpr std::uint32_t kFineRounds = 2;    // rounds on the full mesh
constexpr float kLight = 1e-6F;             // mean square radii: left out of all fine rounds but the last
// The full mesh's error over the coarse mesh's, before any is known: finer triangles leave less to get wrong.
constexpr double kFinePerCoarse = 0.4;
// What a cell may violate more than by its best order to have that of its neighbours: a share of what it
// violates, or half a pixel of a 1024 x 1024 picture.
constexpr ContiguityOptions kContiguity{0.05, 2e-6};
constexpr std::uint32_t kPatience = 3;  // buffers that are not worthwhile, one after another: enough

class BudgetSearch {
 public:
  BudgetSearch(const OrderProblem& coarse, const OrderProblem& fine, const BudgetOptions& options)
      : coarse_(coarse), fine_(fine), options_(options), max_error_(options.target.largest()) {
    if (!same_mesh()) coarse_nodes_ = nearest_coarse_nodes(*fine.mesh, *coarse.mesh);
  }

  BudgetResult run() {
    const std::uint32_t most = std::max(options_.max_buffers, options_.min_buffers);
    // The coarse mesh says where to look; the full mesh decides.
    std::uint32_t count = likely_count(options_.min_buffers, most);

    BudgetResult best = solve_fine(count);
    if (best.error <= max_error_) {
      while (count > options_.min_buffers && expected_error(count - 1) <= max_error_) {
        BudgetResult fewer = solve_fine(--count);
        if (fewer.error > max_error_) break;
        best = std::move(fewer);
      }
    } else {
      // The full mesh has told how much harder it is than the coarse one: go where that says.
      while (count < most && best.error > max_error_) {
        count = likely_count(count + 1, most);
        BudgetResult more = solve_fine(count);
        const bool worth_it = more.error < kWorthwhile * best.error;
        if (worth_it) best = std::move(more);
        if (!worth_it) break;
      }
    }
    return best;
  }

  std::vector<BudgetResult> run_all() {
    std::vector<BudgetResult> results;
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

  // The least count from `least` on that the coarse mesh expects to do, looked for from the usual result;
  // where none does (faces that intersect have no right order at all), the one after which more buffers
  // hardly help.
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

  // What the coarse solution lets us expect of the full mesh: where that was measured for another count, in
  // proportion to the violated weights.
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

  BudgetResult solve_fine(std::uint32_t count) {
    stop_if_requested(options_.progress);
    BudgetResult result =
        checkpointed(options_.records, name_of("fine", count), [&] { return find_fine(count); });
    known_count_ = count;
    known_error_ = result.error;
    return result;
  }

  BudgetResult find_fine(std::uint32_t count) {
    BudgetResult result;
    const Clustering& coarse = solve_coarse(count);
    // Rounds of sifting every order, then the error.
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

  // The coarse partition may be subdivided less: cell f then holds the cells 4f .. 4f + 3 of the next level.
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
    validation.picture_alpha = options_.picture_alpha;
    return measure_order_error(*problem.mesh, problem.sphere, problem.partition, clustering.cluster_of,
                               clustering.ranks, validation);
  }

  const OrderProblem& coarse_;
  const OrderProblem& fine_;
  const BudgetOptions& options_;
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

BudgetResult search_budget(const OrderProblem& coarse, const OrderProblem& fine,
                           const BudgetOptions& options) {
  return BudgetSearch(coarse, fine, options).run();
}

std::vector<BudgetResult> solve_all_budgets(const OrderProblem& coarse, const OrderProblem& fine,
                                            const BudgetOptions& options) {
  return BudgetSearch(coarse, fine, options).run_all();
}

}  // namespace pellucid
