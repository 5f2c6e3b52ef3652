// Implements the class OrderedMesh: returns draw orders of one mesh as index buffers, and selects one of them
// for a camera. In: an order set and its mesh. Out: index data, and the same selection as by
// pellucid/runtime/select.h.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "pellucid/pellucid.h"
#include "pellucid/runtime/select.h"

namespace pellucid {

// An animation as select.h reads it.
struct KeyFrameArrays {
  std::vector<float> times, spheres;
  std::vector<std::uint32_t> cell_orders;
  PellucidKeyframes keyframes{};
};

namespace {

constexpr PellucidKeyframes kNoKeyFrames{};

void require_fit(bool holds, const char* otherwise) {
  if (!holds) throw Error(ErrorKind::bad_argument, otherwise);
}

void require_table(const std::vector<std::uint32_t>& cell_orders, std::size_t entries,
                   const OrderSet& orders) {
  require_fit(cell_orders.size() == entries, "orders: the table does not have one entry for each view cell");
  for (const std::uint32_t order : cell_orders)
    require_fit(order < orders.orders.size(), "orders: the table names an order that does not exist");
}

void require_triangles_in_range(const OrderSet& orders, const Mesh& mesh) {
  const auto require_drawable = [&](std::uint32_t triangle) {
    require_fit(triangle < mesh.triangles.size(), "orders: they draw a triangle that the mesh does not have");
    const Triangle& t = mesh.triangles[triangle];
    require_fit(std::max({t[0], t[1], t[2]}) < mesh.positions.size(),
                "orders: they draw a triangle with an index out of range");
  };
  for (const NodeSequence& order : orders.orders) {
    for (const NodeId node : order) require_drawable(triangle_of(node));
  }
  for (const std::uint32_t triangle : orders.base_sequence) require_drawable(triangle);
}

// Returns the base order as nodes from front to back. If both sides of the mesh are visible, each triangle
// also has its flipped copy, because all orders are drawn with back faces culled.
NodeSequence fallback_of(const OrderSet& orders) {
  NodeSequence nodes;
  for (const std::uint32_t triangle : orders.base_sequence) {
    if (orders.facing == Facing::duplicated) nodes.push_back(node_of(triangle, true));
    nodes.push_back(node_of(triangle, false));
  }
  // Base orders for transparency are stored back to front. For overdraw orders, the order above is right.
  if (orders.purpose == OrderPurpose::transparency) std::reverse(nodes.begin(), nodes.end());
  return nodes;
}

// Appends one row of a table from view cell to order, in the numbering of select.h. If cells are vertices,
// select.h needs one entry for each corner of each triangle.
void append_row(const ViewPartition& partition, const std::uint32_t* row,
                std::vector<std::uint32_t>& entries) {
  if (has_triangle_cells(partition.spec)) {
    entries.insert(entries.end(), row, row + partition.cell_count());
    return;
  }
  for (const std::uint32_t cell : partition.corner_cells) entries.push_back(row[cell]);
}

PellucidOrders make_selector(const OrderSet& orders, const std::vector<std::uint32_t>& cell_orders) {
  const bool overdraw = orders.purpose == OrderPurpose::overdraw;
  PellucidOrders selector{};
  selector.cells = has_triangle_cells(orders.partition) ? pellucid_cells_triangles : pellucid_cells_corners;
  selector.level = orders.partition.level;
  selector.center[0] = orders.sphere.center.x;
  selector.center[1] = orders.sphere.center.y;
  selector.center[2] = orders.sphere.center.z;
  selector.radius = orders.sphere.radius;
  // With a depth test, every order draws the right image at any distance.
  selector.min_distance = overdraw ? 0 : orders.valid_from;
  selector.max_distance = overdraw ? HUGE_VAL : orders.valid_to;
  selector.cell_orders = cell_orders.data();
  selector.cell_order_bytes = sizeof(std::uint32_t);
  selector.fallback_order = PELLUCID_NO_ORDER;
  return selector;
}

KeyFrameArrays make_key_frames(const KeyFrameTable& table, const ViewPartition& partition) {
  KeyFrameArrays arrays;
  for (std::size_t frame = 0; frame < table.times.size(); ++frame) {
    arrays.times.push_back(static_cast<float>(table.times[frame]));
    const BoundingSphere& sphere = table.spheres[frame];
    for (const double value : {sphere.center.x, sphere.center.y, sphere.center.z, sphere.radius})
      arrays.spheres.push_back(static_cast<float>(value));
    append_row(partition, table.cell_orders.data() + frame * partition.cell_count(), arrays.cell_orders);
  }
  arrays.keyframes.times = arrays.times.data();
  arrays.keyframes.spheres = arrays.spheres.data();
  arrays.keyframes.count = static_cast<std::uint32_t>(arrays.times.size());
  arrays.keyframes.cell_orders = arrays.cell_orders.data();
  arrays.keyframes.cell_order_bytes = sizeof(std::uint32_t);
  return arrays;
}

// Writes the vertex indices of nodes, which are stored front to back, in the given direction.
template <class Index>
void write_indices(const std::vector<Triangle>& triangles, const NodeSequence& nodes, SortDirection direction,
                   Index* to) {
  const auto write = [&](NodeId node) {
    const Triangle& t = triangles[triangle_of(node)];
    *to++ = static_cast<Index>(t[0]);
    *to++ = static_cast<Index>(t[is_flipped(node) ? 2 : 1]);
    *to++ = static_cast<Index>(t[is_flipped(node) ? 1 : 2]);
  };
  if (direction == SortDirection::front_to_back) {
    std::for_each(nodes.begin(), nodes.end(), write);
  } else {
    std::for_each(nodes.rbegin(), nodes.rend(), write);
  }
}

}  // namespace

struct OrderedMesh::Data {
  OrderSet orders;  // nodes refer to `triangles`
  std::vector<Triangle> triangles;
  std::uint32_t vertex_count = 0;
  OrderedMeshReport report;
  NodeSequence fallback;                   // front to back
  std::vector<std::uint32_t> cell_orders;  // in the numbering of select.h
  PellucidOrders selector{};
  std::vector<KeyFrameArrays> animations;

  [[nodiscard]] bool is_overdraw() const { return orders.purpose == OrderPurpose::overdraw; }

  [[nodiscard]] const NodeSequence& nodes(const DrawOrder& order) const {
    require_fit(order.index <= orders.orders.size(), "the mesh has no such order");
    return order.index == orders.orders.size() ? fallback : orders.orders[order.index];
  }

  template <class Index>
  void copy_indices(const DrawOrder& order, SortDirection direction, std::span<Index> to) const {
    require_fit(direction == SortDirection::front_to_back || !is_overdraw(),
                "overdraw orders are drawn front to back only");
    const NodeSequence& sequence = nodes(order);
    require_fit(to.size() == 3 * sequence.size(), "the destination does not have the size of the order");
    write_indices(triangles, sequence, direction, to.data());
  }

  // Converts a result of select.h.
  [[nodiscard]] DrawOrder draw_order(std::uint32_t index) const {
    if (index == PELLUCID_NO_ORDER) return {static_cast<std::uint32_t>(orders.orders.size()), true};
    return {index, false};
  }
};

const IndexRange& IndexBuffer::range(const DrawOrder& order) const {
  require_fit(order.index < ranges.size(), "the index buffer does not hold this order");
  return ranges[order.index];
}

OrderedMesh::OrderedMesh(OrderSet orders, const Mesh& mesh, const OrderedMeshReport& report) {
  require_fit(orders.partition.level <= kMaxPartitionLevel,
              "orders: the level of the view partition is above 5");
  require_fit(mesh.positions.size() < std::numeric_limits<std::uint32_t>::max(),
              "mesh: there are too many vertices");
  require_triangles_in_range(orders, mesh);
  const ViewPartition partition = make_partition(orders.partition);
  require_fit(orders.purpose == OrderPurpose::overdraw || orders.animations.empty(),
              "orders: only overdraw orders have key frames");
  require_table(orders.cell_orders, partition.cell_count(), orders);
  for (const KeyFrameTable& table : orders.animations) {
    require_fit(table.spheres.size() == table.times.size(), "orders: a key frame has no bounding sphere");
    require_table(table.cell_orders, table.times.size() * partition.cell_count(), orders);
  }

  auto data = std::make_shared<Data>();
  data->orders = std::move(orders);
  data->triangles = mesh.triangles;
  data->vertex_count = static_cast<std::uint32_t>(mesh.positions.size());
  data->report = report;
  data->fallback = fallback_of(data->orders);
  append_row(partition, data->orders.cell_orders.data(), data->cell_orders);
  data->selector = make_selector(data->orders, data->cell_orders);
  for (const KeyFrameTable& table : data->orders.animations)
    data->animations.push_back(make_key_frames(table, partition));
  data_ = std::move(data);
}

std::uint32_t OrderedMesh::order_count() const noexcept {
  return static_cast<std::uint32_t>(data_->orders.orders.size());
}

DrawOrder OrderedMesh::fallback() const noexcept {
  return {order_count(), true};
}

std::uint32_t OrderedMesh::vertex_count() const noexcept {
  return data_->vertex_count;
}

const std::vector<Triangle>& OrderedMesh::triangles() const noexcept {
  return data_->triangles;
}

const OrderSet& OrderedMesh::orders() const noexcept {
  return data_->orders;
}

const OrderedMeshReport& OrderedMesh::report() const noexcept {
  return data_->report;
}

// ------------------------------------------------------------------------------------------------- indices

IndexBuffer OrderedMesh::index_buffer(IndexWidth width) const {
  return index_buffer(data_->is_overdraw() ? SortDirection::front_to_back : SortDirection::back_to_front,
                      width);
}

IndexBuffer OrderedMesh::index_buffer(SortDirection direction, IndexWidth width) const {
  IndexBuffer buffer;
  buffer.bytes_per_index = width == IndexWidth::bits_32 ? 4 : bytes_per_index(vertex_count());
  std::uint64_t total = 0;
  for (std::uint32_t i = 0; i <= order_count(); ++i) {
    const std::uint64_t count = index_count({i, false});
    require_fit(total + count <= std::numeric_limits<std::uint32_t>::max(),
                "the orders have more than 2^32 - 1 indices: copy them one at a time");
    buffer.ranges.push_back({static_cast<std::uint32_t>(total), static_cast<std::uint32_t>(count)});
    total += count;
  }
  require_fit(total <= std::numeric_limits<std::size_t>::max() / buffer.bytes_per_index,
              "the orders are larger than the memory of this machine: copy them one at a time");
  buffer.bytes.resize(total * buffer.bytes_per_index);
  for (std::uint32_t i = 0; i <= order_count(); ++i) {
    const IndexRange& range = buffer.ranges[i];
    void* to = buffer.bytes.data() + std::size_t{range.first} * buffer.bytes_per_index;
    if (buffer.bytes_per_index == 2) {
      copy_indices({i, false}, direction, std::span(static_cast<std::uint16_t*>(to), range.count));
    } else {
      copy_indices({i, false}, direction, std::span(static_cast<std::uint32_t*>(to), range.count));
    }
  }
  return buffer;
}

std::uint64_t OrderedMesh::index_count(const DrawOrder& order) const {
  return 3 * std::uint64_t{data_->nodes(order).size()};
}

void OrderedMesh::copy_indices(const DrawOrder& order, SortDirection direction,
                               std::span<std::uint16_t> to) const {
  require_fit(bytes_per_index(vertex_count()) == 2, "16-bit indices allow at most 65,535 vertices");
  data_->copy_indices(order, direction, to);
}

void OrderedMesh::copy_indices(const DrawOrder& order, SortDirection direction,
                               std::span<std::uint32_t> to) const {
  data_->copy_indices(order, direction, to);
}

// ----------------------------------------------------------------------------------------------- selection

DrawOrder OrderedMesh::select(const Mat4& world_from_mesh, const Vec3d& eye) const noexcept {
  const double camera[3] = {eye.x, eye.y, eye.z};
  const double* world = world_from_mesh.m.data();
  return data_->draw_order(data_->is_overdraw()
                               ? pellucid_select_animated(&data_->selector, nullptr, 0, world, camera)
                               : pellucid_select_perspective(&data_->selector, world, camera));
}

DrawOrder OrderedMesh::select_orthographic(const Mat4& world_from_mesh, const Vec3d& forward) const noexcept {
  const double along[3] = {forward.x, forward.y, forward.z};
  const double* world = world_from_mesh.m.data();
  return data_->draw_order(
      data_->is_overdraw() ? pellucid_select_animated_orthographic(&data_->selector, nullptr, 0, world, along)
                           : pellucid_select_orthographic(&data_->selector, world, along));
}

DrawOrder OrderedMesh::select(double time, const Mat4& world_from_mesh, const Vec3d& eye,
                              std::size_t animation) const noexcept {
  if (animation >= data_->animations.size()) return select(world_from_mesh, eye);
  const double camera[3] = {eye.x, eye.y, eye.z};
  return data_->draw_order(pellucid_select_animated(&data_->selector, &keyframes(animation), time,
                                                    world_from_mesh.m.data(), camera));
}

DrawOrder OrderedMesh::select_orthographic(double time, const Mat4& world_from_mesh, const Vec3d& forward,
                                           std::size_t animation) const noexcept {
  if (animation >= data_->animations.size()) return select_orthographic(world_from_mesh, forward);
  const double along[3] = {forward.x, forward.y, forward.z};
  return data_->draw_order(pellucid_select_animated_orthographic(&data_->selector, &keyframes(animation),
                                                                 time, world_from_mesh.m.data(), along));
}

const PellucidOrders& OrderedMesh::selector() const noexcept {
  return data_->selector;
}

const PellucidKeyframes& OrderedMesh::keyframes(std::size_t animation) const noexcept {
  return animation < data_->animations.size() ? data_->animations[animation].keyframes : kNoKeyFrames;
}

}  // namespace pellucid
