// Implements the order sets of pellucid/sequencing.h: selection, ranks, index buffers, and the conversion of
// orders between a clean mesh and its source mesh.
#include <algorithm>
#include <limits>

#include "pellucid/runtime/select.h"
#include "pellucid/sequencing.h"

namespace pellucid {
namespace {

std::uint32_t cell_of(const PartitionSpec& spec, const Vec3d& direction) {
  if (!has_triangle_cells(spec)) return find_cell(make_partition(spec), direction);
  const double d[3] = {direction.x, direction.y, direction.z};
  return pellucid_find_triangle(spec.level, d);
}

constexpr std::uint32_t kRemoved = std::numeric_limits<std::uint32_t>::max();

// Returns the patch offsets after triangles without a new index have been removed. Patches that become empty
// are removed, too.
std::vector<std::uint32_t> kept_offsets(const OrderSet& orders, std::span<const std::uint32_t> new_index) {
  std::vector<std::uint32_t> kept;
  std::uint32_t count = 0;
  std::size_t next = 0;  // position in the base sequence
  for (const std::uint32_t offset : orders.patch_offsets) {
    for (; next < offset; ++next) count += new_index[orders.base_sequence[next]] == kRemoved ? 0U : 1U;
    if (kept.empty() || kept.back() != count) kept.push_back(count);
  }
  return kept;
}

// Renumbers the triangles and removes those without a new index.
OrderSet renumbered(OrderSet orders, std::span<const std::uint32_t> new_index) {
  for (NodeSequence& order : orders.orders) {
    NodeSequence kept;
    kept.reserve(order.size());
    for (const NodeId node : order) {
      const std::uint32_t triangle = new_index[triangle_of(node)];
      if (triangle != kRemoved) kept.push_back(node_of(triangle, is_flipped(node)));
    }
    order = std::move(kept);
  }
  orders.patch_offsets = kept_offsets(orders, new_index);
  std::vector<std::uint32_t> base;
  base.reserve(orders.base_sequence.size());
  for (const std::uint32_t triangle : orders.base_sequence) {
    if (new_index[triangle] != kRemoved) base.push_back(new_index[triangle]);
  }
  orders.base_sequence = std::move(base);
  return orders;
}

}  // namespace

std::uint32_t select_order(const OrderSet& set, const Vec3d& direction) {
  return set.cell_orders[cell_of(set.partition, direction)];
}

std::size_t nearest_key_frame(const KeyFrameTable& table, double time) {
  const std::vector<double>& times = table.times;
  if (times.empty() || !(time > times.front())) return 0;
  const auto after =
      static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
  if (after == times.size()) return after - 1;
  return time - times[after - 1] <= times[after] - time ? after - 1 : after;
}

std::uint32_t select_order(const OrderSet& set, std::size_t animation, std::size_t key_frame,
                           const Vec3d& direction) {
  const KeyFrameTable& table = set.animations[animation];
  const std::size_t cells = table.cell_orders.size() / table.times.size();
  return table.cell_orders[key_frame * cells + cell_of(set.partition, direction)];
}

std::uint32_t select_order_at(const OrderSet& set, std::size_t animation, double time, const Vec3d& eye) {
  const KeyFrameTable& table = set.animations[animation];
  const std::size_t key_frame = nearest_key_frame(table, time);
  return select_order(set, animation, key_frame, eye - table.spheres[key_frame].center);
}

std::vector<std::uint32_t> ranks_of(std::span<const NodeId> order, std::uint64_t triangle_count) {
  std::vector<std::uint32_t> ranks(2 * triangle_count, kNoRank);
  for (std::uint32_t rank = 0; rank < order.size(); ++rank) ranks[order[rank]] = rank;
  return ranks;
}

std::vector<std::uint32_t> index_buffer(const Mesh& mesh, std::span<const NodeId> order) {
  std::vector<std::uint32_t> indices;
  indices.reserve(3 * order.size());
  for (const NodeId node : order) {
    for (const std::uint32_t corner : corners_of(mesh, node)) indices.push_back(corner);
  }
  return indices;
}

OrderSet lift_orders(OrderSet orders, std::span<const std::uint32_t> source) {
  return renumbered(std::move(orders), source);
}

OrderSet restrict_orders(OrderSet orders, std::span<const std::uint32_t> source,
                         std::uint64_t source_triangles) {
  std::vector<std::uint32_t> new_index(source_triangles, kRemoved);
  for (std::uint32_t t = 0; t < source.size(); ++t) new_index[source[t]] = t;
  return renumbered(std::move(orders), new_index);
}

}  // namespace pellucid
