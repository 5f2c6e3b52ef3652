// Internal to the module `asset`: changes to a glTF document that leave everything else in place. In: a
// document. Out: the document with accessors, buffer views and bytes appended, removed or overwritten.
// Entries are only appended or removed at the end of their arrays, so no index in the file changes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "asset/gltf/document.h"

namespace pellucid {

// The componentType of unsigned integers.
enum class ComponentWidth : std::uint32_t { one_byte = 5121, two_bytes = 5123, four_bytes = 5125 };
constexpr std::uint64_t bytes_of(ComponentWidth width) {
  return width == ComponentWidth::one_byte ? 1 : width == ComponentWidth::two_bytes ? 2 : 4;
}
// Returns the width of indices into this many vertices, which bytes_per_index() of pellucid/sequencing.h
// decides.
ComponentWidth vertex_index_width(std::uint64_t vertices);
// Returns the narrowest width for values below `count`: ids of triangles and patches, offsets, numbers of
// orders. These are not vertex indices, so the largest value of a width is allowed, and 65,536 of them fit in
// 16 bits.
ComponentWidth value_width(std::uint64_t count);
// Returns the values in little-endian order, back to back.
Bytes pack(std::span<const std::uint32_t> values, ComponentWidth width);

class DocumentEditor {
 public:
  explicit DocumentEditor(GltfDocument document);

  [[nodiscard]] GltfDocument& document() { return document_; }
  [[nodiscard]] Json& primitive(std::uint32_t mesh, std::uint32_t index);

  // Returns the buffer for new data: the first one, or a new one if the first has no bytes.
  std::uint64_t host_buffer();
  std::uint64_t append_buffer(BufferStorage storage);
  // Bytes at the end of a buffer, aligned to 4, after `padding` zeros (0 to 3). The padding is recorded in
  // the extras of the view that refers to the bytes, so that they can be removed again exactly.
  struct Range {
    std::uint64_t buffer, offset, length, padding;
  };
  Range append_bytes(std::uint64_t buffer, const Bytes& bytes);
  std::uint64_t append_view(const Range& range);
  // Appends a view whose bytes are stored compressed at `compressed` (EXT_meshopt_compression, mode INDICES)
  // and uncompressed at `fallback`.
  std::uint64_t append_compressed_view(const Range& fallback, const Range& compressed, ComponentWidth width);
  std::uint64_t append_accessor(std::uint64_t view, std::uint64_t offset, ComponentWidth width,
                                std::uint64_t count);
  std::uint64_t append_accessor(Json accessor);

  // Overwrites bytes of a buffer.
  void overwrite(std::uint64_t buffer, std::uint64_t offset, const Bytes& bytes);

  // Removes the order extension from every primitive, with its accessors, views, bytes and buffers if they
  // are the last ones of the file. If another program has moved them away from the end, they stay in the
  // file, unused.
  void remove_orders();

  void declare_extension(const char* name);

 private:
  Bytes& mutable_bytes(std::uint64_t buffer);
  std::uint64_t append(const char* array, Json value);
  void withdraw_extension(const char* name);
  void pop_accessors(const std::vector<std::uint64_t>& removable);
  void pop_views(const std::vector<std::uint64_t>& removable);
  void cut_off(const std::vector<Json>& popped_views);
  [[nodiscard]] std::uint64_t used_end(std::uint64_t buffer) const;
  void pop_buffers(const std::vector<std::uint64_t>& removable);
  void pop_last(const char* array);

  GltfDocument document_;
  std::vector<std::shared_ptr<Bytes>> owned_;  // mutable copies of buffers, made on the first change
};

// Returns for each accessor of a document whether it may be overwritten in place. It may if exactly one
// primitive uses it, as its indices, nothing else refers to it, and no other view or accessor shares a byte
// with it. Sparse, compressed and strided accessors never qualify.
std::vector<bool> exclusive_index_accessors(const GltfDocument& document);

// Gives a primitive that was split accessors of its own. They hold the old vertices and, after them,
// primitive.new_vertices with interpolated attributes. `json` is the primitive in the document of the editor
// from which `primitive` was read. The old accessors stay, because others may use them. Component types and
// flags stay as they are, with one exception: quantised positions become floats, because a new vertex that is
// off its plane would cause new intersections.
void append_split_vertices(DocumentEditor& editor, Json& json, const Primitive& primitive);

}  // namespace pellucid
