// Cameras of a glTF model: see pellucid/model_camera.h.
#include <cmath>

#include "asset/formats/text_cursor.h"
#include "asset/gltf_scene.h"
#include "pellucid/model_camera.h"

namespace pellucid {
namespace {

double positive(const Fields& fields, const char* key) {
  const double value = fields.number(key);
  if (!(value > 0) || !std::isfinite(value)) fields.fail(std::string(key) + " is not a positive number");
  return value;
}

ModelCamera read_camera(const Fields& fields) {
  ModelCamera camera;
  camera.name = short_name(fields.text_or("name", ""));
  const std::string type = fields.text("type");
  if (type == "perspective") {
    const Fields lens = fields.object("perspective");
    const double angle = positive(lens, "yfov");
    if (angle > 3.1) lens.fail("yfov is not an angle of view in radians");
    camera.half_height = std::tan(0.5 * angle);
  } else if (type == "orthographic") {
    camera.perspective = false;
    camera.half_height = positive(fields.object("orthographic"), "ymag");
  } else {
    fields.fail("type " + in_quotes(type) + " does not exist");
  }
  return camera;
}

}  // namespace

std::vector<ModelCamera> read_cameras(const Model& model) {
  std::vector<ModelCamera> cameras;
  if (model.document == nullptr) return cameras;
  const Fields root(model.document->path, model.document->json, "");
  for_each_node(root, [&](const Fields& node, std::uint64_t /*index*/, const Mat4& world) {
    const auto index = node.find_index("camera");
    if (!index) return;
    ModelCamera camera = read_camera(root.element("cameras", *index));
    if (camera.name.empty()) camera.name = short_name(node.text_or("name", ""));
    camera.world = world;
    cameras.push_back(std::move(camera));
  });
  return cameras;
}

}  // namespace pellucid
