// Order a mesh, through the C interface.
#include <memory>

#include "c/callback_progress.h"
#include "c/handles.h"
#include "pellucid/metric.h"
#include "pellucid/overdraw.h"

namespace pellucid::c {
namespace {

OrderOptions order_options(const PellucidOrderOptions& given, Progress* progress) {
  OrderOptions options;
  require(given.method == pellucid_method_budget || given.method == pellucid_method_acyclic,
          "method: there is no such value");
  require(given.distances != nullptr || given.distance_count == 0, "distances is null");
  options.method = given.method == pellucid_method_acyclic ? OrderMethod::acyclic : OrderMethod::budget;
  options.facing = facing_from(given.facing);
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
  const Mesh mesh = mesh_from(given);
  CallbackProgress progress(options.run);
  const ThreadLimit threads(options.run.threads);
  const OrderOptions settled_options = order_options(options, progress.pointer());
  const CleanMesh drawn = clean(mesh, {}, "mesh");
  if (drawn.mesh.triangles.empty())
    throw Error(ErrorKind::nothing_to_do, "mesh: there is no triangle that draws anything");
  OrderResult result = order_mesh(drawn.mesh, settled_options);
  auto set = make_handle(lift_orders(std::move(result.orders), drawn.source), mesh);
  set->statistics.dropped_triangles = mesh.triangles.size() - drawn.mesh.triangles.size();
  set->statistics.measured_error = result.statistics.measured_error;
  set->statistics.violated_weight = result.statistics.violated_weight;
  set->statistics.seconds = result.statistics.seconds.total;
  return set;
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

KeyFrameTable key_frames(const PellucidPoses& poses, const OverdrawOrders& made) {
  KeyFrameTable table;
  table.times.assign(poses.times, poses.times + poses.frame_count);
  table.spheres = made.spheres;
  table.cell_orders = made.cell_orders;
  return table;
}

OrderSet as_order_set(const OverdrawOrders& made, const Mesh& mesh, const OverdrawOptions& options) {
  OrderSet set;
  set.purpose = OrderPurpose::overdraw;
  set.partition = {PartitionKind::viewpoints, options.view_level, 0};
  set.sphere = bounding_sphere(mesh);
  set.valid_from = 1;
  set.facing = Facing::single;
  set.base_sequence = made.sequence;
  set.patch_offsets = made.patch_offsets;
  for (std::uint32_t order = 0; order < made.orders.size(); ++order) {
    NodeSequence nodes;
    for (const std::uint32_t triangle : triangle_sequence(made, order))
      nodes.push_back(node_of(triangle, false));
    set.orders.push_back(std::move(nodes));
  }
  return set;
}

std::unique_ptr<PellucidOrderSet> overdraw(const PellucidMesh* given, const PellucidPoses* poses,
                                           const PellucidOverdrawOptions& options) {
  const Mesh mesh = mesh_from(given);
  OverdrawSubject subject;
  subject.triangles = mesh.triangles;
  if (facing_from(options.facing) == Facing::duplicated)
    subject.double_sided.assign(subject.triangles.size(), 1);
  subject.frames = frames_from(*given, poses);
  CallbackProgress progress(options.run);
  const ThreadLimit threads(options.run.threads);
  const OverdrawOptions settled_options = overdraw_options(options, progress.pointer());
  const OverdrawOrders made = order_overdraw(subject, settled_options);
  OrderSet orders = as_order_set(made, mesh, settled_options);
  if (poses == nullptr) {
    orders.cell_orders = made.cell_orders;
  } else {
    orders.animations.push_back(key_frames(*poses, made));
    subject.frames = {mesh.positions};  // at rest
    orders.cell_orders = cheapest_orders(subject, made, settled_options);
  }
  auto set = make_handle(std::move(orders), mesh);
  set->statistics.overdraw = made.run.training_overdraw;
  set->statistics.seconds = made.run.seconds.total;
  return set;
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
