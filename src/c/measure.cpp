// Implements the functions of the C interface that measure orders: vertex cache, blending and overdraw. In:
// what C passes. Out: structures with ratios.
#include <numeric>

#include "c/wrapper.h"
#include "pellucid/metric.h"
#include "pellucid/runtime/select.h"

namespace pellucid::c {
namespace {

void require_made_for(const PellucidOrderSet* set, const Mesh& mesh) {
  require(set == nullptr || (set->mesh.triangles().size() == mesh.triangles.size() &&
                             set->mesh.vertex_count() == mesh.positions.size()),
          "the orders are not of this mesh");
}

// Returns the order that select.h chooses for a direction.
std::uint32_t order_for(const PellucidOrders& selector, const Vec3d& direction) {
  const double d[3] = {direction.x, direction.y, direction.z};
  return pellucid_order_of_cell(&selector, pellucid_find_cell(&selector, d));
}

// Returns the ranks of both facings of triangles that are listed back to front.
std::vector<std::uint32_t> ranks_from_back(const std::vector<std::uint32_t>& triangles, std::size_t count) {
  std::vector<std::uint32_t> ranks(2 * count, kNoRank);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto rank = static_cast<std::uint32_t>(triangles.size() - 1 - i);
    ranks[node_of(triangles[i], false)] = ranks[node_of(triangles[i], true)] = rank;
  }
  return ranks;
}

// The clean mesh in the order of a set, or as it is stored.
class BlendedMesh {
 public:
  BlendedMesh(const Mesh& mesh, const PellucidOrderSet* set) : set_(set), drawn_(clean(mesh, {}, "mesh")) {
    if (set == nullptr) {
      stored_.resize(drawn_.mesh.triangles.size());
      std::iota(stored_.begin(), stored_.end(), 0U);
      return;
    }
    orders_ = restrict_orders(set->mesh.orders(), drawn_.source, mesh.triangles.size());
  }

  [[nodiscard]] const Mesh& mesh() const { return drawn_.mesh; }

  [[nodiscard]] std::vector<std::uint32_t> ranks(const Viewpoint& view) const {
    const std::size_t count = drawn_.mesh.triangles.size();
    if (set_ == nullptr) return ranks_from_back(stored_, count);
    if (view.distance < orders_.valid_from || view.distance > orders_.valid_to)
      return ranks_from_back(orders_.base_sequence, count);
    return ranks_of(orders_.orders[order_for(set_->mesh.selector(), view.direction)], count);
  }

 private:
  const PellucidOrderSet* set_;
  CleanMesh drawn_;
  OrderSet orders_;
  std::vector<std::uint32_t> stored_;
};

PellucidBlendQuality measure_blending(const PellucidMesh* given, const PellucidOrderSet* set,
                                      const PellucidMeasureOptions& options) {
  const Mesh mesh = copy_mesh(view_of(given));
  require_made_for(set, mesh);
  require(set == nullptr || set->mesh.orders().purpose == OrderPurpose::transparency,
          "these are overdraw orders: pellucid_measure_overdraw() is for them");
  const BlendedMesh blended(mesh, set);
  if (blended.mesh().triangles.empty())
    throw Error(ErrorKind::nothing_to_do, "mesh: there is no triangle that draws anything");
  require(options.viewpoints > 0, "viewpoints is 0");
  require(options.alpha >= 0 && options.alpha <= 1, "alpha is not in 0..1");
  CallbackProgress progress(options.run);
  const ThreadLimit threads(options.run.threads);
  MeasureOptions measure;
  measure.viewpoints = options.viewpoints;
  measure.min_distance = options.min_distance;
  measure.max_distance = options.max_distance;
  measure.size = options.size;
  measure.seed = options.seed;
  measure.facing = set != nullptr ? set->mesh.orders().facing : facing_of(options.facing);
  measure.shading.alpha = options.alpha;
  measure.progress = progress.pointer();
  const std::vector<DrawingMethod> methods{{"", [&](const Viewpoint& view) { return blended.ranks(view); }}};
  const MethodQuality quality = measure_order_quality(blended.mesh(), methods, measure).front();
  return {quality.ipr_mean, quality.ipr_max, quality.psnr_mean, quality.psnr_min};
}

// Returns the ranks of all triangles in every order of a set, or in the stored order if `set` is null. Orders
// from files may leave triangles out.
std::vector<std::vector<std::uint32_t>> overdraw_ranks(const PellucidOrderSet* set, std::size_t triangles) {
  std::vector<std::vector<std::uint32_t>> ranks;
  if (set == nullptr) {
    ranks.emplace_back(triangles);
    std::iota(ranks[0].begin(), ranks[0].end(), 0U);
    return ranks;
  }
  for (const NodeSequence& nodes : set->mesh.orders().orders) {
    std::vector<std::uint32_t>& of_order = ranks.emplace_back(triangles, kNoRank);
    for (std::uint32_t rank = 0; rank < nodes.size(); ++rank) of_order[triangle_of(nodes[rank])] = rank;
  }
  return ranks;
}

void require_valid(const PellucidOrderSet* set, const PellucidPoses* poses, const Mesh& mesh) {
  require_made_for(set, mesh);
  for (const Triangle& t : mesh.triangles)
    require(std::max({t[0], t[1], t[2]}) < mesh.positions.size(), "mesh: an index is out of range");
  if (set == nullptr) return;
  require(set->mesh.orders().purpose == OrderPurpose::overdraw,
          "these are transparency orders: pellucid_measure_blending() is for them");
  // The poses that a program passes make one animation; a file may have more.
  const OrderSet& orders = set->mesh.orders();
  const std::size_t frames = orders.animations.size() == 1 ? orders.animations.front().times.size() : 0;
  require(poses == nullptr || poses->frame_count == frames, "the orders are not of these poses");
}

PellucidOverdrawQuality measure_overdraw(const PellucidMesh* given, const PellucidPoses* poses,
                                         const PellucidOrderSet* set, const PellucidMeasureOptions& options) {
  const Mesh mesh = copy_mesh(view_of(given));
  require_valid(set, poses, mesh);
  if (mesh.triangles.empty()) throw Error(ErrorKind::nothing_to_do, "mesh: there are no triangles");
  require(options.viewpoints > 0, "viewpoints is 0");
  OverdrawSubject subject;
  subject.triangles = mesh.triangles;
  if (facing_of(options.facing) == Facing::duplicated) subject.double_sided.assign(mesh.triangles.size(), 1);
  for (const Pose& pose : poses_of(*given, poses))
    subject.frames.push_back(copy_mesh({pose.positions, {}}).positions);
  if (poses == nullptr) subject.frames = {mesh.positions};
  const std::vector<std::vector<std::uint32_t>> ranks = overdraw_ranks(set, mesh.triangles.size());
  CallbackProgress progress(options.run);
  const ThreadLimit threads(options.run.threads);
  PosedOverdrawOptions measure;
  measure.viewpoints = options.viewpoints;
  measure.min_distance = options.min_distance;
  measure.max_distance = options.max_distance;
  measure.size = options.size;
  measure.seed = options.seed;
  measure.progress = progress.pointer();
  const auto choose = [&](std::uint32_t frame, const Viewpoint& view) -> std::span<const std::uint32_t> {
    if (set == nullptr) return ranks.front();
    PellucidOrders selector = set->mesh.selector();
    if (poses != nullptr) {
      const PellucidKeyframes& key_frames = set->mesh.keyframes();
      selector = pellucid_orders_at(&selector, &key_frames, key_frames.times[frame]);
    }
    return ranks[order_for(selector, view.direction)];
  };
  const std::vector<PosedDrawingMethod> methods{{"", choose}};
  const OverdrawQuality quality = measure_posed_overdraw(subject, methods, measure).front();
  return {quality.mean, quality.max};
}

PellucidCacheQuality measure_cache(const void* given, std::uint32_t index_bytes, std::uint64_t index_count,
                                   std::uint32_t vertex_count, PellucidCacheModel model,
                                   std::uint32_t cache_size) {
  require(cache_size >= 3, "the vertex cache must hold 3 vertices or more");
  require(index_count % 3 == 0, "index_count is not a multiple of 3");
  require(model == pellucid_cache_fifo || model == pellucid_cache_lru, "model: there is no such value");
  const IndexView view = view_of_indices(given, index_bytes, index_count);
  std::vector<std::uint32_t> indices(view.size());
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = view[i];
  for (const std::uint32_t index : indices) require(index < vertex_count, "an index is out of range");
  const CacheStatistics statistics = simulate_vertex_cache(
      indices, vertex_count, model == pellucid_cache_lru ? CacheModel::lru : CacheModel::fifo, cache_size);
  return {statistics.misses, statistics.acmr, statistics.atvr};
}

}  // namespace
}  // namespace pellucid::c

using namespace pellucid::c;  // NOLINT(google-build-using-namespace): below are C functions

void pellucid_measure_options_init(PellucidMeasureOptions* options, size_t struct_size) {
  const pellucid::MeasureOptions defaults;
  PellucidMeasureOptions set{};
  set.struct_size = struct_size;
  set.viewpoints = 100;
  set.min_distance = defaults.min_distance;
  set.max_distance = defaults.max_distance;
  set.size = 512;
  set.alpha = defaults.shading.alpha;
  set.seed = defaults.seed;
  if (options != nullptr) copy_out(set, options, struct_size);
}

PellucidStatus pellucid_measure_cache(const void* indices, uint32_t index_bytes, uint64_t index_count,
                                      uint32_t vertex_count, PellucidCacheModel model, uint32_t cache_size,
                                      PellucidCacheQuality* quality) {
  return guarded([&] {
    require(quality != nullptr, "quality is null");
    *quality = measure_cache(indices, index_bytes, index_count, vertex_count, model, cache_size);
  });
}

PellucidStatus pellucid_measure_blending(const PellucidMesh* mesh, const PellucidOrderSet* orders,
                                         const PellucidMeasureOptions* options,
                                         PellucidBlendQuality* quality) {
  return guarded([&] {
    require(quality != nullptr, "quality is null");
    *quality = measure_blending(mesh, orders, settled(options, pellucid_measure_options_init));
  });
}

PellucidStatus pellucid_measure_overdraw(const PellucidMesh* mesh, const PellucidPoses* poses,
                                         const PellucidOrderSet* orders,
                                         const PellucidMeasureOptions* options,
                                         PellucidOverdrawQuality* quality) {
  return guarded([&] {
    require(quality != nullptr, "quality is null");
    *quality = measure_overdraw(mesh, poses, orders, settled(options, pellucid_measure_options_init));
  });
}
