// Orders of a clean mesh as orders of the mesh that it was cleaned from, and back: see pellucid/order.h.
#include <limits>

#include "pellucid/order.h"

namespace pellucid {
namespace {

constexpr std::uint32_t kLeftOut = std::numeric_limits<std::uint32_t>::max();

// Where patches begin once the triangles without a new number are gone; patches that are gone, too, are none.
std::vector<std::uint32_t> kept_offsets(const OrderSet& orders, std::span<const std::uint32_t> new_number) {
  std::vector<std::uint32_t> kept;
  std::uint32_t count = 0;
  std::size_t next = 0;  // of the base sequence
  for (const std::uint32_t offset : orders.patch_offsets) {
    for (; next < offset; ++next) count += new_number[orders.base_sequence[next]] == kLeftOut ? 0U : 1U;
    if (kept.empty() || kept.back() != count) kept.push_back(count);
  }
  return kept;
}

// Renumber triangles; those without a new number are left out.
OrderSet renumbered(OrderSet orders, std::span<const std::uint32_t> new_number) {
  for (NodeSequence& order : orders.orders) {
    NodeSequence kept;
    kept.reserve(order.size());
    for (const NodeId node : order) {
      const std::uint32_t triangle = new_number[triangle_of(node)];
      if (triangle != kLeftOut) kept.push_back(node_of(triangle, is_flipped(node)));
    }
    order = std::move(kept);
  }
  orders.patch_offsets = kept_offsets(orders, new_number);
  std::vector<std::uint32_t> base;
  base.reserve(orders.base_sequence.size());
  for (const std::uint32_t triangle : orders.base_sequence) {
    if (new_number[triangle] != kLeftOut) base.push_back(new_number[triangle]);
  }
  orders.base_sequence = std::move(base);
  return orders;
}

}  // namespace

OrderSet lift_orders(OrderSet orders, std::span<const std::uint32_t> source) {
  return renumbered(std::move(orders), source);
}

OrderSet restrict_orders(OrderSet orders, std::span<const std::uint32_t> source,
                         std::uint64_t source_triangles) {
  std::vector<std::uint32_t> new_number(source_triangles, kLeftOut);
  for (std::uint32_t t = 0; t < source.size(); ++t) new_number[source[t]] = t;
  return renumbered(std::move(orders), new_number);
}

}  // namespace pellucid
