// What a renderer does with an order set: see pellucid/order.h.
#include <algorithm>

#include "pellucid/order.h"
#include "pellucid/runtime/select.h"

namespace pellucid {
namespace {

std::uint32_t cell_of(const PartitionSpec& spec, const Vec3d& direction) {
  if (!has_triangle_cells(spec)) return find_cell(make_partition(spec), direction);
  const double d[3] = {direction.x, direction.y, direction.z};
  return pellucid_find_triangle(spec.level, d);
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

std::vector<std::uint32_t> ranks_of(std::span<const NodeId> sequence, std::uint64_t triangle_count) {
  std::vector<std::uint32_t> ranks(2 * triangle_count, kNoRank);
  for (std::uint32_t rank = 0; rank < sequence.size(); ++rank) ranks[sequence[rank]] = rank;
  return ranks;
}

bool pixel_in_order(std::span<const Fragment> fragments, std::span<const std::uint32_t> ranks) {
  // Every fragment must come after all that are nearer by more than a tie.
  std::size_t nearer = 0;            // of these, the count seen so far
  std::uint32_t highest_nearer = 0;  // and their highest rank, plus one
  for (const Fragment& fragment : fragments) {
    const std::uint32_t rank = ranks[fragment.node];
    if (rank == kNoRank) return false;
    for (; fragment.depth - fragments[nearer].depth > kDepthTie; ++nearer) {
      highest_nearer = std::max(highest_nearer, ranks[fragments[nearer].node] + 1);
    }
    if (rank + 1 < highest_nearer) return false;
  }
  return true;
}

bool pixel_is_verified(std::span<const Fragment> fragments, std::span<const std::uint32_t> ranks) {
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const std::uint32_t rank = ranks[fragments[i].node];
    if (rank == kNoRank) return false;
    if (i == 0) continue;
    if (fragments[i].depth <= fragments[i - 1].depth || rank < ranks[fragments[i - 1].node]) return false;
  }
  return true;
}

PixelCount count_incorrect_pixels(const FragmentBuffer& fragments, std::span<const std::uint32_t> ranks) {
  PixelCount count;
  const std::uint64_t pixels = std::uint64_t{fragments.width} * fragments.height;
  for (std::uint64_t p = 0; p < pixels; ++p) {
    const std::span<const Fragment> pixel = fragments.pixel(p);
    if (pixel.empty()) continue;
    ++count.foreground;
    if (pixel_is_verified(pixel, ranks)) continue;
    ++count.repaired;
    if (!pixel_in_order(pixel, ranks)) ++count.incorrect;
  }
  return count;
}

std::vector<std::uint32_t> index_buffer(const Mesh& mesh, std::span<const NodeId> sequence) {
  std::vector<std::uint32_t> indices;
  indices.reserve(3 * sequence.size());
  for (const NodeId node : sequence) {
    for (const std::uint32_t corner : corners_of(mesh, node)) indices.push_back(corner);
  }
  return indices;
}

}  // namespace pellucid
