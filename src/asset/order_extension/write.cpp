// Implements OrderArrayWriter and order_extension_json() of order_extension.h: writes the order extension.
#include <algorithm>
#include <bit>
#include <cmath>

#include "asset/gltf/accessors.h"
#include "asset/order_extension/order_extension.h"

namespace pellucid {
namespace {

Bytes pack_floats(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits;
  bits.reserve(values.size());
  for (const float value : values) bits.push_back(std::bit_cast<std::uint32_t>(value));
  return pack(bits, ComponentWidth::four_bytes);
}

// Returns the vertex indices of an order, three per triangle.
std::vector<std::uint32_t> corner_values(const NodeSequence& order, const Mesh& mesh) {
  std::vector<std::uint32_t> values;
  values.reserve(3 * order.size());
  for (const NodeId node : order) {
    const Triangle corners = corners_of(mesh, node);
    values.insert(values.end(), corners.begin(), corners.end());
  }
  return values;
}

// Numbers patches by their position in primitive.indices as written. If `patch_offsets` is empty, every
// triangle is a patch.
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
        // An order consists of whole patches, and `at` begins one.
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

// JSON has no infinity; null stands for it.
Json finite_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json partition_json(const OrderSet& set) {
  const bool triangles = has_triangle_cells(set.partition);
  Json partition;
  partition["type"] = "icosphere";
  partition["level"] = set.partition.level;
  partition["cells"] = triangles ? "triangles" : "vertices";
  if (triangles) partition["sampleLevel"] = set.partition.sample_level;
  if (set.partition.kind == PartitionKind::view_triangles) partition["coverage"] = "triangle";
  if (set.partition.kind == PartitionKind::view_regions) partition["coverage"] = "region";
  partition["center"] = {set.sphere.center.x, set.sphere.center.y, set.sphere.center.z};
  partition["radius"] = set.sphere.radius;
  partition["minDistance"] = set.valid_from;
  if (std::isfinite(set.valid_to)) partition["maxDistance"] = set.valid_to;
  return partition;
}

Json error_json(const OrderErrorRecord& record) {
  Json error;
  error["metric"] = "wrongPixels";
  error["views"] = record.viewpoints;
  error["size"] = record.size;
  error["mean"] = record.ipr_mean;
  error["max"] = record.ipr_max;
  error["psnr"] = finite_or_null(record.psnr_mean);
  if (!record.by_distance.empty()) {
    Json pairs = Json::array();
    for (const auto& entry : record.by_distance) {
      pairs.push_back(Json::array({finite_or_null(entry.distance), entry.ipr}));
    }
    error["byDistance"] = std::move(pairs);
  }
  return error;
}

Json orders_json(const OrderSet& set, const OrderAccessors& accessors) {
  const char* key = accessors.encoding == OrderEncoding::indices ? "indices" : "patches";
  Json orders = Json::array();
  for (std::size_t i = 0; i < accessors.orders.size(); ++i) {
    Json order = Json::object();
    if (accessors.orders[i]) order[key] = *accessors.orders[i];
    if (!set.model_ranks.empty()) order["rank"] = set.model_ranks[i];
    orders.push_back(std::move(order));
  }
  return orders;
}

Json key_frames_json(const OrderSet& set, const OrderAccessors& accessors) {
  Json tables = Json::array();
  for (std::size_t i = 0; i < set.animations.size(); ++i) {
    Json table;
    table["animation"] = set.animations[i].animation;
    table["times"] = accessors.animations[i].times;
    table["spheres"] = accessors.animations[i].spheres;
    table["cellOrders"] = accessors.animations[i].cell_orders;
    tables.push_back(std::move(table));
  }
  return tables;
}

// Returns the rows of a cell table as they are stored: one entry per view triangle. For P[n] there is one per
// corner of each triangle of the icosphere, so that a reader needs no numbering of vertices.
std::vector<std::uint32_t> stored_cell_orders(const PartitionSpec& partition,
                                              std::span<const std::uint32_t> cell_orders) {
  if (has_triangle_cells(partition)) return {cell_orders.begin(), cell_orders.end()};
  const Icosphere sphere = make_icosphere(partition.level);
  std::vector<std::uint32_t> corners;
  for (std::size_t row = 0; row < cell_orders.size(); row += sphere.vertices.size()) {
    for (const auto& triangle : sphere.triangles) {
      for (const std::uint32_t vertex : triangle) corners.push_back(cell_orders[row + vertex]);
    }
  }
  return corners;
}

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
  const ComponentWidth width = indices ? vertex_index_width(mesh.positions.size())
                                       : std::max(value_width(ids), ComponentWidth::two_bytes);

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

// All orders of a primitive are in one view, so that a renderer can upload them as one buffer.
void OrderArrayWriter::append_orders(const OrderSet& set,
                                     const std::vector<std::vector<std::uint32_t>>& stored,
                                     ComponentWidth width, OrderAccessors& accessors) {
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

std::uint64_t OrderArrayWriter::append_order_view(const std::vector<std::uint32_t>& values,
                                                  ComponentWidth width, OrderEncoding encoding) {
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

// Returns a new accessor, or an earlier one with the same content.
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

std::uint64_t OrderArrayWriter::append_values(const std::vector<std::uint32_t>& values,
                                              ComponentWidth width) {
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

Json order_extension_json(const OrderSet& set, const std::optional<OrderErrorRecord>& error,
                          SortDirection direction, const OrderAccessors& accessors) {
  const bool overdraw = set.purpose == OrderPurpose::overdraw;
  Json extension;
  extension["version"] = kOrderExtensionVersion;
  extension["generator"] = "pellucid " PELLUCID_VERSION;
  if (overdraw) extension["purpose"] = "overdraw";
  const bool reversed = direction == SortDirection::back_to_front && !overdraw;
  extension["sorting"] = reversed ? "backToFront" : "frontToBack";
  extension["facing"] = set.facing == Facing::duplicated ? "duplicated" : "single";
  extension["partition"] = partition_json(set);
  extension["cellOrders"] = accessors.cell_orders;
  if (accessors.patch_offsets) extension["patchOffsets"] = *accessors.patch_offsets;
  extension["orders"] = orders_json(set, accessors);
  if (!set.animations.empty()) extension["keyframes"] = key_frames_json(set, accessors);
  if (error) extension["error"] = error_json(*error);
  return extension;
}

}  // namespace pellucid
