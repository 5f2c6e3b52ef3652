// The order extension out: see order_extension.h.
#include <cmath>

#include "order_extension.h"

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

}  // namespace

Json order_extension_json(const OrderSet& set, const std::optional<OrderErrorRecord>& error,
                          SortDirection direction, const OrderAccessors& accessors) {
  Json extension;
  extension["version"] = kOrderExtensionVersion;
  extension["generator"] = "pellucid " PELLUCID_VERSION;
  extension["sorting"] = direction == SortDirection::back_to_front ? "backToFront" : "frontToBack";
  extension["facing"] = set.facing == Facing::duplicated ? "duplicated" : "single";
  extension["partition"] = partition_json(set);
  extension["cellOrders"] = accessors.cell_orders;
  Json orders = Json::array();
  for (const auto& accessor : accessors.orders) {
    Json order = Json::object();
    if (accessor) order[accessors.encoding == OrderEncoding::indices ? "indices" : "patches"] = *accessor;
    orders.push_back(std::move(order));
  }
  extension["orders"] = std::move(orders);
  if (error) extension["error"] = error_json(*error);
  return extension;
}

std::vector<std::uint32_t> stored_cell_orders(const OrderSet& set) {
  if (has_triangle_cells(set.partition)) return set.cell_orders;
  const Icosphere sphere = make_icosphere(set.partition.level);
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * sphere.triangles.size());
  for (const auto& triangle : sphere.triangles) {
    for (const std::uint32_t vertex : triangle) corners.push_back(set.cell_orders[vertex]);
  }
  return corners;
}

}  // namespace pellucid
