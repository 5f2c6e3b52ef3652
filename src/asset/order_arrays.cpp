// The arrays of order sets out: see order_arrays.h.
#include "asset/order_arrays.h"

#include <algorithm>
#include <bit>

#include "asset/component.h"
#include "asset/meshopt_view.h"

namespace pellucid {
namespace {

Bytes pack_floats(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits;
  bits.reserve(values.size());
  for (const float value : values) bits.push_back(std::bit_cast<std::uint32_t>(value));
  return pack(bits, IndexWidth::four_bytes);
}

// Vertex indices, three a triangle.
std::vector<std::uint32_t> corner_values(const NodeSequence& order, const Mesh& mesh) {
  std::vector<std::uint32_t> values;
  values.reserve(3 * order.size());
  for (const NodeId node : order) {
    const Triangle corners = corners_of(mesh, node);
    values.insert(values.end(), corners.begin(), corners.end());
  }
  return values;
}

// Ids of patches, and with `patch_offsets` empty of triangles, in primitive.indices as written.
class PatchNumbers {
 public:
  PatchNumbers(std::span<const std::uint32_t> base, std::size_t triangles,
               const std::vector<std::uint32_t>& patch_offsets)
      : triangles_(static_cast<std::uint32_t>(base.size())), offsets_(patch_offsets) {
    position_.resize(triangles, 0);
    for (std::uint32_t i = 0; i < base.size(); ++i) position_[base[i]] = i;
  }

  [[nodiscard]] std::uint32_t count() const {
    return offsets_.empty() ? triangles_ : static_cast<std::uint32_t>(offsets_.size() - 1);
  }

  [[nodiscard]] std::vector<std::uint32_t> ids_of(const NodeSequence& order) const {
    std::vector<std::uint32_t> ids;
    for (std::size_t i = 0; i < order.size();) {
      const std::uint32_t at = position_[triangle_of(order[i])];
      if (offsets_.empty()) {
        ids.push_back(at + (is_flipped(order[i]) ? triangles_ : 0));
        ++i;
      } else {
        // An order is made of whole patches: `at` begins one.
        const auto patch = std::lower_bound(offsets_.begin(), offsets_.end(), at);
        ids.push_back(static_cast<std::uint32_t>(patch - offsets_.begin()));
        i += *(patch + 1) - *patch;
      }
    }
    return ids;
  }

 private:
  std::uint32_t triangles_;
  const std::vector<std::uint32_t>& offsets_;
  std::vector<std::uint32_t> position_;  // of every triangle in the base
};

}  // namespace

OrderAccessors OrderArrayWriter::write(const OrderSet& set, const Mesh& mesh,
                                       std::span<const std::uint32_t> base, OrderEncoding encoding) {
  const bool overdraw = set.purpose == OrderPurpose::overdraw;
  const bool indices = encoding == OrderEncoding::indices;
  const bool reversed = options_.direction == SortDirection::back_to_front && !overdraw;
  const PatchNumbers patches(base, mesh.triangles.size(), set.patch_offsets);
  std::vector<std::vector<std::uint32_t>> stored;
  for (const NodeSequence& order : set.orders) {
    NodeSequence drawn = order;
    if (reversed) std::reverse(drawn.begin(), drawn.end());
    stored.push_back(indices ? corner_values(drawn, mesh) : patches.ids_of(drawn));
  }
  const std::uint64_t ids = std::uint64_t{patches.count()} * (overdraw ? 1 : 2);
  const IndexWidth width =
      indices ? vertex_index_width(mesh.positions.size()) : std::max(value_width(ids), IndexWidth::two_bytes);

  OrderAccessors accessors;
  accessors.encoding = encoding;
  append_orders(set, stored, width, accessors);
  accessors.cell_orders = append_cell_orders(set, set.cell_orders);
  if (!indices && !set.patch_offsets.empty()) {
    accessors.patch_offsets =
        append_values(set.patch_offsets, value_width(std::uint64_t{set.patch_offsets.back()} + 1));
  }
  for (const KeyFrameTable& table : set.animations) {
    accessors.animations.push_back(append_key_frames(set, table));
  }
  return accessors;
}

// All orders of a primitive lie in one view, so that a renderer makes one buffer of them.
void OrderArrayWriter::append_orders(const OrderSet& set,
                                     const std::vector<std::vector<std::uint32_t>>& stored, IndexWidth width,
                                     OrderAccessors& accessors) {
  accessors.orders.resize(set.orders.size());
  std::vector<std::uint32_t> values;
  for (const auto& order : stored) values.insert(values.end(), order.begin(), order.end());
  if (values.empty()) return;
  const std::uint64_t view = append_order_view(values, width, accessors.encoding);
  std::size_t begin = 0;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (stored[i].empty()) continue;
    accessors.orders[i] = editor_.append_accessor(view, begin * bytes_of(width), width, stored[i].size());
    begin += stored[i].size();
  }
}

std::uint64_t OrderArrayWriter::side_buffer(const std::string& suffix) {
  const std::string name = stem_ + suffix;
  const auto known = std::find(side_names_.begin(), side_names_.end(), name);
  if (known != side_names_.end()) return static_cast<std::uint64_t>(known - side_names_.begin());
  const std::uint64_t buffer = editor_.append_buffer(BufferStorage::external);
  side_names_.resize(buffer + 1);
  side_names_[buffer] = name;
  return buffer;
}

std::uint64_t OrderArrayWriter::order_buffer() {
  return options_.split_buffer ? side_buffer(".orders.bin") : editor_.host_buffer();
}

std::uint64_t OrderArrayWriter::append_order_view(const std::vector<std::uint32_t>& values, IndexWidth width,
                                                  OrderEncoding encoding) {
  const Bytes bytes = pack(values, width);
  if (encoding != OrderEncoding::meshopt) {
    order_bytes_ += bytes.size();
    return editor_.append_view(editor_.append_bytes(order_buffer(), bytes));
  }
  const Bytes compressed = encode_meshopt_indices(values);
  order_bytes_ += compressed.size();
  const auto stored = editor_.append_bytes(order_buffer(), compressed);
  const std::uint64_t fallback = side_buffer(".orders-fallback.bin");
  editor_.document().json["buffers"][fallback]["extensions"][kMeshoptExtension]["fallback"] = true;
  editor_.declare_extension(kMeshoptExtension);
  return editor_.append_compressed_view(editor_.append_bytes(fallback, bytes), stored, width);
}

// A new accessor, or an earlier one of the same content.
std::uint64_t OrderArrayWriter::shared_accessor(const char* type, std::uint32_t component_type,
                                                std::uint64_t count, const Bytes& bytes) {
  const auto [entry, is_new] = shared_.try_emplace({type, component_type, bytes}, 0);
  if (!is_new) return entry->second;
  order_bytes_ += bytes.size();
  Json accessor;
  accessor["bufferView"] = editor_.append_view(editor_.append_bytes(order_buffer(), bytes));
  accessor["componentType"] = component_type;
  accessor["count"] = count;
  accessor["type"] = type;
  entry->second = editor_.append_accessor(std::move(accessor));
  return entry->second;
}

std::uint64_t OrderArrayWriter::append_values(const std::vector<std::uint32_t>& values, IndexWidth width) {
  return shared_accessor("SCALAR", static_cast<std::uint32_t>(width), values.size(), pack(values, width));
}

std::uint64_t OrderArrayWriter::append_cell_orders(const OrderSet& set,
                                                   std::span<const std::uint32_t> cell_orders) {
  return append_values(stored_cell_orders(set.partition, cell_orders), value_width(set.orders.size()));
}

OrderAccessors::KeyFrames OrderArrayWriter::append_key_frames(const OrderSet& set,
                                                              const KeyFrameTable& table) {
  std::vector<float> times;
  std::vector<float> spheres;
  for (const double time : table.times) times.push_back(static_cast<float>(time));
  for (const BoundingSphere& sphere : table.spheres) {
    const Vec3f center = to_float(sphere.center);
    spheres.insert(spheres.end(), {center.x, center.y, center.z, static_cast<float>(sphere.radius)});
  }
  OrderAccessors::KeyFrames accessors;
  accessors.times = shared_accessor("SCALAR", single_float, times.size(), pack_floats(times));
  accessors.spheres = shared_accessor("VEC4", single_float, table.spheres.size(), pack_floats(spheres));
  accessors.cell_orders = append_cell_orders(set, table.cell_orders);
  return accessors;
}

}  // namespace pellucid
