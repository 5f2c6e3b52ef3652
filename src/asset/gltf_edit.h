// Internal to the module `asset`: changes to a glTF document that leave everything else where it is.
// Accessors, buffer views and bytes are only ever appended at the end or taken off the end, so no index in
// the file moves.
#pragma once

#include <span>

#include "asset/gltf_document.h"

namespace pellucid {

// componentType of unsigned integers.
enum class IndexWidth : std::uint32_t { one_byte = 5121, two_bytes = 5123, four_bytes = 5125 };
constexpr std::uint64_t bytes_of(IndexWidth width) {
  return width == IndexWidth::one_byte ? 1 : width == IndexWidth::two_bytes ? 2 : 4;
}
// Vertex indices take 16 bits up to 65,535 vertices: the largest 16-bit value is no legal index.
IndexWidth vertex_index_width(std::uint64_t vertices);
// The narrowest width for values below `count`.
IndexWidth value_width(std::uint64_t count);
// Little-endian, back to back.
Bytes pack(std::span<const std::uint32_t> values, IndexWidth width);

class DocumentEditor {
 public:
  explicit DocumentEditor(GltfDocument document);

  [[nodiscard]] GltfDocument& document() { return document_; }
  [[nodiscard]] Json& primitive(std::uint32_t mesh, std::uint32_t index);

  // The buffer that new data goes to: the first one, or a new one where that has no bytes.
  std::uint64_t host_buffer();
  std::uint64_t append_buffer(BufferStorage storage);
  // Bytes at the end of a buffer, aligned to 4. `padding` (0..3) zeros came before them: recorded in the
  // extras of whoever refers to them, so that taking them off again is exact.
  struct Range {
    std::uint64_t buffer, offset, length, padding;
  };
  Range append_bytes(std::uint64_t buffer, const Bytes& bytes);
  std::uint64_t append_view(const Range& range);
  // A view whose bytes are compressed at `compressed` (EXT_meshopt_compression, mode INDICES); `fallback` is
  // where they lie uncompressed.
  std::uint64_t append_compressed_view(const Range& fallback, const Range& compressed, IndexWidth width);
  std::uint64_t append_accessor(std::uint64_t view, std::uint64_t offset, IndexWidth width,
                                std::uint64_t count);
  std::uint64_t append_accessor(Json accessor);

  // Overwrite bytes of a buffer.
  void overwrite(std::uint64_t buffer, std::uint64_t offset, const Bytes& bytes);

  // Remove the order extension from every primitive, with its accessors, views, bytes and buffers wherever
  // they end the file. What another program moved away from the end stays, unused.
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

}  // namespace pellucid
