// Writes the contents of a model file as text and as JSON. In: a model. Out: text and JSON (docs/json.md).
#include <fmt/format.h>

#include "pellucid/report.h"
#include "report/json.h"

namespace pellucid {
namespace {

const char* name_of(AlphaMode mode) {
  switch (mode) {
    case AlphaMode::opaque:
      return "OPAQUE";
    case AlphaMode::mask:
      return "MASK";
    case AlphaMode::blend:
      return "BLEND";
  }
  return "";
}

const char* name_of(Facing facing) {
  return facing == Facing::single ? "single" : "duplicated";
}

const char* name_of(OrderPurpose purpose) {
  return purpose == OrderPurpose::overdraw ? "overdraw" : "transparency";
}

// Returns the number of patches of an overdraw order set.
std::size_t patch_count(const OrderSet& orders) {
  return orders.patch_offsets.empty() ? orders.base_sequence.size() : orders.patch_offsets.size() - 1;
}

Json json_of(const KeyFrameTable& table, const Model& model) {
  return {{"animation", table.animation},
          {"name", model.animation_names.at(table.animation)},
          {"key_frames", table.times.size()},
          {"first_time", table.times.front()},
          {"last_time", table.times.back()}};
}

// Adds the keys that only overdraw order sets have.
void add_overdraw_keys(Json& json, const OrderSet& orders, const Model& model) {
  if (orders.purpose != OrderPurpose::overdraw) return;
  Json animations = Json::array();
  for (const KeyFrameTable& table : orders.animations) animations.push_back(json_of(table, model));
  json["patch_count"] = patch_count(orders);
  json["model_ranks"] = orders.model_ranks;
  json["animations"] = std::move(animations);
}

Json json_of(const Primitive& primitive, const Model& model) {
  if (!primitive.orders) return nullptr;
  const OrderSet& orders = *primitive.orders;
  Json triangles = Json::array();
  for (const NodeSequence& order : orders.orders) triangles.push_back(order.size());
  Json json = {{"purpose", name_of(orders.purpose)},
               {"partition", to_string(orders.partition)},
               {"cells", orders.cell_orders.size()},
               {"buffer_count", orders.orders.size()},
               {"buffer_triangles", std::move(triangles)},
               {"facing", name_of(orders.facing)},
               {"center", {orders.sphere.center.x, orders.sphere.center.y, orders.sphere.center.z}},
               {"radius", orders.sphere.radius},
               {"valid_from", orders.valid_from},
               {"valid_to", json_distance(orders.valid_to)},
               {"memory_bytes", index_bytes(orders, primitive.mesh)},
               {"error", nullptr}};
  add_overdraw_keys(json, orders, model);
  if (primitive.order_error) {
    const OrderErrorRecord& error = *primitive.order_error;
    Json by_distance = Json::array();
    for (const auto& bin : error.by_distance) {
      by_distance.push_back({{"distance", json_distance(bin.distance)}, {"ipr", bin.ipr}});
    }
    json["error"] = {{"viewpoints", error.viewpoints},
                     {"size", error.size},
                     {"ipr", {{"mean", error.ipr_mean}, {"max", error.ipr_max}}},
                     {"psnr", {{"mean", error.psnr_mean}}},
                     {"by_distance", std::move(by_distance)}};
  }
  return json;
}

std::string shape_of(const MeshReport& check) {
  if (check.triangles == 0) return "empty";
  std::string text = check.closed() ? "closed" : fmt::format("open ({})", check.boundary_edges);
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) text += fmt::format(", {} {}", format_count(count), what);
  };
  add(check.non_manifold_edges, "non-manifold edges");
  add(check.out_of_range, "out of range");
  add(check.non_finite, "not finite");
  add(check.degenerate, "degenerate");
  add(check.duplicate, "duplicate");
  add(check.unreferenced_vertices, "unused vertices");
  return text;
}

std::string overdraw_lines(const OrderSet& orders, const Model& model) {
  std::string text = fmt::format("    for less overdraw: {} patches{}\n", format_count(patch_count(orders)),
                                 orders.model_ranks.empty() ? "" : ", ranked among the model's meshes");
  for (const KeyFrameTable& table : orders.animations) {
    text += fmt::format("    animation {} ({}): {} key frames from {} to {} s\n", table.animation,
                        model.animation_names.at(table.animation), table.times.size(),
                        format_fixed(table.times.front(), 2), format_fixed(table.times.back(), 2));
  }
  return text;
}

std::string order_lines(const Primitive& primitive, const Model& model) {
  const OrderSet& orders = *primitive.orders;
  std::string text = fmt::format(
      "    {} orders over {} ({} cells), facing {}, {} when drawn, valid from {} to {} radii\n",
      orders.orders.size(), to_string(orders.partition), orders.cell_orders.size(), name_of(orders.facing),
      format_bytes(index_bytes(orders, primitive.mesh)), format_fixed(orders.valid_from, 2),
      std::isinf(orders.valid_to) ? "infinity" : format_fixed(orders.valid_to, 2));
  if (orders.purpose == OrderPurpose::overdraw) text += overdraw_lines(orders, model);
  if (primitive.order_error) {
    const OrderErrorRecord& error = *primitive.order_error;
    text += fmt::format("    wrong pixels over {} viewpoints at {}x{}: mean {}, worst {}; PSNR {} dB\n",
                        error.viewpoints, error.size, error.size, format_percent(error.ipr_mean),
                        format_percent(error.ipr_max), format_fixed(error.psnr_mean, 1));
  }
  return text;
}

}  // namespace

std::string inspect_json(const Model& model) {
  Json primitives = Json::array();
  for (const Primitive& primitive : model.primitives) {
    primitives.push_back({{"name", primitive.name},
                          {"mesh", primitive.mesh_index},
                          {"primitive", primitive.primitive_index},
                          {"kind", primitive.triangles ? "triangles" : "other"},
                          {"material", primitive.material_name},
                          {"alpha_mode", name_of(primitive.alpha_mode)},
                          {"base_color", primitive.base_color},
                          {"double_sided", primitive.double_sided},
                          {"deforms", primitive.deforms},
                          {"check", json_of(check(primitive.mesh))},
                          {"orders", json_of(primitive, model)}});
  }
  Json instances = Json::array();
  for (const Instance& instance : model.instances) {
    instances.push_back(
        {{"node", instance.node_name}, {"primitive", instance.primitive}, {"world", instance.world.m}});
  }
  const Json json = {{"schema", kJsonSchema},
                     {"version", library_version()},
                     {"input", model.path},
                     {"format", model.format},
                     {"primitives", std::move(primitives)},
                     {"instances", std::move(instances)},
                     {"animations", model.animation_names},
                     {"notes", model.notes}};
  return dump(json);
}

std::string inspect_text(const Model& model) {
  std::string text =
      fmt::format("{}: {}, {} primitive(s), {} instance(s), {} animation(s)\n", model.path, model.format,
                  model.primitives.size(), model.instances.size(), model.animation_names.size());
  for (std::size_t i = 0; i < model.primitives.size(); ++i) {
    const Primitive& primitive = model.primitives[i];
    if (!primitive.triangles) {
      text += fmt::format("[{}] {}: points or lines\n", i, primitive.name);
      continue;
    }
    const MeshReport report = check(primitive.mesh);
    text += fmt::format("[{}] {}: {} triangles, {} vertices, {}\n", i, primitive.name,
                        format_count(report.triangles), format_count(report.vertices), shape_of(report));
    text += fmt::format("    material {}: {}, alpha {}{}{}\n",
                        primitive.material_name.empty() ? "(none)" : primitive.material_name,
                        name_of(primitive.alpha_mode), format_fixed(primitive.base_color[3], 2),
                        primitive.double_sided ? ", double-sided" : ", single-sided",
                        primitive.deforms ? ", deforms" : "");
    if (primitive.orders) text += order_lines(primitive, model);
  }
  for (const std::string& name : model.animation_names) text += fmt::format("animation: {}\n", name);
  for (const std::string& note : model.notes) text += fmt::format("note: {}\n", note);
  return text;
}

}  // namespace pellucid
