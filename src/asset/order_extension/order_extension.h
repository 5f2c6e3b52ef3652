// Internal to the module `asset`: the JSON and arrays of the glTF extension
// PELLUCID_mesh_primitive_view_orders (docs/file-format.md). Reading turns the extension of a primitive into
// an order set, and writing does the opposite. Both check everything.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "asset/gltf/accessors.h"
#include "asset/gltf/edit.h"

namespace pellucid {

constexpr std::uint64_t kOrderExtensionVersion = 1;

struct StoredOrders {
  OrderSet orders;
  std::optional<OrderErrorRecord> error;
};

// Reads and checks the order set of a primitive. `extension` is its extension object, `mesh` has its
// triangles, and `animations` is the number of animations of the file. Throws Error{bad_input} that names the
// primitive.
StoredOrders read_order_extension(const Fields& extension, const Mesh& mesh, AccessorReader& accessors,
                                  std::uint64_t animations);

// Checks that `ordered` are order sets of `model`. Throws Error{bad_argument} that names the primitive and
// the reason.
void check_orders(const Model& model, const std::vector<OrderedPrimitive>& ordered);

// Indices of the accessors that hold an order set's arrays.
struct OrderAccessors {
  std::uint64_t cell_orders = 0;
  std::vector<std::optional<std::uint64_t>> orders;  // empty for an order that draws nothing
  OrderEncoding encoding = OrderEncoding::indices;
  std::optional<std::uint64_t> patch_offsets;
  struct KeyFrames {
    std::uint64_t times = 0, spheres = 0, cell_orders = 0;
  };
  std::vector<KeyFrames> animations;  // one per element of OrderSet::animations
};

// Appends the arrays of order sets to a document: orders, patches, cell tables, key frames.
class OrderArrayWriter {
 public:
  // The side files are named after `stem`: STEM.orders.bin.
  OrderArrayWriter(DocumentEditor& editor, const WriteOptions& options, std::string stem)
      : editor_(editor), options_(options), stem_(std::move(stem)) {}

  // Appends all arrays of a set for `mesh`. `base` lists its triangles in the order of primitive.indices as
  // written.
  OrderAccessors write(const OrderSet& set, const Mesh& mesh, std::span<const std::uint32_t> base,
                       OrderEncoding encoding);

  // Returns the bytes stored so far, without fallback copies.
  [[nodiscard]] std::uint64_t order_bytes() const { return order_bytes_; }
  // Returns the name of the side file that each buffer becomes, and an empty name for the others.
  [[nodiscard]] const std::vector<std::string>& side_names() const { return side_names_; }

 private:
  std::uint64_t side_buffer(const std::string& suffix);
  std::uint64_t order_buffer();
  std::uint64_t append_order_view(const std::vector<std::uint32_t>& values, ComponentWidth width,
                                  OrderEncoding encoding);
  void append_orders(const OrderSet& set, const std::vector<std::vector<std::uint32_t>>& stored,
                     ComponentWidth width, OrderAccessors& accessors);
  std::uint64_t shared_accessor(const char* type, std::uint32_t component_type, std::uint64_t count,
                                const Bytes& bytes);
  std::uint64_t append_values(const std::vector<std::uint32_t>& values, ComponentWidth width);
  std::uint64_t append_cell_orders(const OrderSet& set, std::span<const std::uint32_t> cell_orders);
  OrderAccessors::KeyFrames append_key_frames(const OrderSet& set, const KeyFrameTable& table);

  DocumentEditor& editor_;
  const WriteOptions& options_;
  std::string stem_;
  std::uint64_t order_bytes_ = 0;
  std::vector<std::string> side_names_;
  // Accessors by type, component type and bytes. Primitives of a model often share their tables.
  std::map<std::tuple<std::string, std::uint32_t, Bytes>, std::uint64_t> shared_;
};

// Returns the extension object of a primitive whose arrays are in the document.
Json order_extension_json(const OrderSet& set, const std::optional<OrderErrorRecord>& error,
                          SortDirection direction, const OrderAccessors& accessors);

}  // namespace pellucid
