// Internal to the module `asset`: the arrays of order sets go into a document: orders, patches, cell tables,
// key frames.
#pragma once

#include <map>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "asset/gltf_edit.h"
#include "asset/order_extension.h"

namespace pellucid {

class OrderArrayWriter {
 public:
  // Side files are called after `stem`: STEM.orders.bin.
  OrderArrayWriter(DocumentEditor& editor, const WriteOptions& options, std::string stem)
      : editor_(editor), options_(options), stem_(std::move(stem)) {}

  // Append all arrays of a set for `mesh`. `base`: its triangles in the order of primitive.indices as
  // written.
  OrderAccessors write(const OrderSet& set, const Mesh& mesh, std::span<const std::uint32_t> base,
                       OrderEncoding encoding);

  // Bytes stored so far, without fallback copies.
  [[nodiscard]] std::uint64_t order_bytes() const { return order_bytes_; }
  // By buffer; empty: not a side file of ours.
  [[nodiscard]] const std::vector<std::string>& side_names() const { return side_names_; }

 private:
  std::uint64_t side_buffer(const std::string& suffix);
  std::uint64_t order_buffer();
  std::uint64_t append_order_view(const std::vector<std::uint32_t>& values, IndexWidth width,
                                  OrderEncoding encoding);
  void append_orders(const OrderSet& set, const std::vector<std::vector<std::uint32_t>>& stored,
                     IndexWidth width, OrderAccessors& accessors);
  std::uint64_t shared_accessor(const char* type, std::uint32_t component_type, std::uint64_t count,
                                const Bytes& bytes);
  std::uint64_t append_values(const std::vector<std::uint32_t>& values, IndexWidth width);
  std::uint64_t append_cell_orders(const OrderSet& set, std::span<const std::uint32_t> cell_orders);
  OrderAccessors::KeyFrames append_key_frames(const OrderSet& set, const KeyFrameTable& table);

  DocumentEditor& editor_;
  const WriteOptions& options_;
  std::string stem_;
  std::uint64_t order_bytes_ = 0;
  std::vector<std::string> side_names_;
  // Tables are the same for all primitives of a model, often: by type, component type and bytes.
  std::map<std::tuple<std::string, std::uint32_t, Bytes>, std::uint64_t> shared_;
};

}  // namespace pellucid
