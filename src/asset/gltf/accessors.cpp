// Implements accessors.h. EXT_meshopt_compression (Khronos, ratified) is decoded by meshoptimizer. Format:
// glTF 2.0, section 3.6.2.
#include "asset/gltf/accessors.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "asset/gltf/json_fields.h"

namespace pellucid {
namespace {

template <class Component>
Component component_at(const Bytes& bytes, std::size_t at) {
  Component value{};
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

template <class Component>
void put(Component value, Bytes& bytes, std::size_t at) {
  std::memcpy(bytes.data() + at, &value, sizeof(value));
}

template <class Integer>
float to_real(Integer value, bool normalized) {
  if (!normalized) return static_cast<float>(value);
  return std::max(static_cast<float>(value) / static_cast<float>(std::numeric_limits<Integer>::max()), -1.0F);
}

template <class Integer>
Integer from_real(double value, bool normalized) {
  constexpr double kLeast = std::numeric_limits<Integer>::min();
  constexpr double kMost = std::numeric_limits<Integer>::max();
  const double scaled = std::round(normalized ? value * kMost : value);
  return static_cast<Integer>(std::clamp(scaled, normalized && kLeast < 0 ? -kMost : kLeast, kMost));
}

enum class MeshoptMode { attributes, triangles, indices };
enum class MeshoptFilter { none, octahedral, quaternion, exponential };

// A buffer view of EXT_meshopt_compression.
struct MeshoptView {
  std::uint64_t count = 0;
  std::uint64_t stride = 0;  // <= 256
  MeshoptMode mode = MeshoptMode::attributes;
  MeshoptFilter filter = MeshoptFilter::none;
};

// No codec expands 2 bits to more than 16 attribute bytes. The constant also covers headers and tails.
constexpr std::uint64_t kMaxExpansion = 64;
constexpr std::uint64_t kExpansionSlack = 1U << 16U;

MeshoptMode parse_mode(const Fields& compression) {
  const std::string mode = compression.text("mode");
  if (mode == "ATTRIBUTES") return MeshoptMode::attributes;
  if (mode == "TRIANGLES") return MeshoptMode::triangles;
  if (mode == "INDICES") return MeshoptMode::indices;
  compression.fail("mode " + mode.substr(0, 40) + " cannot be decoded");
}

MeshoptFilter parse_filter(const Fields& compression) {
  const std::string filter = compression.text_or("filter", "NONE");
  if (filter == "NONE") return MeshoptFilter::none;
  if (filter == "OCTAHEDRAL") return MeshoptFilter::octahedral;
  if (filter == "QUATERNION") return MeshoptFilter::quaternion;
  if (filter == "EXPONENTIAL") return MeshoptFilter::exponential;
  compression.fail("filter " + filter.substr(0, 40) + " cannot be decoded");
}

bool stride_is_legal(const MeshoptView& view) {
  if (view.mode != MeshoptMode::attributes) {
    return (view.stride == 2 || view.stride == 4) && view.filter == MeshoptFilter::none;
  }
  if (view.stride == 0 || view.stride % 4 != 0 || view.stride > 256) return false;
  if (view.filter == MeshoptFilter::octahedral) return view.stride == 4 || view.stride == 8;
  if (view.filter == MeshoptFilter::quaternion) return view.stride == 8;
  return true;
}

void apply_filter(const MeshoptView& view, Bytes& bytes) {
  switch (view.filter) {
    case MeshoptFilter::none:
      break;
    case MeshoptFilter::octahedral:
      meshopt_decodeFilterOct(bytes.data(), view.count, view.stride);
      break;
    case MeshoptFilter::quaternion:
      meshopt_decodeFilterQuat(bytes.data(), view.count, view.stride);
      break;
    case MeshoptFilter::exponential:
      meshopt_decodeFilterExp(bytes.data(), view.count, view.stride);
      break;
  }
}

// Reads the description of a compressed view. `parent` is the buffer view, `compression` its extension
// object. Fails for what the extension forbids, and for unknown modes and filters.
MeshoptView describe_meshopt_view(const Fields& parent, const Fields& compression) {
  MeshoptView view;
  view.count = compression.index("count");
  view.stride = compression.index("byteStride");
  view.mode = parse_mode(compression);
  view.filter = parse_filter(compression);
  if (!stride_is_legal(view))
    compression.fail("byteStride " + std::to_string(view.stride) + " does not fit its mode");
  if (view.mode == MeshoptMode::triangles && view.count % 3 != 0)
    compression.fail("count is not a multiple of 3");
  const std::uint64_t length = parent.index("byteLength");
  if (view.count > length || view.count * view.stride != length) {
    compression.fail("count * byteStride is not the buffer view's byteLength");
  }
  return view;
}

// Returns count * stride bytes. Fails if `source` cannot be such a stream. Its size is checked before memory
// is allocated.
Bytes decode_meshopt_view(const MeshoptView& view, std::span<const std::byte> source,
                          const Fields& compression) {
  const std::uint64_t size = view.count * view.stride;
  if (size > kMaxExpansion * source.size() + kExpansionSlack) {
    compression.fail("the compressed data is too short for " + std::to_string(view.count) + " elements");
  }
  Bytes bytes(size);
  if (view.count == 0) return bytes;
  const auto* encoded = reinterpret_cast<const unsigned char*>(source.data());
  int error = 0;
  switch (view.mode) {
    case MeshoptMode::attributes:
      error = meshopt_decodeVertexBuffer(bytes.data(), view.count, view.stride, encoded, source.size());
      break;
    case MeshoptMode::triangles:
      error = meshopt_decodeIndexBuffer(bytes.data(), view.count, view.stride, encoded, source.size());
      break;
    case MeshoptMode::indices:
      error = meshopt_decodeIndexSequence(bytes.data(), view.count, view.stride, encoded, source.size());
      break;
  }
  if (error != 0) {
    compression.fail("the compressed data is damaged or in a newer format than can be decoded (code " +
                     std::to_string(error) + ")");
  }
  apply_filter(view, bytes);
  return bytes;
}

// Keeps all products in this file far below 2^64.
constexpr std::uint64_t kMostElements = std::uint64_t{1} << 32U;

}  // namespace

std::uint64_t bytes_of(std::uint64_t component_type) {
  switch (component_type) {
    case signed_byte:
    case unsigned_byte:
      return 1;
    case signed_short:
    case unsigned_short:
      return 2;
    case unsigned_int:
    case single_float:
      return 4;
    default:
      return 0;
  }
}

float real_at(const Bytes& bytes, std::size_t at, std::uint64_t component_type, bool normalized) {
  switch (component_type) {
    case signed_byte:
      return to_real(component_at<std::int8_t>(bytes, at), normalized);
    case unsigned_byte:
      return to_real(component_at<std::uint8_t>(bytes, at), normalized);
    case signed_short:
      return to_real(component_at<std::int16_t>(bytes, at), normalized);
    case unsigned_short:
      return to_real(component_at<std::uint16_t>(bytes, at), normalized);
    default:
      return component_at<float>(bytes, at);
  }
}

std::uint32_t scalar_at(const Bytes& bytes, std::size_t at, std::uint64_t component_type) {
  switch (component_type) {
    case unsigned_byte:
      return component_at<std::uint8_t>(bytes, at);
    case unsigned_short:
      return component_at<std::uint16_t>(bytes, at);
    default:
      return component_at<std::uint32_t>(bytes, at);
  }
}

void store_real(double value, Bytes& bytes, std::size_t at, std::uint64_t component_type, bool normalized) {
  switch (component_type) {
    case signed_byte:
      return put(from_real<std::int8_t>(value, normalized), bytes, at);
    case unsigned_byte:
      return put(from_real<std::uint8_t>(value, normalized), bytes, at);
    case signed_short:
      return put(from_real<std::int16_t>(value, normalized), bytes, at);
    case unsigned_short:
      return put(from_real<std::uint16_t>(value, normalized), bytes, at);
    default:
      return put(static_cast<float>(value), bytes, at);
  }
}

void store_scalar(std::uint32_t value, Bytes& bytes, std::size_t at, std::uint64_t component_type) {
  switch (component_type) {
    case unsigned_byte:
      return put(static_cast<std::uint8_t>(value), bytes, at);
    case unsigned_short:
      return put(static_cast<std::uint16_t>(value), bytes, at);
    default:
      return put(value, bytes, at);
  }
}

Bytes encode_meshopt_indices(std::span<const std::uint32_t> values) {
  const std::uint32_t largest = values.empty() ? 0 : *std::max_element(values.begin(), values.end());
  // The extension requires version 1 of the stream. meshoptimizer keeps the version in a global variable.
  meshopt_encodeIndexVersion(1);
  Bytes bytes(meshopt_encodeIndexSequenceBound(values.size(), std::size_t{largest} + 1));
  const std::size_t used = meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(bytes.data()),
                                                       bytes.size(), values.data(), values.size());
  bytes.resize(used);
  return bytes;
}

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
  // The limit covers vertices, three corners per triangle, and the same again for attributes and orders. A
  // file may refer to the same bytes many times, so the sum is limited, too.
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

std::vector<float> AccessorReader::read_reals(std::uint64_t index, const std::string& type) {
  const Elements source = read_elements(index);
  const Fields fields = accessor(index);
  if (source.type != type) fields.fail("type is " + source.type + ", not " + type);
  const bool integers = source.component_type != single_float;
  if (integers && (!source.normalized || source.component_bytes > 2))
    fields.fail("it holds neither floats nor normalised 8- or 16-bit integers");
  std::vector<float> values(source.count() * source.components);
  for (std::size_t i = 0; i < source.count(); ++i) {
    for (std::size_t k = 0; k < source.components; ++k) {
      values[i * source.components + k] =
          real_at(source.bytes, i * source.element_bytes + k * source.component_bytes, source.component_type,
                  source.normalized);
    }
  }
  return values;
}

Bytes AccessorReader::elements(const Fields& accessor, const Layout& layout) {
  // Bounds are checked before memory is allocated. Only an accessor without a view may be larger than the
  // file.
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

std::ptrdiff_t find_non_finite(std::span<const float> values) {
  const auto found = std::find_if(values.begin(), values.end(), [](float v) { return !std::isfinite(v); });
  return found == values.end() ? -1 : found - values.begin();
}

}  // namespace pellucid
