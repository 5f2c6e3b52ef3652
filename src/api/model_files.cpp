// Implements the functions of pellucid/pellucid.h for files: reads a model, orders its translucent primitives
// and writes it. Orders are kept in the primitives of the model.
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "pellucid/pellucid.h"

namespace pellucid {
namespace {

const Primitive& primitive_at(const Model& model, std::uint32_t primitive) {
  if (primitive < model.primitives.size()) return model.primitives[primitive];
  throw Error(ErrorKind::bad_argument, model.path + ": there is no primitive " + std::to_string(primitive) +
                                           ", there are " + std::to_string(model.primitives.size()));
}

// Formats other than glTF do not say which sides of a face are shown.
Facing facing_of(const Model& model, const Primitive& primitive, Facing otherwise) {
  if (model.format != "gltf" && model.format != "glb") return otherwise;
  return primitive.double_sided ? Facing::duplicated : Facing::single;
}

}  // namespace

Model read(const std::string& path, const ReadOptions& options) {
  return read_model(path, options);
}

WriteReport write(const Model& model, const std::string& path, const WriteOptions& options) {
  std::vector<OrderedPrimitive> ordered;
  for (std::uint32_t i = 0; i < model.primitives.size(); ++i) {
    const Primitive& primitive = model.primitives[i];
    if (primitive.orders) ordered.push_back({i, *primitive.orders, primitive.order_error});
  }
  return write_model(model, ordered, path, options);
}

namespace {

OrderedMesh ordered_primitive(const Model& model, std::uint32_t primitive, const OrderOptions& options) {
  const Primitive& chosen = primitive_at(model, primitive);
  if (chosen.deforms) {
    throw Error(ErrorKind::bad_argument, model.path + ": " + chosen.name +
                                             " is skinned or morphed, and static orders do not hold for it");
  }
  OrderOptions own = options;
  own.facing = facing_of(model, chosen, options.facing);
  return order_any_mesh(chosen.mesh, own, {}, model.path + ": " + chosen.name);
}

}  // namespace

OrderedMesh order_primitive(Model& model, std::uint32_t primitive, const OrderOptions& options) {
  OrderedMesh ordered = ordered_primitive(model, primitive, options);
  set_orders(model, primitive, ordered);
  return ordered;
}

std::vector<std::uint32_t> order(Model& model, const OrderOptions& options) {
  std::vector<std::uint32_t> translucent;
  for (std::uint32_t i = 0; i < model.primitives.size(); ++i) {
    const Primitive& primitive = model.primitives[i];
    const bool has_faces = primitive.triangles && !primitive.mesh.triangles.empty();
    if (has_faces && !primitive.deforms && primitive.alpha_mode == AlphaMode::blend) translucent.push_back(i);
  }
  if (translucent.empty()) {
    throw Error(
        ErrorKind::nothing_to_do,
        model.path + ": no static primitive is drawn with alpha blending; others are ordered one by one");
  }
  // An error leaves the model as it was.
  std::vector<OrderedMesh> made;
  made.reserve(translucent.size());
  for (const std::uint32_t i : translucent) made.push_back(ordered_primitive(model, i, options));
  for (std::size_t i = 0; i < made.size(); ++i) set_orders(model, translucent[i], made[i]);
  return translucent;
}

OrderedMesh orders_of(const Model& model, std::uint32_t primitive) {
  const Primitive& chosen = primitive_at(model, primitive);
  if (!chosen.orders)
    throw Error(ErrorKind::nothing_to_do, model.path + ": " + chosen.name + ": it has no orders");
  OrderedMeshReport report;
  report.mesh.vertices = chosen.mesh.positions.size();
  report.mesh.triangles = chosen.mesh.triangles.size();
  if (chosen.order_error) report.measured_error = chosen.order_error->ipr_mean;
  return {*chosen.orders, chosen.mesh, report};
}

void set_orders(Model& model, std::uint32_t primitive, const OrderedMesh& orders) {
  const Primitive& chosen = primitive_at(model, primitive);
  const auto refuse = [&](const char* reason) {
    throw Error(ErrorKind::bad_argument, model.path + ": " + chosen.name + ": " + reason);
  };
  if (orders.orders().purpose != OrderPurpose::transparency)
    refuse("overdraw orders of a mesh do not know the other meshes of the model");
  if (orders.triangles() != chosen.mesh.triangles || orders.vertex_count() != chosen.mesh.positions.size())
    refuse("the orders are not of this primitive");
  model.primitives[primitive].orders = orders.orders();
  model.primitives[primitive].order_error.reset();
}

}  // namespace pellucid
