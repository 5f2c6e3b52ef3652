// One glTF mesh primitive: triangles of any form, material, orders. Format: glTF 2.0, section 3.7.2.
#include "asset/gltf_primitive.h"

#include <limits>

#include "asset/order_extension.h"

namespace pellucid {
namespace {

enum Mode : std::uint64_t { triangle_list = 4, triangle_strip = 5, triangle_fan = 6, last_mode = 6 };

// Corner sequences of the three topologies (section 3.7.2.1).
std::vector<Triangle> assemble(const Fields& primitive, std::uint64_t mode,
                               const std::vector<std::uint32_t>& v) {
  std::vector<Triangle> triangles;
  if (mode == triangle_list) {
    if (v.size() % 3 != 0) {
      primitive.fail("it lists triangles, but its " + std::to_string(v.size()) +
                     " corners are no multiple of 3");
    }
    triangles.resize(v.size() / 3);
    for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
    return triangles;
  }
  if (v.size() < 3) return triangles;
  triangles.resize(v.size() - 2);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (mode == triangle_strip) {
      triangles[i] = {v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]};
    } else {
      triangles[i] = {v[i + 1], v[i + 2], v[0]};
    }
  }
  return triangles;
}

// Without indices the vertices follow each other.
std::vector<std::uint32_t> read_corners(const Fields& primitive, AccessorReader& accessors,
                                        std::uint64_t vertices) {
  const auto indices = primitive.find_index("indices");
  std::vector<std::uint32_t> corners;
  if (!indices) {
    corners.resize(vertices);
    for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i);
    return corners;
  }
  corners = accessors.read_scalars(*indices);
  const std::uint32_t restart = accessors.restart_value(*indices);
  for (const std::uint32_t corner : corners) {
    if (corner < vertices && corner != restart) continue;
    const bool is_restart = corner == restart;
    accessors.accessor(*indices).fail(
        "index " + std::to_string(corner) + " of " + primitive.place() +
        (is_restart ? " is the primitive restart value, which glTF forbids"
                    : " is out of range: there are " + std::to_string(vertices) + " vertices"));
  }
  return corners;
}

// Unit length, as Mesh promises; quantised normals are only nearly so.
void normalize(std::vector<Vec3f>& normals) {
  for (Vec3f& normal : normals) normal = to_float(normalized(to_double(normal)));
}

void read_geometry(const Fields& fields, AccessorReader& accessors, std::uint64_t mode,
                   Primitive& primitive) {
  const Fields attributes = fields.object("attributes");
  primitive.mesh.positions = accessors.read_vec3(attributes.index("POSITION"));
  const std::uint64_t vertices = primitive.mesh.positions.size();
  if (const auto normals = attributes.find_index("NORMAL")) {
    if (accessors.count(*normals) != vertices) {
      fields.fail("it has " + std::to_string(accessors.count(*normals)) + " normals for " +
                  std::to_string(vertices) + " positions");
    }
    primitive.mesh.normals = accessors.read_vec3(*normals);
    normalize(primitive.mesh.normals);
  }
  primitive.mesh.triangles = assemble(fields, mode, read_corners(fields, accessors, vertices));
}

AlphaMode parse_alpha_mode(const Fields& material) {
  const std::string mode = material.text_or("alphaMode", "OPAQUE");
  if (mode == "OPAQUE") return AlphaMode::opaque;
  if (mode == "MASK") return AlphaMode::mask;
  if (mode == "BLEND") return AlphaMode::blend;
  material.fail("alphaMode " + mode.substr(0, 20) + " does not exist");
}

void read_material(const Fields& root, const Fields& fields, Primitive& primitive) {
  primitive.alpha_mode = AlphaMode::opaque;
  primitive.double_sided = false;
  primitive.has_material = true;  // without one it has glTF's default
  const auto index = fields.find_index("material");
  if (!index) return;
  const Fields material = root.element("materials", *index);
  primitive.alpha_mode = parse_alpha_mode(material);
  primitive.double_sided = material.flag_or("doubleSided", false);
  primitive.material_name = short_name(material.text_or("name", ""));
  if (const auto pbr = material.find_object("pbrMetallicRoughness")) {
    const std::vector<double> color = pbr->numbers("baseColorFactor", 4);
    for (std::size_t k = 0; k < color.size(); ++k) primitive.base_color[k] = static_cast<float>(color[k]);
  }
}

}  // namespace

std::uint64_t primitive_mode(const Fields& primitive) {
  const std::uint64_t mode = primitive.index_or("mode", triangle_list);
  if (mode > last_mode) primitive.fail("mode " + std::to_string(mode) + " does not exist");
  return mode;
}

Primitive read_primitive(const Fields& root, const Fields& fields, AccessorReader& accessors) {
  Primitive primitive;
  const std::uint64_t mode = primitive_mode(fields);
  if (fields.extension("KHR_draco_mesh_compression")) {
    fields.fail("it is compressed with KHR_draco_mesh_compression, which is not read; decompress it first");
  }
  read_material(root, fields, primitive);
  primitive.deforms = fields.size("targets") > 0;
  primitive.triangles = mode >= triangle_list && fields.object("attributes").has("POSITION");
  const auto extension = fields.extension(kOrderExtension);
  if (extension && (!primitive.triangles || mode != triangle_list)) {
    extension->fail("orders need a primitive of mode 4 with positions");
  }
  if (!primitive.triangles) return primitive;
  read_geometry(fields, accessors, mode, primitive);
  if (extension) {
    StoredOrders stored =
        read_order_extension(*extension, primitive.mesh, accessors, root.size("animations"));
    primitive.orders = std::move(stored.orders);
    primitive.order_error = std::move(stored.error);
  }
  return primitive;
}

}  // namespace pellucid
