// Order sets as C sees them: indices, tables, figures.
#include <cmath>
#include <memory>

#include "c/handles.h"

namespace pellucid::c {
namespace {

// select.h finds corners of triangles where cells are vertices: one entry for each.
void append_row(const OrderSet& orders, const ViewPartition& partition, const std::uint32_t* row,
                std::vector<std::uint32_t>& entries) {
  if (has_triangle_cells(orders.partition)) {
    entries.insert(entries.end(), row, row + partition.cell_count());
    return;
  }
  for (const std::uint32_t cell : partition.corner_cells) entries.push_back(row[cell]);
}

// Key frames of the one animation that a program's poses make; files may have more.
void add_keyframes(PellucidOrderSet& set, const ViewPartition& partition) {
  if (set.orders.animations.size() != 1) return;
  const KeyFrameTable& table = set.orders.animations.front();
  for (std::size_t frame = 0; frame < table.times.size(); ++frame) {
    set.times.push_back(static_cast<float>(table.times[frame]));
    const BoundingSphere& sphere = table.spheres[frame];
    for (const double value : {sphere.center.x, sphere.center.y, sphere.center.z, sphere.radius})
      set.spheres.push_back(static_cast<float>(value));
    append_row(set.orders, partition, table.cell_orders.data() + frame * partition.cell_count(),
               set.keyframe_cell_orders);
  }
}

// The triangles of an order in drawing order, as nodes front to back. Throws Error{bad_argument}.
NodeSequence nodes_of(const PellucidOrderSet& set, std::uint32_t order) {
  if (order != PELLUCID_NO_ORDER) {
    require(order < set.orders.orders.size(), "there is no such order");
    return set.orders.orders[order];
  }
  NodeSequence nodes;
  for (const std::uint32_t triangle : set.orders.base_sequence) nodes.push_back(node_of(triangle, false));
  // Stored back to front, where the direction matters.
  if (set.orders.purpose == OrderPurpose::transparency) std::reverse(nodes.begin(), nodes.end());
  return nodes;
}

template <class Index>
void write_indices(const std::vector<Triangle>& triangles, const NodeSequence& nodes, Index* to) {
  for (const NodeId node : nodes) {
    const Triangle& t = triangles[triangle_of(node)];
    *to++ = static_cast<Index>(t[0]);
    *to++ = static_cast<Index>(t[is_flipped(node) ? 2 : 1]);
    *to++ = static_cast<Index>(t[is_flipped(node) ? 1 : 2]);
  }
}

void copy_indices(const PellucidOrderSet& set, std::uint32_t order, PellucidDirection direction,
                  std::uint32_t index_bytes, void* destination) {
  require(index_bytes == 2 || index_bytes == 4, "index_bytes must be 2 or 4");
  require(index_bytes == 4 || bytes_per_index(set.vertex_count) == 2,
          "2 bytes do not hold the indices of so many vertices");
  require(direction == pellucid_front_to_back || direction == pellucid_back_to_front,
          "direction: there is no such value");
  require(direction == pellucid_front_to_back || set.orders.purpose == OrderPurpose::transparency,
          "overdraw orders are drawn front to back only");
  NodeSequence nodes = nodes_of(set, order);
  require(destination != nullptr || nodes.empty(), "destination is null");
  if (direction == pellucid_back_to_front) std::reverse(nodes.begin(), nodes.end());
  if (index_bytes == 2) {
    write_indices(set.triangles, nodes, static_cast<std::uint16_t*>(destination));
  } else {
    write_indices(set.triangles, nodes, static_cast<std::uint32_t*>(destination));
  }
}

PellucidOrders selector_of(const PellucidOrderSet& set) {
  const OrderSet& orders = set.orders;
  const bool overdraw = orders.purpose == OrderPurpose::overdraw;
  PellucidOrders selector{};
  selector.cells = has_triangle_cells(orders.partition) ? pellucid_cells_triangles : pellucid_cells_corners;
  selector.level = orders.partition.level;
  selector.center[0] = orders.sphere.center.x;
  selector.center[1] = orders.sphere.center.y;
  selector.center[2] = orders.sphere.center.z;
  selector.radius = orders.sphere.radius;
  // With a depth test every order is right everywhere.
  selector.min_distance = overdraw ? 0 : orders.valid_from;
  selector.max_distance = overdraw ? HUGE_VAL : orders.valid_to;
  selector.cell_orders = set.cell_orders.data();
  selector.cell_order_bytes = sizeof(std::uint32_t);
  selector.fallback_order = PELLUCID_NO_ORDER;
  return selector;
}

PellucidKeyframes keyframes_of(const PellucidOrderSet& set) {
  PellucidKeyframes keyframes{};
  keyframes.times = set.times.data();
  keyframes.spheres = set.spheres.data();
  keyframes.count = static_cast<std::uint32_t>(set.times.size());
  keyframes.cell_orders = set.keyframe_cell_orders.data();
  keyframes.cell_order_bytes = sizeof(std::uint32_t);
  return keyframes;
}

}  // namespace

std::unique_ptr<PellucidOrderSet> make_handle(OrderSet orders, const Mesh& mesh) {
  auto set = std::make_unique<PellucidOrderSet>();
  const ViewPartition partition = make_partition(orders.partition);
  set->orders = std::move(orders);
  set->triangles = mesh.triangles;
  set->vertex_count = static_cast<std::uint32_t>(mesh.positions.size());
  append_row(set->orders, partition, set->orders.cell_orders.data(), set->cell_orders);
  add_keyframes(*set, partition);
  set->statistics.triangles = mesh.triangles.size();
  set->statistics.index_bytes = index_bytes(set->orders, mesh);
  set->statistics.measured_error = -1;
  return set;
}

std::uint32_t order_for(const PellucidOrderSet& set, const PellucidOrders& selector,
                        std::optional<std::uint32_t> key_frame, const Vec3d& direction) {
  const double d[3] = {direction.x, direction.y, direction.z};
  const std::uint32_t cell = pellucid_find_cell(&selector, d);
  if (!key_frame) return set.cell_orders[cell];
  return set.keyframe_cell_orders[std::size_t{*key_frame} * pellucid_cell_count(&selector) + cell];
}

}  // namespace pellucid::c

using namespace pellucid::c;  // NOLINT(google-build-using-namespace): below are C functions

void pellucid_free_order_set(PellucidOrderSet* orders) {
  delete orders;
}

uint32_t pellucid_order_count(const PellucidOrderSet* orders) {
  return orders == nullptr ? 0 : static_cast<uint32_t>(orders->orders.orders.size());
}

uint64_t pellucid_order_index_count(const PellucidOrderSet* orders, uint32_t order) {
  if (orders == nullptr) return 0;
  if (order == PELLUCID_NO_ORDER) return 3 * uint64_t{orders->orders.base_sequence.size()};
  return order < orders->orders.orders.size() ? 3 * uint64_t{orders->orders.orders[order].size()} : 0;
}

PellucidStatus pellucid_copy_order_indices(const PellucidOrderSet* orders, uint32_t order,
                                           PellucidDirection direction, uint32_t index_bytes,
                                           void* destination) {
  return guarded([&] {
    require(orders != nullptr, "orders is null");
    copy_indices(*orders, order, direction, index_bytes, destination);
  });
}

PellucidStatus pellucid_order_selector(const PellucidOrderSet* orders, PellucidOrders* selector) {
  return guarded([&] {
    require(orders != nullptr && selector != nullptr, "orders or selector is null");
    *selector = selector_of(*orders);
  });
}

PellucidStatus pellucid_order_keyframes(const PellucidOrderSet* orders, PellucidKeyframes* keyframes) {
  return guarded([&] {
    require(orders != nullptr && keyframes != nullptr, "orders or keyframes is null");
    *keyframes = keyframes_of(*orders);
  });
}

PellucidStatus pellucid_order_statistics(const PellucidOrderSet* orders, PellucidOrderStatistics* statistics,
                                         size_t struct_size) {
  return guarded([&] {
    require(orders != nullptr && statistics != nullptr, "orders or statistics is null");
    copy_out(orders->statistics, statistics, struct_size);
  });
}
