// Implements the functions of pellucid/pellucid.h for meshes in memory: checks the caller's arrays and makes
// transparency and overdraw orders. In: views of arrays. Out: an OrderedMesh.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pellucid/mesh_view.h"
#include "pellucid/pellucid.h"

namespace pellucid {
namespace {

void require_argument(bool holds, const std::string& otherwise) {
  if (!holds) throw Error(ErrorKind::bad_argument, otherwise);
}

void require_indices_in_range(const Mesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t index : mesh.triangles[t]) {
      if (index < mesh.positions.size()) continue;
      throw Error(ErrorKind::bad_argument, "mesh: triangle " + std::to_string(t) + " has the index " +
                                               std::to_string(index) + ", but there are " +
                                               std::to_string(mesh.positions.size()) + " vertices");
    }
  }
}

Mesh checked_mesh(const MeshView& view) {
  Mesh mesh = copy_mesh(view);
  require_indices_in_range(mesh);
  return mesh;
}

std::vector<Vec3f> copy_positions(const PositionView& view) {
  std::vector<Vec3f> positions(view.size());
  for (std::size_t v = 0; v < positions.size(); ++v) positions[v] = view[v];
  return positions;
}

std::vector<std::vector<Vec3f>> copy_poses(std::span<const Pose> poses, std::size_t vertices) {
  std::vector<std::vector<Vec3f>> frames;
  float before = -std::numeric_limits<float>::infinity();
  for (const Pose& pose : poses) {
    const auto time = static_cast<float>(pose.time);
    require_argument(std::isfinite(time) && time > before,
                     "poses: times must be finite and strictly increasing as 32-bit floats");
    require_argument(pose.positions.size() == vertices, "poses: one does not have the vertices of the mesh");
    before = time;
    frames.push_back(copy_positions(pose.positions));
  }
  return frames;
}

OrderSet as_order_set(const OverdrawOrders& made, const Mesh& mesh, const OverdrawOptions& options) {
  OrderSet set;
  set.purpose = OrderPurpose::overdraw;
  set.partition = {PartitionKind::viewpoints, options.view_level, 0};
  set.sphere = bounding_sphere(mesh);
  set.valid_from = 1;
  set.facing = Facing::single;  // no flipped copies: triangles are drawn as stored, even without culling
  set.base_sequence = made.sequence;
  set.patch_offsets = made.patch_offsets;
  for (std::uint32_t order = 0; order < made.orders.size(); ++order) {
    NodeSequence nodes;
    for (const std::uint32_t triangle : triangle_order(made, order))
      nodes.push_back(node_of(triangle, false));
    set.orders.push_back(std::move(nodes));
  }
  return set;
}

}  // namespace

// --------------------------------------------------------------------------------------- the caller's arrays

PositionView::PositionView(const float* first, std::size_t vertices, std::size_t stride_bytes)
    : first_(first), size_(vertices), floats_(stride_bytes / sizeof(float)) {
  require_argument(first != nullptr || vertices == 0, "mesh: positions is null");
  require_argument(stride_bytes >= sizeof(Vec3f) && stride_bytes % sizeof(float) == 0,
                   "mesh: the stride of the positions must be a multiple of 4, and 12 or more");
}

PositionView PositionView::of_floats(std::span<const float> xyz) {
  require_argument(xyz.size() % 3 == 0, "mesh: there are " + std::to_string(xyz.size()) +
                                            " floats of positions, which is not a multiple of 3");
  return {xyz.data(), xyz.size() / 3};
}

Mesh copy_mesh(const MeshView& view) {
  require_argument(view.indices.size() % 3 == 0, "mesh: there are " + std::to_string(view.indices.size()) +
                                                     " indices, which is not a multiple of 3");
  require_argument(view.positions.size() < std::numeric_limits<std::uint32_t>::max(),
                   "mesh: there are too many vertices for 32-bit indices");
  require_argument(view.indices.size() / 3 < (std::size_t{1} << 31U),
                   "mesh: there are 2^31 triangles or more");
  Mesh mesh;
  mesh.positions = copy_positions(view.positions);
  mesh.triangles.resize(view.indices.size() / 3);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    mesh.triangles[t] = {view.indices[3 * t], view.indices[3 * t + 1], view.indices[3 * t + 2]};
  return mesh;
}

// --------------------------------------------------------------------------------------------- transparency

OrderedMesh order_any_mesh(const Mesh& mesh, const OrderOptions& options, const CleanOptions& cleaning,
                           const std::string& name) {
  const CleanMesh drawn = clean_to_order(mesh, cleaning, name);
  OrderResult result = order_mesh(drawn.mesh, options);
  OrderedMeshReport report;
  report.mesh = drawn.report;
  report.dropped = mesh.triangles.size() - drawn.mesh.triangles.size();
  if (result.statistics.measured_error >= 0) report.measured_error = result.statistics.measured_error;
  report.violated_weight = result.statistics.violated_weight;
  report.seconds = result.statistics.seconds.total;
  return {lift_orders(std::move(result.orders), drawn.source), mesh, report};
}

OrderedMesh order(const MeshView& mesh, const OrderOptions& options, const CleanOptions& cleaning) {
  return order_any_mesh(checked_mesh(mesh), options, cleaning);
}

// ------------------------------------------------------------------------------------------------- overdraw

OrderedMesh reduce_overdraw(const MeshView& view, const OverdrawOptions& options, std::span<const Pose> poses,
                            Facing facing) {
  const Mesh mesh = checked_mesh(view);
  OverdrawSubject subject;
  subject.triangles = mesh.triangles;
  if (facing == Facing::duplicated) subject.double_sided.assign(subject.triangles.size(), 1);
  subject.frames = {mesh.positions};
  if (!poses.empty()) subject.frames = copy_poses(poses, mesh.positions.size());

  const OverdrawOrders made = order_overdraw(subject, options);
  OrderSet orders = as_order_set(made, mesh, options);
  if (poses.empty()) {
    orders.cell_orders = made.cell_orders;
  } else {
    KeyFrameTable& table = orders.animations.emplace_back();
    for (const Pose& pose : poses) table.times.push_back(pose.time);
    table.spheres = made.spheres;
    table.cell_orders = made.cell_orders;
    subject.frames = {mesh.positions};  // at rest
    orders.cell_orders = cheapest_orders(subject, made, options);
  }
  OrderedMeshReport report;
  report.mesh.vertices = mesh.positions.size();
  report.mesh.triangles = mesh.triangles.size();
  report.overdraw = made.run.training_overdraw;
  report.seconds = made.run.seconds.total;
  return {std::move(orders), mesh, report};
}

}  // namespace pellucid
