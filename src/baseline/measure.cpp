// Implements measure_subjects() of pellucid/baseline.h: measures the quality, the overdraw and the CPU time
// per frame of order sets and their baselines.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/platform/platform.h"
#include "baseline/measured_method.h"
#include "pellucid/baseline.h"

namespace pellucid {
namespace {

// Overdraw hardly varies with more directions.
constexpr std::uint32_t kMostOverdrawViewpoints = 100;

constexpr std::size_t kTimedViewpoints = 32;
constexpr double kLeastPassSeconds = 2e-3;  // far above the clock's own cost
constexpr double kLeastPassSteps = 20;      // of the clock; on Windows they are long
constexpr int kPasses = 5;

// Returns options with which presorted lists get the same samples as the order set, if its cells are
// triangles.
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

// Measures methods that share a mesh. Every frame is rasterised once for all of them.
void measure_on(const Mesh& mesh, Facing facing, std::span<MeasuredMethod> measured,
                const MeasureSettings& settings, Progress* progress) {
  if (measured.empty()) return;
  MeasureOptions options;
  static_cast<MeasuredViews&>(options) = settings;
  options.facing = facing;
  options.shading.alpha = settings.alpha;
  options.progress = progress;
  std::vector<DrawingMethod> methods;
  for (const MeasuredMethod& method : measured) methods.push_back(method.drawing);
  std::vector<MethodQuality> qualities = measure_order_quality(mesh, methods, options);

  const std::vector<Viewpoint> viewpoints =
      random_viewpoints(settings.viewpoints, settings.min_distance, settings.max_distance, settings.seed);
  const std::span<const Viewpoint> first = std::span(viewpoints).first(overdraw_viewpoints(settings));
  begin_stage(progress, "overdraw", measured.size());
  for (std::size_t i = 0; i < measured.size(); ++i) {
    stop_if_requested(progress);
    measured[i].report.quality = std::move(qualities[i]);
    measured[i].report.nanoseconds_per_frame = nanoseconds_per_frame(measured[i].frame_work, viewpoints);
    if (measured[i].order) {
      measured[i].report.overdraw = measure_overdraw(mesh, first, settings.size, measured[i].order).overdraw;
    }
    advance_stage(progress, 1);
  }
}

void append_reports(std::vector<MethodReport>& reports, std::span<MeasuredMethod> methods) {
  for (MeasuredMethod& method : methods) reports.push_back(std::move(method.report));
}

}  // namespace

double nanoseconds_per_frame(const std::function<std::uint64_t(const Viewpoint&)>& work,
                             std::span<const Viewpoint> viewpoints) {
  if (!work || viewpoints.empty()) return 0;
  const std::span<const Viewpoint> timed = viewpoints.first(std::min(viewpoints.size(), kTimedViewpoints));
  volatile std::uint64_t sink = 0;  // without it, the compiler may remove the work
  const auto pass = [&](std::uint64_t repetitions) {
    const double start = platform::thread_cpu_seconds();
    for (std::uint64_t r = 0; r < repetitions; ++r) {
      for (const Viewpoint& view : timed) sink = sink + work(view);
    }
    return platform::thread_cpu_seconds() - start;
  };
  const double least_pass =
      std::max(kLeastPassSeconds, kLeastPassSteps * platform::thread_cpu_step_seconds());
  std::uint64_t repetitions = 1;
  double least = pass(repetitions);  // also warms the caches
  while (least < least_pass && repetitions < (std::uint64_t{1} << 30U)) {
    repetitions *= 2;
    least = pass(repetitions);
  }
  for (int i = 1; i < kPasses; ++i) least = std::min(least, pass(repetitions));
  return 1e9 * least / static_cast<double>(repetitions * timed.size());
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

  // The first mesh, with its order set and the baselines that draw the same mesh.
  std::vector<MeasuredMethod> shared;
  if (main.orders != nullptr) shared.push_back(order_set_method(main, settings.cache_size));
  const std::size_t order_sets = shared.size();
  const Baselines& wanted = settings.baselines;
  const std::vector<Viewpoint> viewpoints =
      random_viewpoints(settings.viewpoints, settings.min_distance, settings.max_distance, settings.seed);
  if (wanted.base && main.orders != nullptr && !main.orders->base_sequence.empty()) {
    shared.push_back(single_order_method(mesh, "base", main.orders->base_sequence, settings.cache_size));
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

  // Further files and the original order draw meshes of their own. These have the same surface, with
  // triangles in another order.
  append_reports(report.methods, std::span(shared).first(order_sets));
  for (const MeasureSubject& subject : subjects.subspan(1)) {
    if (subject.orders == nullptr) continue;
    MeasuredMethod method = order_set_method(subject, settings.cache_size);
    measure_on(*subject.mesh, subject.orders->facing, std::span(&method, 1), settings, progress);
    report.methods.push_back(std::move(method.report));
  }
  if (original != nullptr) {
    MeasuredMethod method = stored_order_method(*original, settings.cache_size);
    measure_on(*original, facing, std::span(&method, 1), settings, progress);
    report.methods.push_back(std::move(method.report));
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
