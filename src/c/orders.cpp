// Implements the functions of the C interface that make orders of meshes and return their contents. In: what
// C passes. Out: handles of order sets, and their indices, selectors and statistics.
#include <memory>

#include "c/wrapper.h"
#include "pellucid/runtime/select.h"

namespace pellucid::c {
namespace {

OrderOptions order_options(const PellucidOrderOptions& given, Progress* progress) {
  OrderOptions options;
  require(given.method == pellucid_method_budget || given.method == pellucid_method_acyclic,
          "method: there is no such value");
  require(given.distances != nullptr || given.distance_count == 0, "distances is null");
  options.method = given.method == pellucid_method_acyclic ? OrderMethod::acyclic : OrderMethod::budget;
  options.facing = facing_of(given.facing);
  if (given.views != nullptr) options.partition = parse_partition(given.views);
  if (given.distances != nullptr)
    options.distances.assign(given.distances, given.distances + given.distance_count);
  options.max_error = given.max_error;
  options.max_buffers = given.max_buffers;
  options.min_buffers = given.min_buffers;
  options.tolerance = given.tolerance;
  options.alpha = given.alpha;
  options.cache_size = given.cache_size;
  if (given.upsample_from != UINT32_MAX) options.upsample_from = given.upsample_from;
  options.memory = given.memory;
  options.seed = given.seed;
  options.progress = progress;
  return options;
}

std::unique_ptr<PellucidOrderSet> order(const PellucidMesh* given, const PellucidOrderOptions& options) {
  const Mesh mesh = copy_mesh(view_of(given));
  CallbackProgress progress(options.run);
  const ThreadLimit threads(options.run.threads);
  return std::make_unique<PellucidOrderSet>(
      PellucidOrderSet{order_any_mesh(mesh, order_options(options, progress.pointer()))});
}

OverdrawOptions overdraw_options(const PellucidOverdrawOptions& given, Progress* progress) {
  require(given.method == pellucid_overdraw_refined || given.method == pellucid_overdraw_paper,
          "method: there is no such value");
  OverdrawOptions options;
  options.method = given.method == pellucid_overdraw_paper ? OverdrawMethod::paper : OverdrawMethod::refined;
  options.buffers = given.buffers;
  options.lambda = given.lambda;
  options.cache_size = given.cache_size;
  options.view_level = given.view_level;
  options.min_distance = given.min_distance;
  options.max_distance = given.max_distance;
  options.size = given.size;
  options.seed = given.seed;
  options.progress = progress;
  return options;
}

std::unique_ptr<PellucidOrderSet> overdraw(const PellucidMesh* given, const PellucidPoses* poses,
                                           const PellucidOverdrawOptions& options) {
  const MeshView mesh = view_of(given);
  const std::vector<Pose> frames = poses_of(*given, poses);
  CallbackProgress progress(options.run);
  const ThreadLimit threads(options.run.threads);
  return std::make_unique<PellucidOrderSet>(PellucidOrderSet{reduce_overdraw(
      mesh, overdraw_options(options, progress.pointer()), frames, facing_of(options.facing))});
}

// ---------------------------------------------------------------------------------- contents of an order set

// Writes the fallback. Unlike the fallback of OrderedMesh, it contains every triangle once, as it is stored.
template <class Index>
void copy_fallback(const OrderedMesh& mesh, SortDirection direction, Index* to) {
  std::vector<std::uint32_t> triangles = mesh.orders().base_sequence;
  // Base orders for transparency are stored back to front; those for overdraw are only drawn front to back.
  if (mesh.orders().purpose == OrderPurpose::transparency && direction == SortDirection::front_to_back)
    std::reverse(triangles.begin(), triangles.end());
  for (const std::uint32_t triangle : triangles) {
    for (const std::uint32_t index : mesh.triangles()[triangle]) *to++ = static_cast<Index>(index);
  }
}

std::uint64_t index_count(const OrderedMesh& mesh, std::uint32_t order) {
  if (order == PELLUCID_NO_ORDER) return 3 * std::uint64_t{mesh.orders().base_sequence.size()};
  return order < mesh.order_count() ? mesh.index_count({order, false}) : 0;
}

template <class Index>
void copy_indices(const OrderedMesh& mesh, std::uint32_t order, SortDirection direction, Index* to) {
  if (order == PELLUCID_NO_ORDER) {
    copy_fallback(mesh, direction, to);
  } else {
    mesh.copy_indices({order, false}, direction, std::span(to, mesh.index_count({order, false})));
  }
}

void copy_indices(const OrderedMesh& mesh, std::uint32_t order, PellucidDirection given,
                  std::uint32_t index_bytes, void* destination) {
  require(index_bytes == 2 || index_bytes == 4, "index_bytes must be 2 or 4");
  require(index_bytes == 4 || bytes_per_index(mesh.vertex_count()) == 2,
          "2-byte indices allow at most 65,535 vertices");
  require(given == pellucid_front_to_back || given == pellucid_back_to_front,
          "direction: there is no such value");
  require(given == pellucid_front_to_back || mesh.orders().purpose == OrderPurpose::transparency,
          "overdraw orders are drawn front to back only");
  require(order < mesh.order_count() || order == PELLUCID_NO_ORDER, "there is no such order");
  require(destination != nullptr || index_count(mesh, order) == 0, "destination is null");
  const SortDirection direction =
      given == pellucid_back_to_front ? SortDirection::back_to_front : SortDirection::front_to_back;
  if (index_bytes == 2) {
    copy_indices(mesh, order, direction, static_cast<std::uint16_t*>(destination));
  } else {
    copy_indices(mesh, order, direction, static_cast<std::uint32_t*>(destination));
  }
}

PellucidOrderStatistics statistics_of(const OrderedMesh& mesh) {
  const OrderedMeshReport& report = mesh.report();
  PellucidOrderStatistics statistics{};
  statistics.triangles = mesh.triangles().size();
  statistics.dropped_triangles = report.dropped;
  for (std::uint32_t order = 0; order < mesh.order_count(); ++order)
    statistics.index_bytes += mesh.index_count({order, false}) * bytes_per_index(mesh.vertex_count());
  statistics.measured_error = report.measured_error.value_or(-1);
  statistics.violated_weight = report.violated_weight;
  statistics.overdraw = report.overdraw;
  statistics.seconds = report.seconds;
  return statistics;
}

}  // namespace
}  // namespace pellucid::c

using namespace pellucid::c;  // NOLINT(google-build-using-namespace): below are C functions

void pellucid_order_options_init(PellucidOrderOptions* options, size_t struct_size) {
  const pellucid::OrderOptions defaults;
  PellucidOrderOptions set{};
  set.struct_size = struct_size;
  set.max_error = defaults.max_error;
  set.max_buffers = defaults.max_buffers;
  set.min_buffers = defaults.min_buffers;
  set.tolerance = defaults.tolerance;
  set.alpha = defaults.alpha;
  set.cache_size = defaults.cache_size;
  set.upsample_from = UINT32_MAX;
  set.seed = defaults.seed;
  if (options != nullptr) copy_out(set, options, struct_size);
}

void pellucid_overdraw_options_init(PellucidOverdrawOptions* options, size_t struct_size) {
  const pellucid::OverdrawOptions defaults;
  PellucidOverdrawOptions set{};
  set.struct_size = struct_size;
  set.facing = pellucid_facing_single;
  set.buffers = defaults.buffers;
  set.lambda = defaults.lambda;
  set.cache_size = defaults.cache_size;
  set.view_level = defaults.view_level;
  set.min_distance = defaults.min_distance;
  set.max_distance = defaults.max_distance;
  set.size = defaults.size;
  set.seed = defaults.seed;
  if (options != nullptr) copy_out(set, options, struct_size);
}

PellucidStatus pellucid_order_mesh(const PellucidMesh* mesh, const PellucidOrderOptions* options,
                                   PellucidOrderSet** orders) {
  return guarded([&] {
    require(orders != nullptr, "orders is null");
    *orders = nullptr;
    *orders = order(mesh, settled(options, pellucid_order_options_init)).release();
  });
}

PellucidStatus pellucid_overdraw_mesh(const PellucidMesh* mesh, const PellucidPoses* poses,
                                      const PellucidOverdrawOptions* options, PellucidOrderSet** orders) {
  return guarded([&] {
    require(orders != nullptr, "orders is null");
    *orders = nullptr;
    *orders = overdraw(mesh, poses, settled(options, pellucid_overdraw_options_init)).release();
  });
}

void pellucid_free_order_set(PellucidOrderSet* orders) {
  delete orders;
}

uint32_t pellucid_order_count(const PellucidOrderSet* orders) {
  return orders == nullptr ? 0 : orders->mesh.order_count();
}

uint64_t pellucid_order_index_count(const PellucidOrderSet* orders, uint32_t order) {
  return orders == nullptr ? 0 : index_count(orders->mesh, order);
}

PellucidStatus pellucid_copy_order_indices(const PellucidOrderSet* orders, uint32_t order,
                                           PellucidDirection direction, uint32_t index_bytes,
                                           void* destination) {
  return guarded([&] {
    require(orders != nullptr, "orders is null");
    copy_indices(orders->mesh, order, direction, index_bytes, destination);
  });
}

PellucidStatus pellucid_order_selector(const PellucidOrderSet* orders, PellucidOrders* selector) {
  return guarded([&] {
    require(orders != nullptr && selector != nullptr, "orders or selector is null");
    *selector = orders->mesh.selector();
  });
}

PellucidStatus pellucid_order_keyframes(const PellucidOrderSet* orders, PellucidKeyframes* keyframes) {
  return guarded([&] {
    require(orders != nullptr && keyframes != nullptr, "orders or keyframes is null");
    const bool one = orders->mesh.orders().animations.size() == 1;
    *keyframes = one ? orders->mesh.keyframes() : PellucidKeyframes{};
  });
}

PellucidStatus pellucid_order_statistics(const PellucidOrderSet* orders, PellucidOrderStatistics* statistics,
                                         size_t struct_size) {
  return guarded([&] {
    require(orders != nullptr && statistics != nullptr, "orders or statistics is null");
    copy_out(statistics_of(orders->mesh), statistics, struct_size);
  });
}
