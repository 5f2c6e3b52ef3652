// Orders between clean meshes and file meshes: see cleaned.h.
#include "cleaned.h"

#include <limits>

namespace pellucid::cli {
namespace {

constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

// Where patches begin once the triangles without a new number are gone; patches that are gone, too, are none.
std::vector<std::uint32_t> kept_offsets(const OrderSet& orders, std::span<const std::uint32_t> new_number) {
  std::vector<std::uint32_t> kept;
  std::uint32_t count = 0;
  std::size_t next = 0;  // of the base sequence
  for (const std::uint32_t offset : orders.patch_offsets) {
    for (; next < offset; ++next) count += new_number[orders.base_sequence[next]] == kNowhere ? 0U : 1U;
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
      if (triangle != kNowhere) kept.push_back(node_of(triangle, is_flipped(node)));
    }
    order = std::move(kept);
  }
  orders.patch_offsets = kept_offsets(orders, new_number);
  std::vector<std::uint32_t> base;
  base.reserve(orders.base_sequence.size());
  for (const std::uint32_t triangle : orders.base_sequence) {
    if (new_number[triangle] != kNowhere) base.push_back(new_number[triangle]);
  }
  orders.base_sequence = std::move(base);
  return orders;
}

}  // namespace

OrderSet lift_orders(OrderSet orders, std::span<const std::uint32_t> source) {
  return renumbered(std::move(orders), source);
}

OrderSet restrict_orders(OrderSet orders, std::span<const std::uint32_t> source,
                         std::uint64_t file_triangles) {
  std::vector<std::uint32_t> new_number(file_triangles, kNowhere);
  for (std::uint32_t t = 0; t < source.size(); ++t) new_number[source[t]] = t;
  return renumbered(std::move(orders), new_number);
}

Mesh compacted(const Mesh& mesh) {
  std::vector<std::uint32_t> new_number(mesh.positions.size(), kNowhere);
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) new_number[vertex] = 0;
  }
  Mesh compact;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (new_number[v] == kNowhere) continue;
    new_number[v] = static_cast<std::uint32_t>(compact.positions.size());
    compact.positions.push_back(mesh.positions[v]);
    if (!mesh.normals.empty()) compact.normals.push_back(mesh.normals[v]);
  }
  compact.triangles = mesh.triangles;
  for (Triangle& triangle : compact.triangles) {
    for (std::uint32_t& vertex : triangle) vertex = new_number[vertex];
  }
  return compact;
}

bool has_transparency_orders(const Primitive& primitive) {
  return primitive.orders && primitive.orders->purpose == OrderPurpose::transparency;
}

CleanPrimitive clean_primitive(const Primitive& primitive) {
  CleanMesh clean_mesh = clean(primitive.mesh, {}, primitive.name);
  CleanPrimitive result;
  if (primitive.orders) {
    (has_transparency_orders(primitive) ? result.orders : result.overdraw_orders) =
        restrict_orders(*primitive.orders, clean_mesh.source, primitive.mesh.triangles.size());
  }
  result.mesh = std::move(clean_mesh.mesh);
  return result;
}

}  // namespace pellucid::cli
