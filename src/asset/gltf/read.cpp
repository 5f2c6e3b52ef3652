// Reads glTF 2.0 (.gltf and .glb) as a Model: primitives of any topology, material flags, orders, instances
// and notes.
//
// tinygltf is not used, because the document must be written again as it was. tinygltf keeps only what it
// knows and checks few of the bounds that hostile files break. It would also parse the file a second time,
// because writing needs the whole document.
#include <algorithm>
#include <array>
#include <limits>

#include "asset/formats/reader.h"
#include "asset/gltf/accessors.h"
#include "asset/gltf/scene.h"
#include "asset/order_extension/order_extension.h"

namespace pellucid {
namespace {

enum Mode : std::uint64_t { triangle_list = 4, triangle_strip = 5, triangle_fan = 6, last_mode = 6 };

// Returns the triangles of the three topologies (section 3.7.2.1).
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

// Reads the indices of a primitive. Without indices, every vertex is drawn once, in file order.
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

// Makes normals unit length, as Mesh promises. Quantised normals have only approximately unit length.
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
  primitive.has_material = true;  // also without a material, because glTF defines a default
  const auto index = fields.find_index("material");
  if (!index) return;
  const Fields material = root.element("materials", *index);
  primitive.alpha_mode = parse_alpha_mode(material);
  primitive.double_sided = material.flag_or("doubleSided", false);
  primitive.material_name = short_name(material.text_or("name", ""));
  // Where both models of a material are there, the extension is the better one.
  std::vector<double> color;
  if (const auto glossy = material.extension("KHR_materials_pbrSpecularGlossiness")) {
    color = glossy->numbers("diffuseFactor", 4);
  } else if (const auto pbr = material.find_object("pbrMetallicRoughness")) {
    color = pbr->numbers("baseColorFactor", 4);
  }
  for (std::size_t k = 0; k < color.size(); ++k) primitive.base_color[k] = static_cast<float>(color[k]);
}

// Returns the mode of a primitive, or 4 (triangles) if it has none.
std::uint64_t primitive_mode(const Fields& primitive) {
  const std::uint64_t mode = primitive.index_or("mode", triangle_list);
  if (mode > last_mode) primitive.fail("mode " + std::to_string(mode) + " does not exist");
  return mode;
}

// Reads a primitive. `fields` is meshes[mesh].primitives[index], `root` the whole document. Fills all members
// except mesh_index, primitive_index, name, and `deforms` for skins.
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

// Limits the instances, because many primitives under many nodes multiply.
constexpr std::size_t kMaxInstances = std::size_t{1} << 20U;

// Extensions that pellucid understands. Those of materials are read when the model is drawn (materials.cpp).
constexpr std::array kUnderstood = {kOrderExtension,
                                    kMeshoptExtension,
                                    kKhrMeshoptExtension,
                                    "KHR_mesh_quantization",
                                    "EXT_mesh_gpu_instancing",
                                    "KHR_node_visibility",
                                    "KHR_texture_transform",
                                    "KHR_materials_transmission",
                                    "KHR_materials_unlit",
                                    "KHR_materials_emissive_strength",
                                    "KHR_materials_pbrSpecularGlossiness"};

class GltfModelReader {
 public:
  GltfModelReader(const std::string& path, const ReadOptions& options)
      : document_(std::make_shared<GltfDocument>(load_document(path))),
        root_(document_->path, document_->json, ""),
        accessors_(*document_, options) {}

  Model read() {
    model_.path = document_->path;
    const auto& buffers = document_->buffers;
    const bool binary = !buffers.empty() && buffers[0].storage == BufferStorage::binary_chunk;
    model_.format = binary || document_->path.ends_with(".glb") ? "glb" : "gltf";
    read_meshes();
    read_instances();
    read_animations();
    note_extensions();
    model_.document = document_;
    return std::move(model_);
  }

 private:
  void read_meshes() {
    for (std::uint64_t m = 0; m < root_.size("meshes"); ++m) {
      const Fields mesh = root_.element("meshes", m);
      const std::string name = short_name(mesh.text_or("name", "mesh " + std::to_string(m)));
      const std::uint64_t count = mesh.size("primitives");
      first_primitive_.push_back(model_.primitives.size());
      for (std::uint64_t p = 0; p < count; ++p) {
        Primitive primitive = read_primitive(root_, mesh.element("primitives", p), accessors_);
        primitive.name = count > 1 ? name + "#" + std::to_string(p) : name;
        primitive.mesh_index = static_cast<std::uint32_t>(m);
        primitive.primitive_index = static_cast<std::uint32_t>(p);
        model_.primitives.push_back(std::move(primitive));
      }
    }
    first_primitive_.push_back(model_.primitives.size());
  }

  void read_instances() {
    std::uint64_t skinned = 0;
    std::uint64_t hidden = 0;
    for_each_node(root_, [&](const SceneNode& node) {
      const auto mesh = node.fields.find_index("mesh");
      if (!mesh) return;
      if (*mesh + 1 >= first_primitive_.size())
        node.fields.fail("mesh " + std::to_string(*mesh) + " does not exist");
      if (node.fields.has("skin")) ++skinned;
      if (!node.visible) {
        ++hidden;
        return;
      }
      add_instances(node, *mesh);
    });
    if (skinned > 0) note(plural(skinned, "skinned mesh", "skinned meshes") + ": only overdraw orders hold");
    if (hidden > 0) note(plural(hidden, "hidden node", "hidden nodes") + " (KHR_node_visibility)");
  }

  void add_instances(const SceneNode& node, std::uint64_t mesh) {
    const std::string name = short_name(node.fields.text_or("name", ""));
    const std::vector<Mat4> matrices = instance_matrices(node.fields);
    for (std::size_t p = first_primitive_[mesh]; p < first_primitive_[mesh + 1]; ++p) {
      if (node.fields.has("skin")) model_.primitives[p].deforms = true;
      for (const Mat4& in_node : matrices) {
        if (model_.instances.size() == kMaxInstances)
          node.fields.fail("the scene draws more than a million primitives");
        const Mat4 world = in_node == Mat4{} ? node.world : multiply(node.world, in_node);
        model_.instances.push_back(
            {name, static_cast<std::uint32_t>(p), world, static_cast<std::uint32_t>(node.index), in_node});
      }
    }
  }

  // Returns the matrices of EXT_mesh_gpu_instancing, local to the node; the identity without it.
  std::vector<Mat4> instance_matrices(const Fields& node) {
    const auto extension = node.extension("EXT_mesh_gpu_instancing");
    if (!extension) return {Mat4{}};
    const Fields attributes = extension->object("attributes");
    const auto read = [&](const char* name, const char* type) {
      const auto accessor = attributes.find_index(name);
      return accessor ? accessors_.read_reals(*accessor, type) : std::vector<float>{};
    };
    const std::vector<float> translations = read("TRANSLATION", "VEC3");
    const std::vector<float> rotations = read("ROTATION", "VEC4");
    const std::vector<float> scales = read("SCALE", "VEC3");
    const std::size_t count = std::max({translations.size() / 3, rotations.size() / 4, scales.size() / 3});
    const auto fits = [&](const std::vector<float>& values, std::size_t width) {
      return values.empty() || values.size() == width * count;
    };
    if (!fits(translations, 3) || !fits(rotations, 4) || !fits(scales, 3))
      attributes.fail("the attributes have different numbers of instances");
    if (count > kMaxInstances) attributes.fail("there are more than a million instances");
    std::vector<Mat4> matrices;
    matrices.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      matrices.push_back(compose(values_at<3>(translations, i, {}), values_at<4>(rotations, i, {0, 0, 0, 1}),
                                 values_at<3>(scales, i, {1, 1, 1})));
    }
    return matrices;
  }

  template <std::size_t N>
  static std::array<double, N> values_at(const std::vector<float>& values, std::size_t i,
                                         std::array<double, N> otherwise) {
    if (!values.empty())
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(N * i), N, otherwise.begin());
    return otherwise;
  }

  void read_animations() {
    const std::uint64_t count = root_.size("animations");
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::string fallback = "animation " + std::to_string(i);
      model_.animation_names.push_back(short_name(root_.element("animations", i).text_or("name", fallback)));
    }
    if (count > 0) note(plural(count, "animation", "animations"));
  }

  void note_extensions() {
    std::uint64_t transmissive = 0;
    for (std::uint64_t i = 0; i < root_.size("materials"); ++i) {
      if (root_.element("materials", i).extension("KHR_materials_transmission")) ++transmissive;
    }
    if (transmissive > 0) {
      note(plural(transmissive, "material", "materials") +
           " with KHR_materials_transmission: kept, drawn by alphaMode");
    }
    const auto names = [&](const char* key) {
      std::vector<std::string> list;
      const Json* array = root_.find_array(key);
      if (array == nullptr) return list;
      for (const Json& name : *array) {
        if (!name.is_string()) root_.fail(std::string(key) + " holds something that is not a string");
        list.push_back(name.get<std::string>());
      }
      return list;
    };
    const auto understood = [](const std::string& name) {
      return std::find(kUnderstood.begin(), kUnderstood.end(), name) != kUnderstood.end();
    };
    for (const std::string& name : names("extensionsUsed")) {
      if (name != "KHR_materials_transmission" && !understood(name))
        note(short_name(name) + " kept, not read");
    }
    for (const std::string& name : names("extensionsRequired")) {
      if (!understood(name)) model_.unknown_required.push_back(short_name(name));
    }
  }

  void note(std::string text) { model_.notes.push_back(std::move(text)); }

  static std::string plural(std::uint64_t count, const char* one, const char* many) {
    return std::to_string(count) + " " + (count == 1 ? one : many);
  }

  std::shared_ptr<GltfDocument> document_;
  Fields root_;
  AccessorReader accessors_;
  Model model_;
  std::vector<std::size_t> first_primitive_;  // of every mesh, and the end
};

Model read_gltf(const std::string& path, const ReadOptions& options) {
  return GltfModelReader(path, options).read();
}

// Returns whether the file is a .glb, which identifies itself, or JSON, which begins with a brace.
bool begins_as_gltf(std::string_view bytes) {
  if (bytes.starts_with("glTF")) return true;
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && bytes[first] == '{';
}

}  // namespace

FormatReader gltf_reader() {
  return {"gltf", {".glb", ".gltf"}, begins_as_gltf, read_gltf};
}

}  // namespace pellucid
