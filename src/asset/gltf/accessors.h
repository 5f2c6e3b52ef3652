// Internal to the module `asset`: reads typed elements from glTF accessors, which may be strided, sparse,
// quantised or compressed by meshoptimizer. Bounds are checked in 64-bit arithmetic before memory is
// allocated. Format: glTF 2.0, sections 3.6.2 and 3.11; EXT_meshopt_compression, and KHR_meshopt_compression
// if it has the same bit stream.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "asset/gltf/document.h"
#include "asset/gltf/json_fields.h"

namespace pellucid {

enum ComponentType : std::uint64_t {
  signed_byte = 5120,
  unsigned_byte = 5121,
  signed_short = 5122,
  unsigned_short = 5123,
  unsigned_int = 5125,
  single_float = 5126,
};
// Returns the size of a component, or 0 for a type that does not exist.
std::uint64_t bytes_of(std::uint64_t component_type);

// Reads a component as a real number. Normalised integers map to [-1, 1] or [0, 1]. Others keep their value.
float real_at(const Bytes& bytes, std::size_t at, std::uint64_t component_type, bool normalized);
// Reads an unsigned integer.
std::uint32_t scalar_at(const Bytes& bytes, std::size_t at, std::uint64_t component_type);

// Stores the nearest value that the component type can hold.
void store_real(double value, Bytes& bytes, std::size_t at, std::uint64_t component_type, bool normalized);
void store_scalar(std::uint32_t value, Bytes& bytes, std::size_t at, std::uint64_t component_type);

// Compresses indices in mode INDICES of EXT_meshopt_compression.
Bytes encode_meshopt_indices(std::span<const std::uint32_t> values);

// Returns the position of the first value that is not finite, or -1 if all are finite.
std::ptrdiff_t find_non_finite(std::span<const float> values);

// Reads the accessors of one document. Every function throws Error{bad_input} that names the accessor if it
// does not have the requested form or does not lie within its buffer.
class AccessorReader {
 public:
  AccessorReader(const GltfDocument& document, const ReadOptions& options);

  // Reads a VEC3 of floats or (KHR_mesh_quantization) of 8- or 16-bit integers, normalised or not.
  std::vector<Vec3f> read_vec3(std::uint64_t accessor);
  // Reads a SCALAR of unsigned integers with 8, 16 or 32 bits, not normalised.
  std::vector<std::uint32_t> read_scalars(std::uint64_t accessor);
  // Reads floats, as SCALAR (components = 1) or VEC4 (components = 4), back to back.
  std::vector<float> read_floats(std::uint64_t accessor, std::uint64_t components);
  // Reads the components of an accessor of this type as numbers, back to back. They are floats or normalised
  // 8- or 16-bit integers.
  std::vector<float> read_reals(std::uint64_t accessor, const std::string& type);

  // Elements of any type as they are stored, back to back, after strides, sparse parts and compression have
  // been resolved.
  struct Elements {
    std::string type;  // "VEC3"
    std::uint64_t component_type = 0, component_bytes = 0, components = 0;
    std::uint64_t element_bytes = 0;
    bool normalized = false;
    Bytes bytes;
    [[nodiscard]] std::uint64_t count() const { return bytes.size() / element_bytes; }
  };
  Elements read_elements(std::uint64_t accessor);
  // Returns the bytes of a buffer view, decompressed if it is compressed.
  std::span<const std::byte> view_bytes(std::uint64_t view);

  // Counts elements that are made from others towards the limit of the file.
  void charge(const Fields& owner, std::uint64_t elements) { charge(owner, elements, 9 * max_elements_); }

  [[nodiscard]] std::uint64_t count(std::uint64_t accessor) const;
  // Returns the largest value of the component type of an index accessor, which glTF forbids as an index
  // ("primitive restart").
  [[nodiscard]] std::uint32_t restart_value(std::uint64_t accessor) const;
  [[nodiscard]] Fields accessor(std::uint64_t i) const { return root_.element("accessors", i); }

 private:
  struct Layout {
    std::uint64_t count = 0;
    std::uint64_t component_type = 0;
    std::uint64_t component_bytes = 0;
    std::uint64_t element_bytes = 0;
    bool normalized = false;
  };
  Layout layout_of(const Fields& accessor, std::string_view type, std::uint64_t components) const;
  // Returns the elements back to back, with sparse substitutions applied.
  Bytes elements(const Fields& accessor, const Layout& layout);
  void copy_strided(const Fields& accessor, const Layout& layout, Bytes& out);
  void substitute_sparse(const Fields& sparse, const Layout& layout, Bytes& out);
  std::span<const std::byte> buffer_range(const Fields& owner) const;
  const Bytes& decoded_view(std::uint64_t view, const Fields& parent, const Fields& compression);
  void charge(const Fields& owner, std::uint64_t elements, std::uint64_t limit);

  const GltfDocument& document_;
  Fields root_;
  std::uint64_t max_elements_;
  std::uint64_t charged_ = 0;        // elements read so far, of all accessors together
  std::uint64_t decoded_bytes_ = 0;  // held in decoded_
  std::map<std::uint64_t, Bytes> decoded_;
};

}  // namespace pellucid
