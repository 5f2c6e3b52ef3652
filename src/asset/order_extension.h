// Internal to the module `asset`: the glTF extension PELLUCID_mesh_primitive_view_orders
// (docs/file-format.md), its JSON and its arrays, in and out.
#pragma once

#include "asset/accessor_reader.h"

namespace pellucid {

constexpr std::uint64_t kOrderExtensionVersion = 1;

struct StoredOrders {
  OrderSet orders;
  std::optional<OrderErrorRecord> error;
};

// `extension` is the extension object of a primitive with triangles `mesh` in a file of so many animations.
// Everything is checked; failures name the primitive.
StoredOrders read_order_extension(const Fields& extension, const Mesh& mesh, AccessorReader& accessors,
                                  std::uint64_t animations);

// Accessor indices of an order set's arrays, already in the document.
struct OrderAccessors {
  std::uint64_t cell_orders = 0;
  std::vector<std::optional<std::uint64_t>> orders;  // empty: an order that draws nothing
  OrderEncoding encoding = OrderEncoding::indices;
  std::optional<std::uint64_t> patch_offsets;
  struct KeyFrames {
    std::uint64_t times = 0, spheres = 0, cell_orders = 0;
  };
  std::vector<KeyFrames> animations;  // one per element of OrderSet::animations
};
Json order_extension_json(const OrderSet& set, const std::optional<OrderErrorRecord>& error,
                          SortDirection direction, const OrderAccessors& accessors);

// Rows of a cell table as they are stored: one entry per view triangle; for P[n] one per corner of each
// triangle of the icosphere, so that a reader needs no numbering of vertices.
std::vector<std::uint32_t> stored_cell_orders(const PartitionSpec& partition,
                                              std::span<const std::uint32_t> cell_orders);

}  // namespace pellucid
