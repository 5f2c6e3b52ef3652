// Implements the functions of the C interface for model files: reads and writes them, and describes their
// primitives. In: what C passes. Out: the same as the functions of pellucid/pellucid.h.
#include <algorithm>

#include "c/wrapper.h"

namespace pellucid::c {
namespace {

static_assert(sizeof(Vec3f) == 3 * sizeof(float) && sizeof(Triangle) == 3 * sizeof(std::uint32_t),
              "handed out as arrays of their elements");

PellucidAlphaMode alpha_mode_of(AlphaMode mode) {
  switch (mode) {
    case AlphaMode::opaque:
      return pellucid_alpha_opaque;
    case AlphaMode::mask:
      return pellucid_alpha_mask;
    case AlphaMode::blend:
      break;
  }
  return pellucid_alpha_blend;
}

PellucidPrimitive describe(const Primitive& primitive) {
  PellucidPrimitive description{};
  description.name = primitive.name.c_str();
  description.mesh.positions = primitive.mesh.positions.empty() ? nullptr : &primitive.mesh.positions[0].x;
  description.mesh.vertex_count = static_cast<std::uint32_t>(primitive.mesh.positions.size());
  description.mesh.indices = primitive.mesh.triangles.data();
  description.mesh.index_bytes = sizeof(std::uint32_t);
  description.mesh.triangle_count = static_cast<std::uint32_t>(primitive.mesh.triangles.size());
  description.double_sided = primitive.double_sided ? 1 : 0;
  description.deforms = primitive.deforms ? 1 : 0;
  description.alpha_mode = alpha_mode_of(primitive.alpha_mode);
  std::copy(primitive.base_color.begin(), primitive.base_color.end(), description.base_color);
  description.has_orders = primitive.orders ? 1 : 0;
  return description;
}

WriteOptions write_options(const PellucidWriteOptions& given) {
  WriteOptions options;
  switch (given.encoding) {
    case pellucid_encoding_indices:
      options.encoding = OrderEncoding::indices;
      break;
    case pellucid_encoding_patches:
      options.encoding = OrderEncoding::patches;
      break;
    case pellucid_encoding_meshopt:
      options.encoding = OrderEncoding::meshopt;
      break;
    default:
      require(false, "encoding: there is no such value");
  }
  require(given.direction == pellucid_front_to_back || given.direction == pellucid_back_to_front,
          "direction: there is no such value");
  options.direction =
      given.direction == pellucid_back_to_front ? SortDirection::back_to_front : SortDirection::front_to_back;
  options.split_buffer = given.split_buffer != 0;
  options.bake_base = given.keep_indices == 0;
  return options;
}

}  // namespace
}  // namespace pellucid::c

using namespace pellucid::c;  // NOLINT(google-build-using-namespace): below are C functions

PellucidStatus pellucid_read_model(const char* path, PellucidModel** model) {
  return guarded([&] {
    require(model != nullptr, "model is null");
    *model = nullptr;
    require(path != nullptr, "path is null");
    *model = new PellucidModel{pellucid::read(path)};
  });
}

void pellucid_free_model(PellucidModel* model) {
  delete model;
}

uint32_t pellucid_primitive_count(const PellucidModel* model) {
  return model == nullptr ? 0 : static_cast<uint32_t>(model->model.primitives.size());
}

PellucidStatus pellucid_model_primitive(const PellucidModel* model, uint32_t primitive,
                                        PellucidPrimitive* description, size_t struct_size) {
  return guarded([&] {
    require(model != nullptr, "model is null");
    require(primitive < model->model.primitives.size(), "there is no such primitive");
    require(description != nullptr, "description is null");
    copy_out(describe(model->model.primitives[primitive]), description, struct_size);
  });
}

PellucidStatus pellucid_model_orders(const PellucidModel* model, uint32_t primitive,
                                     PellucidOrderSet** orders) {
  return guarded([&] {
    require(orders != nullptr, "orders is null");
    *orders = nullptr;
    require(model != nullptr, "model is null");
    *orders = new PellucidOrderSet{pellucid::orders_of(model->model, primitive)};
  });
}

PellucidStatus pellucid_model_set_orders(PellucidModel* model, uint32_t primitive,
                                         const PellucidOrderSet* orders) {
  return guarded([&] {
    require(model != nullptr, "model is null");
    require(primitive < model->model.primitives.size(), "there is no such primitive");
    if (orders != nullptr) {
      pellucid::set_orders(model->model, primitive, orders->mesh);
    } else {
      model->model.primitives[primitive].orders.reset();
      model->model.primitives[primitive].order_error.reset();
    }
  });
}

void pellucid_write_options_init(PellucidWriteOptions* options, size_t struct_size) {
  PellucidWriteOptions set{};
  set.struct_size = struct_size;
  if (options != nullptr) copy_out(set, options, struct_size);
}

PellucidStatus pellucid_write_model(const PellucidModel* model, const char* path,
                                    const PellucidWriteOptions* options) {
  return guarded([&] {
    require(model != nullptr && path != nullptr, "model or path is null");
    pellucid::write(model->model, path, write_options(settled(options, pellucid_write_options_init)));
  });
}
