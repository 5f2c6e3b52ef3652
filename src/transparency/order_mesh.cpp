// From a mesh to its in-depth buffers: see pellucid/transparency.h.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "pellucid/sequencing.h"
#include "pellucid/shading.h"
#include "pellucid/transparency.h"
#include "sequencing/cache_order.h"
#include "sequencing/edge_rows.h"
#include "transparency/base_sequence.h"
#include "transparency/cluster/acyclic.h"
#include "transparency/cluster/bounds.h"
#include "transparency/cluster/budget_search.h"
#include "transparency/cluster/contiguity.h"
#include "transparency/cluster/frontier.h"
#include "transparency/cluster/validation.h"
#include "transparency/order_problem.h"
#include "transparency/run_records.h"
#include "transparency/upsample/refine.h"
#include "transparency/upsample/upsample.h"

namespace pellucid {
namespace {

// The authors' slack for the acyclic method, bounding radii: without one, overlaps that no pixel shows forbid
// sharing.
constexpr double kAcyclicTolerance = 0.003;
// Above this many triangles the occlusion graph of S[2,2] takes many gigabytes and minutes: order a simpler
// mesh and upsample.
constexpr std::uint32_t kMostDirectTriangles = 24000;
constexpr std::uint32_t kUpsampleFrom = 10000;
// Edges that weigh less than this (square radii, mean over a cell's viewpoints) are below a hundredth of a
// pixel of a 1024 x 1024 picture. They are counted (pruned weight) but not kept.
constexpr float kLeastWeight = 3e-7F;
// A budget order's edges lighter than this are the first that its vertex-cache sequence may violate: the
// cell-averaged weight of about half a pixel of a 1024 x 1024 picture, summed over a cluster.
constexpr float kLeastBindingWeight = 1e-6F;

// Clusters whose sequences are made at the same time.
constexpr std::uint32_t kSequencesAtOnce = 4;

double tolerance_of(const OrderOptions& options) {
  if (options.tolerance >= 0) return options.tolerance;
  return options.method == OrderMethod::acyclic ? kAcyclicTolerance : 0.0;
}

void check_options(const Mesh& mesh, const OrderOptions& options) {
  const auto refuse = [](const std::string& reason) { throw Error(ErrorKind::bad_argument, reason); };
  if (mesh.triangles.empty()) throw Error(ErrorKind::nothing_to_do, "the mesh has no triangles to order");
  if (mesh.triangles.size() >= (std::uint64_t{1} << 30U)) refuse("the mesh has more than 2^30 triangles");
  for (const double distance : options.distances) {
    if (!(distance > 1.0))
      refuse("distances are in bounding radii and must be greater than 1, the sphere itself");
  }
  if (!(options.max_error >= 0)) refuse("the largest error must not be negative");
  if (options.least_frame_time && options.method != OrderMethod::budget)
    refuse("frame times choose a number of buffers by the method budget only");
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

// Which nodes some cell of a cluster can see, within the valid range of distances (never too few).
std::vector<std::uint8_t> visible_nodes(const OrderProblem& problem, const std::vector<std::uint32_t>& cells,
                                        const ValidRange& range, Facing facing) {
  const Mesh& mesh = *problem.mesh;
  std::vector<std::uint8_t> drawn(2 * mesh.triangles.size(), 0);
  parallel_loop(std::uint32_t{0}, static_cast<std::uint32_t>(mesh.triangles.size()), [&](std::uint32_t t) {
    const Vec3d normal = triangle_normal(mesh, t);
    const double offset =
        dot(normal, to_double(mesh.positions[mesh.triangles[t][0]]) - problem.sphere.center);
    const auto seen = [&](const Vec3d& n, double o) {
      return std::any_of(cells.begin(), cells.end(), [&](std::uint32_t cell) {
        return front_visible(problem.partition, cell, n, o, problem.sphere.radius, range.from, range.to);
      });
    };
    drawn[node_of(t, false)] = seen(normal, offset) ? 1 : 0;
    if (facing == Facing::duplicated) drawn[node_of(t, true)] = seen(-normal, -offset) ? 1 : 0;
  });
  return drawn;
}

// A mesh hardly larger than the coarse one is searched as it is.
bool has_simpler(const Mesh& mesh) {
  return mesh.triangles.size() > kCoarseTriangles * 3 / 2;
}

// Fewer cells of the same sampling density, for the search.
PartitionSpec coarse_partition(const PartitionSpec& spec) {
  if (!has_triangle_cells(spec)) return spec;
  PartitionSpec coarse = spec;
  coarse.kind = PartitionKind::sampled_triangles;  // the search goes by weights, which samples give
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
    prepare();
    const Clustering clustering = without_unused_orders(cluster());
    result_.statistics.seconds.cluster = stage_.lap();
    complete(clustering, true);
    return finished();
  }

  OrderFrontier frontier(bool with_result) {
    if (options_.method != OrderMethod::budget)
      throw Error(ErrorKind::bad_argument, "only the method budget has a frontier");
    prepare();
    measure_pictures_ = true;
    BudgetOptions budget = budget_options();
    budget.min_buffers = 1;
    std::vector<BudgetResult> solutions = solve_all_budgets(coarse(), fine_, budget);
    result_.statistics.seconds.cluster = stage_.lap();

    OrderFrontier frontier;
    std::vector<OrderResult> completed;
    for (std::uint32_t k = 0; k < solutions.size(); ++k) {
      solutions[k].clustering = without_unused_orders(std::move(solutions[k].clustering));
      record(solutions[k]);
      completion_ = records_.part(std::to_string(k + 1).append("-orders"));
      // Only the full mesh can say what a carried order is worth.
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
  // The meshes that are ordered and searched, and what hides what on them.
  void prepare() {
    const std::uint32_t upsample_from =
        options_.upsample_from.value_or(mesh_.triangles.size() > kMostDirectTriangles ? kUpsampleFrom : 0);
    upsampling_ = upsample_from > 0 && upsample_from < mesh_.triangles.size();
    if (upsampling_) simplified_ = simplify(mesh_, upsample_from);

    fine_ =
        make_problem(ordered(), options_.partition, options_, tolerance_of(options_), records_.part("full"));
    if (has_simpler(ordered())) simpler_ = simplify(ordered(), kCoarseTriangles);
    const Mesh& coarse_mesh = has_simpler(ordered()) ? simpler_ : ordered();
    const PartitionSpec coarse_spec = coarse_partition(options_.partition);
    own_search_ = &coarse_mesh == &ordered() && coarse_spec == options_.partition;
    if (!own_search_) {
      coarse_ = make_problem(coarse_mesh, coarse_spec, options_, 0.0, records_.part("coarse"));
    }
    record_graph(fine_.graph);
    result_.statistics.seconds.graph = stage_.lap();
  }

  [[nodiscard]] const Mesh& ordered() const { return upsampling_ ? simplified_ : mesh_; }
  [[nodiscard]] const OrderProblem& coarse() const { return own_search_ ? fine_ : coarse_; }

  // From clusters to sequences of the full mesh. `last`: the graph may go, nothing is completed after this.
  void complete(const Clustering& clustering, bool last) {
    result_.orders.orders = make_sequences(fine_, clustering);
    begin_stage(options_.progress, "base order", 0);
    result_.orders.base_sequence =
        checkpointed(records_, "base-sequence", [&] { return base_sequence(mesh_, coarse()); });
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
    // The acyclic method counts them itself as it breaks their cycles.
    if (options_.method == OrderMethod::budget) statistics.cyclic_cells = count_cyclic_cells(graph);
  }

  Clustering cluster() {
    if (options_.method == OrderMethod::budget) {
      BudgetResult found = search_budget(coarse(), fine_, budget_options());
      record(found);
      return std::move(found.clustering);
    }
    Clustering clustering = cluster_acyclically(fine_, options_, result_.statistics, records_);
    result_.statistics.violated_weight = share_of_weight(clustering.cost);
    return clustering;
  }

  [[nodiscard]] BudgetOptions budget_options() const {
    BudgetOptions budget;
    budget.target = error_target(options_);
    // More than one for each cell would be used by none.
    const std::uint32_t cells = fine_.partition.cell_count();
    budget.min_buffers = std::min(options_.min_buffers, cells);
    budget.max_buffers = std::min(options_.max_buffers, cells);
    budget.front_only = options_.facing == Facing::single;
    budget.range = range_;
    budget.picture_alpha = measured_alpha();
    budget.seed = options_.seed;
    budget.progress = options_.progress;
    budget.records = records_;
    return budget;
  }

  // Opacity of the pictures that the PSNR is measured on; 0: nobody asks for it.
  [[nodiscard]] double measured_alpha() const {
    return options_.min_psnr || measure_pictures_ ? picture_alpha(options_) : 0;
  }

  void record(const BudgetResult& found) {
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

  // What was just recorded, as a point of the frontier.
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

  // And the weight that any order of the cluster violates.
  [[nodiscard]] std::pair<NodeSequence, double> sequence_cluster(const OrderProblem& problem,
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

  std::vector<NodeSequence> make_sequences(const OrderProblem& problem, const Clustering& clustering) {
    begin_stage(options_.progress, "sequences", clustering.cluster_count());
    std::vector<NodeSequence> sequences(clustering.cluster_count());
    std::vector<double> unavoidable(clustering.cluster_count(), 0.0);
    // A few clusters at a time: the summed edges of one may take some 100 MB. Each range works on one of
    // them, and the simple partitioner makes the same few ranges for any number of threads.
    const std::uint32_t at_once =
        problem.graph.spilled ? clustering.cluster_count()
                              : (clustering.cluster_count() + kSequencesAtOnce - 1) / kSequencesAtOnce;
    parallel_ranges(
        std::uint32_t{0}, clustering.cluster_count(), at_once,
        [&](std::uint32_t begin, std::uint32_t end) {
          for (std::uint32_t c = begin; c < end; ++c) {
            stop_if_requested(options_.progress);
            std::tie(sequences[c], unavoidable[c]) =
                checkpointed(completion_, std::string("sequence-").append(std::to_string(c)),
                             [&] { return sequence_cluster(problem, clustering, c); });
            advance_stage(options_.progress, 1);
          }
        },
        Partitioner::simple);
    // What the cells cannot avoid, their clusters cannot either.
    OrderStatistics& statistics = result_.statistics;
    statistics.violated_floor = share_of_weight(unavoidable_in_cells(problem.graph, clustering));
    statistics.violated_bound =
        std::max(statistics.violated_floor,
                 share_of_weight(std::accumulate(unavoidable.begin(), unavoidable.end(), 0.0)));
    return sequences;
  }

  // From sequences of the simplified mesh to sequences of the full one (section 5), repaired there.
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
      validation.picture_alpha = measured_alpha();
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

  // Every node of the full mesh in the place of its nearest coarse node: among those that share one by depth,
  // which the repair starts from, or in cache order where there is no repair (the paper's form).
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
      // A facing that can be seen although its parent's cannot goes where the parent's other facing is.
      for (NodeId node = 0; node < coarse.size(); ++node) {
        if (coarse[node] == kNoRank) coarse[node] = coarse[node ^ 1U];
      }
      ranks.push_back(ranks_by_key(upsampled_keys(parents, coarse, within)));
    }
    return ranks;
  }

  void finish(const Clustering& clustering) {
    OrderSet& set = result_.orders;
    set.partition = options_.partition;
    set.sphere = bounding_sphere(mesh_);
    set.valid_from = range_.from;
    set.valid_to = range_.to;
    set.facing = options_.facing;
    set.cell_orders = clustering.cluster_of;
    const ViewPartition partition = make_partition(options_.partition);
    result_.statistics.regions = find_regions(partition, set.cell_orders).count;
    result_.statistics.switches_per_turn = switches_per_turn(partition, set.cell_orders);
  }

  const Mesh& mesh_;
  OrderOptions options_;
  RunRecords records_;
  RunRecords completion_;  // of what complete() does
  ValidRange range_{};
  Mesh simplified_, simpler_;   // of upsampling; of the search
  OrderProblem fine_, coarse_;  // coarse_ only if the search has a problem of its own
  bool upsampling_ = false, own_search_ = false;
  bool measure_pictures_ = false;  // PSNR although it is no target
  double total_weight_ = 0;
  Stopwatch total_, stage_;
  OrderResult result_;
  double repaired_ = 0;  // OrderError::repaired of it
};

}  // namespace

std::vector<double> default_distances() {
  return {1.5, 3.0, kInfiniteDistance};
}

double picture_alpha(const OrderOptions& options) {
  return options.alpha > 0 ? options.alpha : ShadingOptions{}.alpha;
}

ValidRange valid_range(PartitionKind kind, const std::vector<double>& distances) {
  const auto [least, most] = std::minmax_element(distances.begin(), distances.end());
  // All distances in between are known. A single one says as much as it does of samples.
  if (kind == PartitionKind::view_triangles && *least < *most) return {*least, *most};
  // From infinity the view of a finite camera differs by its perspective, 1 / distance.
  constexpr double kFarEnough = 8;
  if (std::isinf(*least)) return {kFarEnough, kInfiniteDistance};
  const double from = std::max(1.0, 2.0 / 3.0 * *least);
  if (kind == PartitionKind::view_regions) return {from, kInfiniteDistance};
  // Errors grow slowly with distance: 3 radii stand for the paper's 2 to 5.
  return {from, 5.0 / 3.0 * *most};
}

ValidRange solid_range(PartitionKind kind, const std::vector<double>& distances) {
  if (kind == PartitionKind::view_regions) return valid_range(kind, distances);
  const auto [least, most] = std::minmax_element(distances.begin(), distances.end());
  return {*least, *most};
}

OrderProblem make_problem(const Mesh& mesh, const PartitionSpec& partition, const OrderOptions& options,
                          double tolerance, const RunRecords& records) {
  OrderProblem problem;
  problem.mesh = &mesh;
  problem.sphere = bounding_sphere(mesh);
  problem.partition = make_partition(partition);
  GraphOptions graph;
  graph.distances = options.distances;
  graph.all_distances = partition.kind == PartitionKind::viewpoints || partition.sample_level == 0;
  graph.tolerance = tolerance;
  graph.least_weight = kLeastWeight;
  graph.source = options.occlusion;
  graph.raster_size = options.raster_size;
  graph.alpha = options.alpha;
  graph.front_only = options.facing == Facing::single;
  graph.memory = options.memory / 2;
  graph.progress = options.progress;
  const ValidRange solid = solid_range(partition.kind, options.distances);
  graph.solid_from = solid.from;
  graph.solid_to = solid.to;
  graph.records = records;
  problem.graph = build_occlusion_graph(mesh, problem.sphere, problem.partition, graph);
  return problem;
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
    // Which number is the best is known once all have been tried.
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
