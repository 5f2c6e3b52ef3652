// The order extension out: see order_extension.h.
#include <cmath>

#include "asset/order_extension.h"

namespace pellucid {
namespace {

// JSON has no infinity: null stands for it.
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

}  // namespace

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

}  // namespace pellucid
