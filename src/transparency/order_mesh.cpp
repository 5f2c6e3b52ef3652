// Implements order_mesh() and order_frontier() of pellucid/transparency.h: computes the in-depth buffers of a
// mesh. This file calls the steps in their order; each step has a file of its own:
//
//   0. recognise a mesh that needs no search                      simple_order.h
//   1. simplify a large mesh, and a mesh for the search            pellucid/mesh.h
//   2. find the occlusion graph of every view cell                 order_problem.h, graph/occlusion_graph.h
//   3. cluster the cells: within an error budget, or acyclically   cluster/clustering.h
//   4. arrange the order of every cluster for the vertex cache     sequencing/cache_order.h
//   5. make the base order                                         order_problem.h
//   6. carry the orders over to a large mesh and repair them       upsample.h
//
// Steps that take long are kept as records, so that an interrupted run can continue (run_records.h).

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "metric/validation.h"
#include "pellucid/sequencing.h"
#include "pellucid/shading.h"
#include "pellucid/transparency.h"
#include "sequencing/cache_order.h"
#include "sequencing/edge_rows.h"
#include "transparency/cluster/clustering.h"
#include "transparency/cluster/error_target.h"
#include "transparency/order_problem.h"
#include "transparency/run_records.h"
#include "transparency/simple_order.h"
#include "transparency/upsample.h"

namespace pellucid {
namespace {

// The authors' tolerance for the acyclic method, bounding radii. Without it, cells could not share an order
// because of overlaps that no pixel shows.
constexpr double kAcyclicTolerance = 0.003;
// With more triangles, the occlusion graph of S[2,2] takes many gigabytes and minutes. Then a mesh simplified
// to kUpsampleFrom triangles is ordered.
constexpr std::uint32_t kMostDirectTriangles = 24000;
constexpr std::uint32_t kUpsampleFrom = 10000;
// With an error budget, edges lighter than this are the first that may be violated for the vertex cache. It
// is the weight of about half a pixel of a 1024 x 1024 image, averaged over a cell and summed over a cluster.
constexpr float kLeastBindingWeight = 1e-6F;

// The number of clusters whose orders are made at the same time.
constexpr std::uint32_t kOrdersAtOnce = 4;

double tolerance_of(const OrderOptions& options) {
  if (options.tolerance >= 0) return options.tolerance;
  return options.method == OrderMethod::acyclic ? kAcyclicTolerance : 0.0;
}

void check_options(const Mesh& mesh, const OrderOptions& options) {
  const auto refuse = [](const std::string& reason) { throw Error(ErrorKind::bad_argument, reason); };
  if (mesh.triangles.empty()) throw Error(ErrorKind::nothing_to_do, "the mesh has no triangles to order");
  if (mesh.triangles.size() >= (std::uint64_t{1} << 30U)) refuse("the mesh has more than 2^30 triangles");
  for (const double distance : options.distances) {
    if (!(distance > 1.0)) refuse("distances are in bounding radii and must be greater than 1");
  }
  if (!(options.max_error >= 0)) refuse("the largest error must not be negative");
  if (options.least_frame_time && options.method != OrderMethod::budget)
    refuse("the number of buffers can be chosen by frame time only with the method budget");
  if (options.min_psnr && !(*options.min_psnr > 0 && *options.min_psnr <= kPerfectPsnr))
    refuse("the least PSNR must be above 0 dB and at most 100 dB, which stands for no error");
  if (!(options.alpha >= 0 && options.alpha <= 1)) refuse("the opacity alpha must be 0 .. 1");
  if (options.max_buffers == 0 || options.min_buffers == 0) refuse("at least one buffer is needed");
  if (options.min_buffers > options.max_buffers) refuse("the least number of buffers exceeds the largest");
  if (options.raster_size == 0 || options.raster_size > 8192) refuse("the raster size must be 1 .. 8192");
  if (!(options.cache_slack >= 0)) refuse("the slack of the vertex cache must not be negative");
  if (options.cache_size > 0 && options.cache_size < 3) refuse("a vertex cache holds at least 3 vertices");
  if (!(options.tolerance <= 1)) refuse("the tolerance is in bounding radii and must not exceed 1");
}

// Returns the number of view cells whose own edges are cyclic.
std::uint32_t count_cyclic_cells(const OcclusionGraph& graph) {
  std::vector<std::uint8_t> cyclic(graph.cells.size(), 0);
  parallel_loop(std::size_t{0}, graph.cells.size(), [&](std::size_t cell) {
    const EdgeRows rows = graph.cells[cell].expanded();
    cyclic[cell] = has_cycle(rows.offsets, rows.backs) ? 1 : 0;
  });
  return static_cast<std::uint32_t>(std::count(cyclic.begin(), cyclic.end(), 1));
}

// Returns whether the search needs a simpler mesh. A mesh that is hardly larger than the coarse one is
// searched as it is.
bool needs_simpler_mesh(const Mesh& mesh) {
  return mesh.triangles.size() > kCoarseTriangles * 3 / 2;
}

// Returns a partition with fewer cells and the same sampling density, for the search.
PartitionSpec coarse_partition(const PartitionSpec& spec) {
  if (!has_triangle_cells(spec)) return spec;
  PartitionSpec coarse = spec;
  coarse.kind = PartitionKind::sampled_triangles;  // the search uses weights, which samples give
  if (coarse.level > 1) {
    --coarse.level;
    ++coarse.sample_level;
  }
  coarse.sample_level = std::min(coarse.sample_level, coarse.level > 1 ? 1U : 2U);
  return coarse;
}

class Orderer {
 public:
  Orderer(const Mesh& mesh, const OrderOptions& options, const RunRecords& records)
      : mesh_(mesh), options_(options), records_(records), completion_(records) {
    if (options_.distances.empty()) options_.distances = default_distances();
    range_ = valid_range(options_.partition.kind, options_.distances);
  }

  OrderResult run() {
    if (std::optional<SimpleOrder> simple = find_simple_order(mesh_, bounding_sphere(mesh_), options_.facing))
      return simple_result(std::move(*simple));
    prepare();
    const Clustering clustering = without_unused_orders(cluster());
    result_.statistics.seconds.cluster = stage_.lap();
    complete(clustering, true);
    return finished();
  }

  OrderFrontier frontier(bool with_result) {
    if (options_.method != OrderMethod::budget)
      throw Error(ErrorKind::bad_argument,
                  "only the method budget has a curve of error against number of buffers");
    prepare();
    measure_psnr_ = true;
    ErrorBudgetOptions budget = error_budget_options();
    budget.min_buffers = 1;
    std::vector<ErrorBudgetResult> solutions = solve_every_number(coarse(), fine_, budget);
    result_.statistics.seconds.cluster = stage_.lap();

    OrderFrontier frontier;
    std::vector<OrderResult> completed;
    for (std::uint32_t k = 0; k < solutions.size(); ++k) {
      solutions[k].clustering = without_unused_orders(std::move(solutions[k].clustering));
      record(solutions[k]);
      completion_ = records_.part(std::to_string(k + 1).append("-orders"));
      // The error of a carried order can be measured only on the full mesh.
      if (upsampling_) {
        complete(solutions[k].clustering, k + 1 == solutions.size());
        completed.push_back(result_);
      }
      frontier.points.push_back(point(k + 1, solutions[k].clustering));
    }
    const ErrorTarget target = error_target(options_);
    keep_best(frontier.points, target);
    frontier.chosen = chosen_limit(frontier.points, target);
    frontier.knee = knee_limit(frontier.points, target);

    const std::uint32_t made = frontier.points[frontier.chosen - 1].request - 1;
    if (upsampling_) {
      result_ = std::move(completed[made]);
    } else {
      record(solutions[made]);
      completion_ = records_.part(std::to_string(made + 1).append("-orders"));
      if (with_result) complete(solutions[made].clustering, true);
    }
    OrderResult chosen = finished();
    frontier.statistics = chosen.statistics;
    if (with_result) frontier.result = std::move(chosen);
    return frontier;
  }

 private:
  // Makes the meshes that are ordered and searched, and their occlusion graphs.
  void prepare() {
    const std::uint32_t upsample_from =
        options_.upsample_from.value_or(mesh_.triangles.size() > kMostDirectTriangles ? kUpsampleFrom : 0);
    upsampling_ = upsample_from > 0 && upsample_from < mesh_.triangles.size();
    if (upsampling_) simplified_ = simplify(mesh_, upsample_from);

    fine_ =
        make_problem(ordered(), options_.partition, options_, tolerance_of(options_), records_.part("full"));
    if (needs_simpler_mesh(ordered())) simpler_ = simplify(ordered(), kCoarseTriangles);
    const Mesh& coarse_mesh = needs_simpler_mesh(ordered()) ? simpler_ : ordered();
    const PartitionSpec coarse_spec = coarse_partition(options_.partition);
    own_search_ = &coarse_mesh == &ordered() && coarse_spec == options_.partition;
    if (!own_search_) {
      coarse_ = make_problem(coarse_mesh, coarse_spec, options_, 0.0, records_.part("coarse"));
    }
    record_graph(fine_.graph);
    result_.statistics.seconds.graph = stage_.lap();
  }

  // Makes the result of a mesh that one order draws right from everywhere. Further buffers, if options ask
  // for them, would be the same.
  OrderResult simple_result(SimpleOrder simple) {
    result_.statistics.simple = true;
    result_.statistics.regions = 1;
    result_.statistics.triangles = mesh_.triangles.size();
    result_.statistics.measured_psnr = kPerfectPsnr;
    result_.orders.orders = {std::move(simple.front_to_back)};
    result_.orders.base_sequence = std::move(simple.base);
    describe(std::vector<std::uint32_t>(make_partition(options_.partition).cell_count(), 0));
    return finished();
  }

  [[nodiscard]] const Mesh& ordered() const { return upsampling_ ? simplified_ : mesh_; }
  [[nodiscard]] const OrderProblem& coarse() const { return own_search_ ? fine_ : coarse_; }

  // Makes the orders of the full mesh from the clusters. `last`: the graph is not needed afterwards and may
  // be freed.
  void complete(const Clustering& clustering, bool last) {
    result_.orders.orders = make_orders(fine_, clustering);
    begin_stage(options_.progress, "base order", 0);
    result_.orders.base_sequence =
        checkpointed(records_, "base-sequence", [&] { return base_order(mesh_, coarse()); });
    result_.statistics.seconds.sequence += stage_.lap();
    if (upsampling_) {
      if (last) fine_.graph = {};
      carry_over(ordered(), clustering.cluster_of);
      result_.statistics.seconds.refine += stage_.lap();
    }
    finish(clustering);
  }

  OrderResult finished() {
    result_.statistics.seconds.total = total_.lap();
    result_.statistics.peak_rss_bytes = peak_rss_bytes();
    return std::move(result_);
  }

  void record_graph(const OcclusionGraph& graph) {
    OrderStatistics& statistics = result_.statistics;
    statistics.triangles = mesh_.triangles.size();
    statistics.viewpoints = graph.viewpoint_count;
    statistics.edges_per_viewpoint =
        graph.viewpoint_count == 0 ? 0 : graph.viewpoint_edges / graph.viewpoint_count;
    for (const CompactRows& cell : graph.cells) statistics.edges_total += cell.edge_count();
    total_weight_ = graph.total_weight;
    statistics.intersecting_pairs = graph.intersecting;
    // The acyclic method counts these cells itself when it breaks their cycles.
    if (options_.method == OrderMethod::budget) statistics.cyclic_cells = count_cyclic_cells(graph);
  }

  Clustering cluster() {
    if (options_.method == OrderMethod::budget) {
      ErrorBudgetResult found = find_fewest_orders(coarse(), fine_, error_budget_options());
      record(found);
      return std::move(found.clustering);
    }
    Clustering clustering = cluster_acyclically(fine_, options_, result_.statistics, records_);
    result_.statistics.violated_weight = share_of_weight(clustering.cost);
    return clustering;
  }

  [[nodiscard]] ErrorBudgetOptions error_budget_options() const {
    ErrorBudgetOptions budget;
    budget.target = error_target(options_);
    // More buffers than cells would not be used.
    const std::uint32_t cells = fine_.partition.cell_count();
    budget.min_buffers = std::min(options_.min_buffers, cells);
    budget.max_buffers = std::min(options_.max_buffers, cells);
    budget.front_only = options_.facing == Facing::single;
    budget.range = range_;
    budget.image_alpha = measured_alpha();
    budget.seed = options_.seed;
    budget.progress = options_.progress;
    budget.records = records_;
    return budget;
  }

  // Returns the opacity of the images that the PSNR is measured on; 0: it is not measured.
  [[nodiscard]] double measured_alpha() const {
    return options_.min_psnr || measure_psnr_ ? image_alpha(options_) : 0;
  }

  void record(const ErrorBudgetResult& found) {
    record(found.measured);
    result_.statistics.iterations = found.clustering.rounds;
    result_.statistics.violated_weight = share_of_weight(found.clustering.cost);
  }
  void record(const OrderError& measured) {
    result_.statistics.measured_error = measured.ipr;
    result_.statistics.measured_psnr = measured.psnr;
    repaired_ = measured.repaired;
  }

  [[nodiscard]] double share_of_weight(double violated) const {
    return total_weight_ > 0 ? violated / total_weight_ : 0;
  }

  // Returns what was just recorded as a point of the curve.
  [[nodiscard]] FrontierPoint point(std::uint32_t request, const Clustering& clustering) const {
    OrderProblem full;
    full.mesh = &mesh_;
    full.sphere = bounding_sphere(mesh_);
    full.partition = make_partition(options_.partition);
    std::uint64_t listed = 0;
    for (std::uint32_t c = 0; c < clustering.cluster_count(); ++c) {
      const auto drawn =
          visible_nodes(full, cells_of_cluster(clustering.cluster_of, c), range_, options_.facing);
      listed += static_cast<std::uint64_t>(std::count(drawn.begin(), drawn.end(), 1));
    }
    FrontierPoint point;
    point.limit = point.request = request;
    point.buffers = clustering.cluster_count();
    point.ipr = result_.statistics.measured_error;
    point.psnr = result_.statistics.measured_psnr;
    point.repaired = repaired_;
    point.frame_time = verified_frame_time(repaired_);
    point.violated_weight = result_.statistics.violated_weight;
    point.memory_bytes = 3 * listed * bytes_per_index(mesh_.positions.size());
    return point;
  }

  // Returns the order of a cluster, and a lower bound of the weight that any order of it violates.
  [[nodiscard]] std::pair<NodeSequence, double> order_of_cluster(const OrderProblem& problem,
                                                                 const Clustering& clustering,
                                                                 std::uint32_t c) const {
    const std::vector<std::uint32_t> cells = cells_of_cluster(clustering.cluster_of, c);
    const std::vector<std::uint8_t> drawn = visible_nodes(problem, cells, range_, options_.facing);
    const std::vector<std::uint32_t>& ranks = clustering.ranks[c];
    const EdgeRows edges = sum_cells(problem.graph, cells);
    const double unavoidable = unavoidable_weight(edges, ranks);
    if (options_.cache_size == 0) return {order_by_rank(ranks, drawn), unavoidable};
    CacheOrderOptions sequence;
    sequence.method = options_.cache_method;
    sequence.cache_size = options_.cache_size;
    sequence.progress = options_.progress;
    if (options_.method == OrderMethod::budget) {
      sequence.least_binding = kLeastBindingWeight;
      sequence.slack = options_.cache_slack * static_cast<double>(cells.size());
    }
    return {cache_aware_order(*problem.mesh, edges, ranks, drawn, sequence), unavoidable};
  }

  std::vector<NodeSequence> make_orders(const OrderProblem& problem, const Clustering& clustering) {
    begin_stage(options_.progress, "sequences", clustering.cluster_count());
    std::vector<NodeSequence> sequences(clustering.cluster_count());
    std::vector<double> unavoidable(clustering.cluster_count(), 0.0);
    // The summed edges of one cluster may take some 100 MB, so only a few clusters are in work at a time.
    // Each range works on one cluster, and the simple partitioner makes the same few ranges for any number of
    // threads.
    const std::uint32_t at_once = problem.graph.spilled
                                      ? clustering.cluster_count()
                                      : (clustering.cluster_count() + kOrdersAtOnce - 1) / kOrdersAtOnce;
    parallel_ranges(
        std::uint32_t{0}, clustering.cluster_count(), at_once,
        [&](std::uint32_t begin, std::uint32_t end) {
          for (std::uint32_t c = begin; c < end; ++c) {
            stop_if_requested(options_.progress);
            std::tie(sequences[c], unavoidable[c]) =
                checkpointed(completion_, std::string("sequence-").append(std::to_string(c)),
                             [&] { return order_of_cluster(problem, clustering, c); });
            advance_stage(options_.progress, 1);
          }
        },
        Partitioner::simple);
    // The clusters cannot avoid any weight that their cells cannot avoid.
    OrderStatistics& statistics = result_.statistics;
    statistics.violated_floor = share_of_weight(unavoidable_in_cells(problem.graph, clustering));
    statistics.violated_bound =
        std::max(statistics.violated_floor,
                 share_of_weight(std::accumulate(unavoidable.begin(), unavoidable.end(), 0.0)));
    return sequences;
  }

  // Carries the orders of the simplified mesh over to the full one (section 5), and repairs them there.
  void carry_over(const Mesh& simplified, const std::vector<std::uint32_t>& cluster_of) {
    OrderProblem full;
    full.mesh = &mesh_;
    full.sphere = bounding_sphere(mesh_);
    full.partition = make_partition(options_.partition);
    std::vector<std::vector<std::uint32_t>> ranks = carried_ranks(full, simplified, cluster_of);

    RefineOptions refine;
    refine.rounds = options_.refine_rounds;
    refine.distances = options_.distances;
    refine.alpha = options_.alpha;
    refine.front_only = options_.facing == Facing::single;
    refine.progress = options_.progress;
    refine.records = completion_.part("repair");
    std::vector<EdgeRows> known;
    if (refine.rounds > 0) {
      known = refine_orders(mesh_, full.sphere, options_.partition, cluster_of, refine, ranks);
    }
    if (options_.method == OrderMethod::budget) {
      begin_stage(options_.progress, "wrong pixels", 0);
      ValidationOptions validation =
          held_out_viewpoints(range_, refine.front_only, options_.seed, options_.progress);
      validation.image_alpha = measured_alpha();
      record(checkpointed(completion_, "full-error", [&] {
        return measure_order_error(mesh_, full.sphere, full.partition, cluster_of, ranks, validation);
      }));
    }
    CacheOrderOptions sequence;
    sequence.method = options_.cache_method;
    sequence.cache_size = options_.cache_size;
    sequence.progress = options_.progress;
    begin_stage(options_.progress, "sequences", ranks.size());
    for (std::uint32_t c = 0; c < ranks.size(); ++c) {
      stop_if_requested(options_.progress);
      result_.orders.orders[c] =
          checkpointed(completion_, std::string("full-sequence-").append(std::to_string(c)), [&] {
            const std::vector<std::uint8_t> drawn =
                visible_nodes(full, cells_of_cluster(cluster_of, c), range_, options_.facing);
            return refine.rounds == 0 || options_.cache_size == 0
                       ? order_by_rank(ranks[c], drawn)
                       : windowed_sequence(mesh_, known[c], ranks[c], drawn, sequence);
          });
      advance_stage(options_.progress, 1);
    }
  }

  // Puts every node of the full mesh in the place of its nearest coarse node. Nodes with the same coarse node
  // are sorted by depth, which the repair starts from, or in cache order if there is no repair (as in the
  // paper).
  std::vector<std::vector<std::uint32_t>> carried_ranks(const OrderProblem& full, const Mesh& simplified,
                                                        const std::vector<std::uint32_t>& cluster_of) const {
    const std::vector<NodeId> parents = nearest_coarse_nodes(mesh_, simplified);
    std::vector<double> within(parents.size());
    if (options_.refine_rounds == 0) {
      const std::vector<std::uint32_t> positions = cache_positions(mesh_);
      for (NodeId node = 0; node < within.size(); ++node)
        within[node] = positions[triangle_of(node)] / static_cast<double>(positions.size());
    }
    std::vector<std::vector<std::uint32_t>> ranks;
    for (std::uint32_t c = 0; c < result_.orders.orders.size(); ++c) {
      if (options_.refine_rounds > 0) {
        within = depth_keys(mesh_, full.sphere, full.partition, cells_of_cluster(cluster_of, c));
      }
      std::vector<std::uint32_t> coarse = ranks_of(result_.orders.orders[c], simplified.triangles.size());
      // If a facing can be seen and its coarse node cannot, it takes the place of the coarse node's other
      // facing.
      for (NodeId node = 0; node < coarse.size(); ++node) {
        if (coarse[node] == kNoRank) coarse[node] = coarse[node ^ 1U];
      }
      ranks.push_back(ranks_by_key(upsampled_keys(parents, coarse, within)));
    }
    return ranks;
  }

  // Says what the orders are for. `cell_orders`: the order of every view cell.
  void describe(std::vector<std::uint32_t> cell_orders) {
    OrderSet& set = result_.orders;
    set.partition = options_.partition;
    set.sphere = bounding_sphere(mesh_);
    set.valid_from = range_.from;
    set.valid_to = range_.to;
    set.facing = options_.facing;
    set.cell_orders = std::move(cell_orders);
  }

  void finish(const Clustering& clustering) {
    describe(clustering.cluster_of);
    const OrderSet& set = result_.orders;
    const ViewPartition partition = make_partition(options_.partition);
    result_.statistics.regions = find_regions(partition, set.cell_orders).count;
    result_.statistics.switches_per_turn = switches_per_turn(partition, set.cell_orders);
  }

  const Mesh& mesh_;
  OrderOptions options_;
  RunRecords records_;
  RunRecords completion_;  // of the steps in complete()
  ValidRange range_{};
  Mesh simplified_, simpler_;   // for upsampling; for the search
  OrderProblem fine_, coarse_;  // coarse_ only if the search has a problem of its own
  bool upsampling_ = false, own_search_ = false;
  bool measure_psnr_ = false;  // although it is not the target
  double total_weight_ = 0;
  Stopwatch total_, stage_;
  OrderResult result_;
  double repaired_ = 0;  // OrderError::repaired of it
};

}  // namespace

std::vector<double> default_distances() {
  return {1.5, 3.0, kInfiniteDistance};
}

double image_alpha(const OrderOptions& options) {
  return options.alpha > 0 ? options.alpha : ShadingOptions{}.alpha;
}

CleanMesh clean_to_order(const Mesh& mesh, const CleanOptions& options, const std::string& name) {
  CleanMesh drawn = clean(mesh, options, name);
  if (drawn.mesh.triangles.empty())
    throw Error(ErrorKind::nothing_to_do, name + ": no triangle is left after cleaning");
  return drawn;
}

OrderResult order_mesh(const Mesh& mesh, const OrderOptions& options) {
  check_options(mesh, options);
  const RunRecords records(mesh, options);
  OrderResult result = checkpointed(records, "result", [&] {
    // The best number is known when all have been tried.
    if (options.least_frame_time) return *order_frontier(mesh, options, true).result;
    return Orderer(mesh, options, records).run();
  });
  records.remove_others("result");
  return result;
}

OrderFrontier order_frontier(const Mesh& mesh, const OrderOptions& options, bool with_result) {
  check_options(mesh, options);
  return Orderer(mesh, options, RunRecords(mesh, options).part("frontier")).frontier(with_result);
}

}  // namespace pellucid
