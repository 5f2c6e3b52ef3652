// Internal to the module `asset`: typed elements out of glTF accessors, whatever their form: strided, sparse,
// quantised, meshopt-compressed. Bounds are checked in 64-bit arithmetic before anything is allocated.
#pragma once

#include <map>
#include <span>

#include "asset/gltf_document.h"
#include "asset/json_fields.h"

namespace pellucid {

class AccessorReader {
 public:
  AccessorReader(const GltfDocument& document, const ReadOptions& options);

  // VEC3, float or (KHR_mesh_quantization) 8- or 16-bit integers, normalised or not.
  std::vector<Vec3f> read_vec3(std::uint64_t accessor);
  // SCALAR, unsigned 8-, 16- or 32-bit, not normalised.
  std::vector<std::uint32_t> read_scalars(std::uint64_t accessor);

  // float, SCALAR (components = 1) or VEC4 (4), back to back.
  std::vector<float> read_floats(std::uint64_t accessor, std::uint64_t components);

  // Count elements that are made from others towards the limit of the file.
  void charge(const Fields& owner, std::uint64_t elements) { charge(owner, elements, 9 * max_elements_); }

  // Of any type, as stored, back to back: strides, sparse parts and compression resolved.
  struct Elements {
    std::string type;  // "VEC3"
    std::uint64_t component_type = 0, component_bytes = 0, components = 0;
    std::uint64_t element_bytes = 0;
    bool normalized = false;
    Bytes bytes;
    [[nodiscard]] std::uint64_t count() const { return bytes.size() / element_bytes; }
  };
  Elements read_elements(std::uint64_t accessor);
  // Of a buffer view, decompressed where it is compressed.
  std::span<const std::byte> view_bytes(std::uint64_t view);

  [[nodiscard]] std::uint64_t count(std::uint64_t accessor) const;
  // Largest value of the component type of an index accessor: glTF forbids it as an index ("primitive
  // restart").
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
  // Elements back to back, sparse substitutions done.
  Bytes elements(const Fields& accessor, const Layout& layout);
  void copy_strided(const Fields& accessor, const Layout& layout, Bytes& out);
  void substitute_sparse(const Fields& sparse, const Layout& layout, Bytes& out);
  std::span<const std::byte> buffer_range(const Fields& owner) const;
  const Bytes& decoded_view(std::uint64_t view, const Fields& parent, const Fields& compression);
  void charge(const Fields& owner, std::uint64_t elements, std::uint64_t limit);

  const GltfDocument& document_;
  Fields root_;
  std::uint64_t max_elements_;
  std::uint64_t charged_ = 0;        // elements read so far, all accessors together
  std::uint64_t decoded_bytes_ = 0;  // held in decoded_
  std::map<std::uint64_t, Bytes> decoded_;
};

}  // namespace pellucid
