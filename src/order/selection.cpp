// What a renderer does with an order set: see pellucid/order.h.
#include <algorithm>

#include "pellucid/order.h"
#include "pellucid/runtime/select.h"

namespace pellucid {

std::uint32_t select_order(const OrderSet& set, const Vec3d& direction) {
  if (has_triangle_cells(set.partition)) {
    const double d[3] = {direction.x, direction.y, direction.z};
    return set.cell_orders[pellucid_find_triangle(set.partition.level, d)];
  }
  return set.cell_orders[find_cell(make_partition(set.partition), direction)];
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

PixelCount count_incorrect_pixels(const FragmentBuffer& fragments, std::span<const std::uint32_t> ranks) {
  PixelCount count;
  const std::uint64_t pixels = std::uint64_t{fragments.width} * fragments.height;
  for (std::uint64_t p = 0; p < pixels; ++p) {
    const std::span<const Fragment> pixel = fragments.pixel(p);
    if (pixel.empty()) continue;
    ++count.foreground;
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
