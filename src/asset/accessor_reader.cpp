// Typed elements out of accessors: see accessor_reader.h. Format: glTF 2.0, section 3.6.2.
#include "asset/accessor_reader.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "asset/component.h"
#include "asset/meshopt_view.h"

namespace pellucid {
namespace {

// Keeps every product below far from 2^64.
constexpr std::uint64_t kMostElements = std::uint64_t{1} << 32U;

}  // namespace

AccessorReader::AccessorReader(const GltfDocument& document, const ReadOptions& options)
    : document_(document),
      root_(document.path, document.json, ""),
      max_elements_(std::min(options.max_elements, kMostElements)) {}

std::uint64_t AccessorReader::count(std::uint64_t accessor) const {
  return root_.element("accessors", accessor).index("count");
}

std::uint32_t AccessorReader::restart_value(std::uint64_t accessor) const {
  const std::uint64_t bytes = bytes_of(root_.element("accessors", accessor).index("componentType"));
  return std::numeric_limits<std::uint32_t>::max() >> (32U - 8U * std::clamp<std::uint64_t>(bytes, 1, 4));
}

void AccessorReader::charge(const Fields& owner, std::uint64_t elements, std::uint64_t limit) {
  // Vertices, three corners a triangle, and as much again for attributes and orders: a file may refer to the
  // same bytes many times, so their sum is limited too.
  const std::uint64_t file_limit = 9 * max_elements_;
  if (elements > limit || elements > file_limit - charged_) {
    owner.fail("it asks for " + std::to_string(elements) + " elements; the limit is " +
               std::to_string(max_elements_) + " vertices or triangles a file");
  }
  charged_ += elements;
}

AccessorReader::Layout AccessorReader::layout_of(const Fields& accessor, std::string_view type,
                                                 std::uint64_t components) const {
  Layout layout;
  layout.count = accessor.index("count");
  layout.component_type = accessor.index("componentType");
  layout.component_bytes = bytes_of(layout.component_type);
  layout.normalized = accessor.flag_or("normalized", false);
  if (layout.component_bytes == 0) {
    accessor.fail("componentType " + std::to_string(layout.component_type) + " does not exist");
  }
  const std::string found = accessor.text("type");
  if (found != type) accessor.fail("type is " + found.substr(0, 20) + ", not " + std::string(type));
  layout.element_bytes = layout.component_bytes * components;
  return layout;
}

std::vector<Vec3f> AccessorReader::read_vec3(std::uint64_t index) {
  const Fields source = accessor(index);
  const Layout layout = layout_of(source, "VEC3", 3);
  if (layout.component_type == unsigned_int) source.fail("unsigned 32-bit vectors are not legal glTF");
  charge(source, layout.count, max_elements_);
  const Bytes bytes = elements(source, layout);
  std::vector<Vec3f> values(layout.count);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto component = [&](std::size_t k) {
      return real_at(bytes, i * layout.element_bytes + k * layout.component_bytes, layout.component_type,
                     layout.normalized);
    };
    values[i] = {component(0), component(1), component(2)};
  }
  return values;
}

std::vector<std::uint32_t> AccessorReader::read_scalars(std::uint64_t index) {
  const Fields source = accessor(index);
  const Layout layout = layout_of(source, "SCALAR", 1);
  const bool is_unsigned = layout.component_type == unsigned_byte ||
                           layout.component_type == unsigned_short || layout.component_type == unsigned_int;
  if (!is_unsigned || layout.normalized) source.fail("it does not hold unsigned integers");
  charge(source, layout.count, 3 * max_elements_);
  const Bytes bytes = elements(source, layout);
  std::vector<std::uint32_t> values(layout.count);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = scalar_at(bytes, i * layout.element_bytes, layout.component_type);
  }
  return values;
}

std::vector<float> AccessorReader::read_floats(std::uint64_t index, std::uint64_t components) {
  const Fields source = accessor(index);
  const Layout layout = layout_of(source, components == 1 ? "SCALAR" : "VEC4", components);
  if (layout.component_type != single_float) source.fail("it does not hold floats");
  charge(source, layout.count, max_elements_);
  const Bytes bytes = elements(source, layout);
  std::vector<float> values(layout.count * components);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = real_at(bytes, i * layout.component_bytes, single_float, false);
  }
  return values;
}

AccessorReader::Elements AccessorReader::read_elements(std::uint64_t index) {
  static const std::map<std::string, std::uint64_t> kComponents{
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
  const Fields source = accessor(index);
  Elements result;
  result.type = source.text("type");
  const auto known = kComponents.find(result.type);
  if (known == kComponents.end()) source.fail("type " + result.type.substr(0, 20) + " does not exist");
  Layout layout = layout_of(source, result.type, known->second);
  // Columns of matrices begin at multiples of four bytes (section 3.6.2.4).
  if (result.type == "MAT2" && layout.component_bytes == 1) layout.element_bytes = 8;
  if (result.type == "MAT3" && layout.component_bytes == 1) layout.element_bytes = 12;
  if (result.type == "MAT3" && layout.component_bytes == 2) layout.element_bytes = 24;
  charge(source, layout.count, max_elements_);
  result.component_type = layout.component_type;
  result.component_bytes = layout.component_bytes;
  result.components = known->second;
  result.element_bytes = layout.element_bytes;
  result.normalized = layout.normalized;
  result.bytes = elements(source, layout);
  return result;
}

Bytes AccessorReader::elements(const Fields& accessor, const Layout& layout) {
  // Bounds come before memory: only an accessor without a view may be larger than the file.
  Bytes out;
  if (accessor.has("bufferView")) {
    copy_strided(accessor, layout, out);
  } else {
    out.resize(layout.count * layout.element_bytes);
  }
  if (const auto sparse = accessor.find_object("sparse")) substitute_sparse(*sparse, layout, out);
  return out;
}

void AccessorReader::copy_strided(const Fields& accessor, const Layout& layout, Bytes& out) {
  const std::uint64_t view = accessor.index("bufferView");
  const std::span<const std::byte> bytes = view_bytes(view);
  const std::uint64_t offset = accessor.index_or("byteOffset", 0);
  const std::uint64_t stride =
      root_.element("bufferViews", view).index_or("byteStride", layout.element_bytes);
  if (stride < layout.element_bytes || stride > 252) {
    accessor.fail("byteStride " + std::to_string(stride) + " of bufferViews[" + std::to_string(view) +
                  "] does not fit its elements");
  }
  // count <= 3 * max_elements and stride <= 252: the product cannot overflow; the offset could.
  const std::uint64_t needed = layout.count == 0 ? 0 : (layout.count - 1) * stride + layout.element_bytes;
  if (offset > bytes.size() || needed > bytes.size() - offset) {
    accessor.fail("its " + std::to_string(layout.count) + " elements do not fit into bufferViews[" +
                  std::to_string(view) + "] of " + std::to_string(bytes.size()) + " bytes");
  }
  out.resize(layout.count * layout.element_bytes);
  for (std::size_t i = 0; i < layout.count; ++i) {
    std::memcpy(out.data() + i * layout.element_bytes, bytes.data() + offset + i * stride,
                layout.element_bytes);
  }
}

void AccessorReader::substitute_sparse(const Fields& sparse, const Layout& layout, Bytes& out) {
  const std::uint64_t count = sparse.index("count");
  if (count > layout.count) sparse.fail("count is larger than the accessor's");
  const Fields indices = sparse.object("indices");
  const Fields values = sparse.object("values");

  // Both parts are tightly packed.
  const auto part = [&](const Fields& fields, std::uint64_t element_bytes) {
    const std::span<const std::byte> bytes = view_bytes(fields.index("bufferView"));
    const std::uint64_t offset = fields.index_or("byteOffset", 0);
    if (offset > bytes.size() || count * element_bytes > bytes.size() - offset) {
      fields.fail("its " + std::to_string(count) + " elements do not fit into their bufferView");
    }
    return bytes.subspan(offset, count * element_bytes);
  };
  const std::uint64_t index_type = indices.index("componentType");
  if (index_type != unsigned_byte && index_type != unsigned_short && index_type != unsigned_int) {
    indices.fail("componentType is not an unsigned integer");
  }
  const auto index_bytes = part(indices, bytes_of(index_type));
  const auto value_bytes = part(values, layout.element_bytes);

  const Bytes index_copy(index_bytes.begin(), index_bytes.end());
  std::uint64_t next = 0;  // indices increase strictly
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t at = scalar_at(index_copy, i * bytes_of(index_type), index_type);
    if (at < next || at >= layout.count)
      indices.fail("index " + std::to_string(at) + " is out of range or order");
    next = std::uint64_t{at} + 1;
    std::memcpy(out.data() + at * layout.element_bytes, value_bytes.data() + i * layout.element_bytes,
                layout.element_bytes);
  }
}

std::span<const std::byte> AccessorReader::buffer_range(const Fields& owner) const {
  const std::uint64_t buffer = owner.index("buffer");
  const std::uint64_t offset = owner.index_or("byteOffset", 0);
  const std::uint64_t length = owner.index("byteLength");
  if (buffer >= document_.buffers.size()) owner.fail("buffer " + std::to_string(buffer) + " does not exist");
  const auto& bytes = document_.buffers[buffer].bytes;
  if (bytes == nullptr) owner.fail("buffers[" + std::to_string(buffer) + "] has no data");
  if (offset > bytes->size() || length > bytes->size() - offset) {
    owner.fail("bytes " + std::to_string(offset) + " + " + std::to_string(length) + " are outside buffers[" +
               std::to_string(buffer) + "] of " + std::to_string(bytes->size()) + " bytes");
  }
  return std::span(*bytes).subspan(offset, length);
}

std::span<const std::byte> AccessorReader::view_bytes(std::uint64_t view) {
  const Fields fields = root_.element("bufferViews", view);
  for (const char* name : {kMeshoptExtension, kKhrMeshoptExtension}) {
    if (const auto compression = fields.extension(name)) return decoded_view(view, fields, *compression);
  }
  return buffer_range(fields);
}

const Bytes& AccessorReader::decoded_view(std::uint64_t view, const Fields& parent,
                                          const Fields& compression) {
  if (const auto found = decoded_.find(view); found != decoded_.end()) return found->second;
  const MeshoptView description = describe_meshopt_view(parent, compression);
  const std::span<const std::byte> source = buffer_range(compression);
  const std::uint64_t limit = 16 * max_elements_;
  const std::uint64_t bytes = description.count * description.stride;
  if (bytes > limit || decoded_bytes_ > limit - bytes) {
    compression.fail("decompressed data is larger than the limit of " + std::to_string(limit) +
                     " bytes a file");
  }
  decoded_bytes_ += bytes;
  return decoded_.emplace(view, decode_meshopt_view(description, source, compression)).first->second;
}

}  // namespace pellucid
