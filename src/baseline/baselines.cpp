// Order sets and their rivals as ways of drawing a mesh, measured side by side: see pellucid/report.h.
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <numeric>

#include "baseline/contender.h"
#include "pellucid/baseline.h"

namespace pellucid {
namespace {

// Enough directions for a mean over the sphere; overdraw hardly varies with more.
constexpr std::uint32_t kMostOverdrawViewpoints = 100;

std::vector<std::uint32_t> stored_sequence(std::uint64_t triangle_count) {
  std::vector<std::uint32_t> sequence(triangle_count);
  std::iota(sequence.begin(), sequence.end(), 0U);
  return sequence;
}

std::uint64_t used_vertices(std::span<const std::uint32_t> indices) {
  std::vector<std::uint32_t> sorted(indices.begin(), indices.end());
  std::sort(sorted.begin(), sorted.end());
  return static_cast<std::uint64_t>(std::unique(sorted.begin(), sorted.end()) - sorted.begin());
}

Contender single_sequence(const Mesh& mesh, const std::string& name, std::vector<std::uint32_t> triangles,
                          std::uint32_t cache_size) {
  auto ranks = std::make_shared<const std::vector<std::uint32_t>>(
      ranks_of_triangles(triangles, mesh.triangles.size()));
  auto nodes = std::make_shared<const NodeSequence>(front_nodes(triangles));
  Contender contender;
  contender.report = cache_report(mesh, std::span(nodes.get(), 1), MethodKind::baseline, cache_size);
  contender.report.triangles_submitted = static_cast<double>(nodes->size());
  contender.method = {name, [ranks](const Viewpoint&) { return *ranks; }};
  contender.sequence = [nodes](const Viewpoint&) { return std::span<const NodeId>(*nodes); };
  return contender;
}

// Of the order of a view cell; cells cover about the same part of the sphere.
double mean_length(const OrderSet& orders) {
  double sum = 0;
  for (const std::uint32_t order : orders.cell_orders)
    sum += static_cast<double>(orders.orders[order].size());
  return orders.cell_orders.empty() ? 0 : sum / static_cast<double>(orders.cell_orders.size());
}

Contender order_set(const MeasureSubject& subject, std::uint32_t cache_size) {
  const Mesh* mesh = subject.mesh;
  const OrderSet* orders = subject.orders;
  Contender contender;
  contender.report = cache_report(*mesh, orders->orders, MethodKind::orders, cache_size);
  contender.report.auxiliary_bytes = cell_table_bytes(orders->partition, orders->orders.size());
  contender.report.triangles_submitted = mean_length(*orders);
  contender.frame_work = selection_work(*orders);
  contender.method = {subject.label,
                      [mesh, orders](const Viewpoint& view) { return ranks_from(*mesh, *orders, view); }};
  contender.sequence = [orders](const Viewpoint& view) {
    return std::span<const NodeId>(orders->orders[select_order(*orders, view.direction)]);
  };
  return contender;
}

Contender cache_optimized(const Mesh& mesh, std::uint32_t cache_size) {
  const Stopwatch watch;
  std::vector<std::uint32_t> sequence = cache_optimized_sequence(mesh);
  const double seconds = watch.seconds();
  Contender contender = single_sequence(mesh, "cache_optimized", std::move(sequence), cache_size);
  contender.report.build_seconds = seconds;
  return contender;
}

// Every buffer of an order set, its nodes in the order that suits the vertex cache alone.
Contender cache_optimized_twins(const Mesh& mesh, const OrderSet& orders, std::uint32_t cache_size) {
  auto optimized = std::make_shared<OrderSet>(orders);
  for (NodeSequence& sequence : optimized->orders) sequence = cache_optimized_nodes(mesh, sequence);
  Contender contender;
  contender.report = cache_report(mesh, optimized->orders, MethodKind::baseline, cache_size);
  contender.report.auxiliary_bytes = cell_table_bytes(optimized->partition, optimized->orders.size());
  contender.report.triangles_submitted = mean_length(*optimized);
  contender.frame_work = selection_work(*optimized);
  const Mesh* drawn = &mesh;
  contender.method = {"cache_optimized_twins", [drawn, optimized](const Viewpoint& view) {
                        return ranks_from(*drawn, *optimized, view);
                      }};
  contender.sequence = [optimized](const Viewpoint& view) {
    return std::span<const NodeId>(optimized->orders[select_order(*optimized, view.direction)]);
  };
  return contender;
}

// Presorted lists get the samples that the order set had, where its cells are triangles.
PresortedOptions presorted_options(const OrderSet* orders, std::uint32_t cache_size, Progress* progress) {
  PresortedOptions options;
  if (orders != nullptr) {
    options.facing = orders->facing;
    if (has_triangle_cells(orders->partition)) {
      options.partition = orders->partition;
      options.partition.kind = PartitionKind::sampled_triangles;
    }
  }
  options.cache_size = cache_size;
  options.progress = progress;
  return options;
}

// Quality and overdraw of contenders that share a mesh; every frame is rasterised once for all of them.
void measure_on(const Mesh& mesh, Facing facing, std::span<Contender> contenders,
                const MeasureSettings& settings, Progress* progress) {
  if (contenders.empty()) return;
  MeasureOptions options;
  options.viewpoints = settings.viewpoints;
  options.min_distance = settings.min_distance;
  options.max_distance = settings.max_distance;
  options.size = settings.size;
  options.seed = settings.seed;
  options.facing = facing;
  options.shading.alpha = settings.alpha;
  options.progress = progress;
  std::vector<DrawingMethod> methods;
  for (const Contender& contender : contenders) methods.push_back(contender.method);
  std::vector<MethodQuality> qualities = measure_order_quality(mesh, methods, options);

  const std::vector<Viewpoint> viewpoints =
      random_viewpoints(settings.viewpoints, settings.min_distance, settings.max_distance, settings.seed);
  const std::span<const Viewpoint> first = std::span(viewpoints).first(overdraw_viewpoints(settings));
  begin_stage(progress, "overdraw", contenders.size());
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    stop_if_requested(progress);
    contenders[i].report.quality = std::move(qualities[i]);
    contenders[i].report.nanoseconds_per_frame = nanoseconds_per_frame(contenders[i].frame_work, viewpoints);
    if (contenders[i].sequence) {
      contenders[i].report.overdraw =
          measure_overdraw(mesh, first, settings.size, contenders[i].sequence).overdraw;
    }
    advance_stage(progress, 1);
  }
}

void append_reports(std::vector<MethodReport>& reports, std::span<Contender> contenders) {
  for (Contender& contender : contenders) reports.push_back(std::move(contender.report));
}

}  // namespace

std::uint64_t bytes_of_indices(const Mesh& mesh, std::uint64_t triangles) {
  return triangles * 3 * bytes_per_index(mesh.positions.size());
}

NodeSequence front_nodes(std::span<const std::uint32_t> triangles) {
  NodeSequence nodes(triangles.size());
  std::transform(triangles.begin(), triangles.end(), nodes.begin(),
                 [](std::uint32_t triangle) { return node_of(triangle, false); });
  return nodes;
}

MethodReport cache_report(const Mesh& mesh, std::span<const NodeSequence> sequences, MethodKind kind,
                          std::uint32_t cache_size) {
  MethodReport report;
  report.kind = kind;
  report.buffers = static_cast<std::uint32_t>(sequences.size());
  const auto statistics = [&](CacheModel model, std::uint32_t size) {
    std::vector<BufferStatistics> buffers;
    for (const NodeSequence& sequence : sequences) {
      buffers.push_back(sequence_statistics(mesh, sequence, model, size));
    }
    return pooled(buffers);
  };
  std::uint64_t vertices = 0;
  for (const NodeSequence& sequence : sequences) vertices += used_vertices(index_buffer(mesh, sequence));
  report.fifo = statistics(CacheModel::fifo, cache_size);
  report.acmr_lru = statistics(CacheModel::lru, cache_size).acmr;
  for (std::size_t i = 0; i < kReportedCaches.size(); ++i) {
    report.acmr_by_cache[i] = statistics(kReportedCaches[i].model, kReportedCaches[i].size).acmr;
  }
  report.atvr = vertices == 0 ? 0 : static_cast<double>(report.fifo.misses) / static_cast<double>(vertices);
  report.memory_bytes = bytes_of_indices(mesh, report.fifo.triangles);
  return report;
}

std::vector<std::uint32_t> ranks_of_triangles(std::span<const std::uint32_t> sequence,
                                              std::uint64_t triangle_count) {
  std::vector<std::uint32_t> ranks(2 * triangle_count, kNoRank);
  std::uint32_t next = 0;
  for (const std::uint32_t triangle : sequence) {
    ranks[node_of(triangle, false)] = next++;
    ranks[node_of(triangle, true)] = next++;
  }
  return ranks;
}

std::vector<std::uint32_t> ranks_as_stored(std::uint64_t triangle_count) {
  std::vector<std::uint32_t> sequence = stored_sequence(triangle_count);
  std::reverse(sequence.begin(), sequence.end());
  return ranks_of_triangles(sequence, triangle_count);
}

std::vector<std::uint32_t> ranks_from(const Mesh& mesh, const OrderSet& orders, const Viewpoint& viewpoint) {
  if (viewpoint.distance < orders.valid_from && !orders.base_sequence.empty()) {
    return ranks_of_triangles(orders.base_sequence, mesh.triangles.size());
  }
  return ranks_of(orders.orders[select_order(orders, viewpoint.direction)], mesh.triangles.size());
}

NodeSequence cache_optimized_nodes(const Mesh& mesh, const NodeSequence& nodes) {
  if (nodes.empty()) return {};
  const std::vector<std::uint32_t> indices = index_buffer(mesh, nodes);
  std::vector<std::uint32_t> optimized(indices.size());
  meshopt_optimizeVertexCache(optimized.data(), indices.data(), indices.size(), mesh.positions.size());

  // meshoptimizer moves triangles without turning them: find each again by its corners, copies in file order.
  std::multimap<Triangle, NodeId> by_corners;
  for (const NodeId node : nodes) by_corners.emplace(corners_of(mesh, node), node);
  NodeSequence sequence;
  sequence.reserve(nodes.size());
  for (std::size_t i = 0; i < optimized.size(); i += 3) {
    const auto found = by_corners.find({optimized[i], optimized[i + 1], optimized[i + 2]});
    if (found == by_corners.end()) throw Error(ErrorKind::internal, "vertex cache order lost a triangle");
    sequence.push_back(found->second);
    by_corners.erase(found);
  }
  return sequence;
}

std::vector<std::uint32_t> cache_optimized_sequence(const Mesh& mesh) {
  std::vector<std::uint32_t> triangles = stored_sequence(mesh.triangles.size());
  const NodeSequence nodes = cache_optimized_nodes(mesh, front_nodes(triangles));
  std::transform(nodes.begin(), nodes.end(), triangles.begin(), triangle_of);
  return triangles;
}

std::span<const std::string_view> baseline_names() {
  static constexpr std::array<std::string_view, 7> kNames{
      "original", "base", "cache_optimized", "cache_optimized_twins", "centroid_sort", "dptl", "bsp"};
  return kNames;
}

Baselines parse_baselines(const std::string& text) {
  if (text == "all") return {true, true, true, true, true};
  Baselines chosen{false, false, false, false, false};
  if (text == "none") return chosen;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    begin = end + 1;
    bool* flag = name == "base"              ? &chosen.base
                 : name == "cache_optimized" ? &chosen.cache_optimized
                 : name == "centroid_sort"   ? &chosen.centroid_sort
                 : name == "bsp"             ? &chosen.bsp
                 : name == "dptl"            ? &chosen.dptl
                                             : nullptr;
    if (flag == nullptr) {
      throw Error(ErrorKind::bad_argument, "baselines: '" + name +
                                               "' is none of base, cache_optimized, centroid_sort, bsp, dptl "
                                               "(or all, none for the whole list)");
    }
    *flag = true;
  }
  return chosen;
}

std::uint32_t overdraw_viewpoints(const MeasureSettings& settings) {
  return std::min(settings.viewpoints, kMostOverdrawViewpoints);
}

PrimitiveMeasureReport measure_subjects(std::span<const MeasureSubject> subjects, const Mesh* original,
                                        const std::string& name, const MeasureSettings& settings,
                                        Progress* progress) {
  const MeasureSubject& main = subjects.front();
  const Mesh& mesh = *main.mesh;
  const Facing facing = main.orders != nullptr ? main.orders->facing : Facing::duplicated;
  PrimitiveMeasureReport report;
  report.name = name;
  report.triangles = mesh.triangles.size();
  report.vertices = mesh.positions.size();

  // The first mesh, with its order set and the rivals that need no other mesh.
  std::vector<Contender> shared;
  if (main.orders != nullptr) shared.push_back(order_set(main, settings.cache_size));
  const std::size_t order_sets = shared.size();
  const Baselines& wanted = settings.baselines;
  const std::vector<Viewpoint> viewpoints =
      random_viewpoints(settings.viewpoints, settings.min_distance, settings.max_distance, settings.seed);
  if (wanted.base && main.orders != nullptr && !main.orders->base_sequence.empty()) {
    shared.push_back(single_sequence(mesh, "base", main.orders->base_sequence, settings.cache_size));
  }
  if (wanted.cache_optimized) {
    shared.push_back(cache_optimized(mesh, settings.cache_size));
    if (main.orders != nullptr) {
      shared.push_back(cache_optimized_twins(mesh, *main.orders, settings.cache_size));
    }
  }
  if (wanted.centroid_sort) shared.push_back(centroid_sort(mesh, viewpoints, settings.cache_size));
  if (wanted.dptl) {
    const PresortedOptions options = presorted_options(main.orders, settings.cache_size, progress);
    if (auto lists = presorted_lists(mesh, options, viewpoints, report.notes))
      shared.push_back(std::move(*lists));
  }
  measure_on(mesh, facing, shared, settings, progress);

  // Further files and the original order draw meshes of their own: the same surface, triangles in another
  // order.
  append_reports(report.methods, std::span(shared).first(order_sets));
  for (const MeasureSubject& subject : subjects.subspan(1)) {
    if (subject.orders == nullptr) continue;
    Contender contender = order_set(subject, settings.cache_size);
    measure_on(*subject.mesh, subject.orders->facing, std::span(&contender, 1), settings, progress);
    report.methods.push_back(std::move(contender.report));
  }
  if (original != nullptr) {
    const std::uint64_t triangles = original->triangles.size();
    Contender contender =
        single_sequence(*original, "original", stored_sequence(triangles), settings.cache_size);
    contender.method.ranks = [triangles](const Viewpoint&) { return ranks_as_stored(triangles); };
    measure_on(*original, facing, std::span(&contender, 1), settings, progress);
    report.methods.push_back(std::move(contender.report));
  }
  append_reports(report.methods, std::span(shared).subspan(order_sets));
  if (wanted.bsp) {
    if (auto walk = bsp_walk(mesh, viewpoints, settings.cache_size, progress, report.notes)) {
      const std::shared_ptr<const Mesh> pieces = walk->mesh;
      measure_on(*pieces, facing, std::span(&*walk, 1), settings, progress);
      report.methods.push_back(std::move(walk->report));
    }
  }
  return report;
}

}  // namespace pellucid
