// Implements minimal_document.h: writes meshes, materials, textures and nodes as JSON and buffers. Textures
// become part of the file's own data, so that the file does not depend on where it is.
#include "asset/gltf/minimal_document.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>

#include "asset/formats/images.h"
#include "asset/gltf/accessors.h"
#include "asset/gltf/edit.h"

namespace pellucid {
namespace {

constexpr double kUnitTolerance = 1e-4;
bool is_finite(const Vec3f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// glTF has neither NaN nor infinity. Vertices with such positions, which no written triangle uses, move to
// the origin.
std::vector<Vec3f> finite_positions(const std::vector<Vec3f>& positions) {
  std::vector<Vec3f> finite = positions;
  for (Vec3f& position : finite) {
    if (!is_finite(position)) position = {};
  }
  return finite;
}

// Vertices without a surface have zero normals, but glTF requires unit vectors.
std::vector<Vec3f> unit_normals(const std::vector<Vec3f>& normals) {
  std::vector<Vec3f> unit = normals;
  for (Vec3f& normal : unit) {
    const double l = length(to_double(normal));
    if (std::abs(l - 1) <= kUnitTolerance) continue;
    const bool usable = std::isfinite(l) && l > 0;
    normal = usable ? to_float(normalized(to_double(normal))) : Vec3f{0, 0, 1};
  }
  return unit;
}

template <class Element>
Bytes bytes_of(const std::vector<Element>& elements) {
  Bytes bytes(elements.size() * sizeof(Element));
  if (!bytes.empty()) std::memcpy(bytes.data(), elements.data(), bytes.size());
  return bytes;
}

// Returns the attribute of all vertices: those that splitting added get the mean of their sources.
template <std::size_t N>
std::vector<std::array<float, N>> with_new_vertices(std::vector<std::array<float, N>> values,
                                                    const Primitive& primitive) {
  if (values.empty() || !primitive.new_vertices) return values;
  for (const SplitVertex& vertex : *primitive.new_vertices) {
    std::array<double, N> sum{};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < N; ++k) sum[k] += vertex.weights[i] * values[vertex.sources[i]][k];
    }
    std::array<float, N> mean{};
    for (std::size_t k = 0; k < N; ++k) mean[k] = static_cast<float>(sum[k]);
    values.push_back(mean);
  }
  return values;
}

bool is_drawable(const Mesh& mesh, const Triangle& triangle) {
  return std::all_of(triangle.begin(), triangle.end(), [&](std::uint32_t corner) {
    return corner < mesh.positions.size() && is_finite(mesh.positions[corner]);
  });
}

Json to_json(const Vec3f& v) {
  return Json::array({v.x, v.y, v.z});
}

const char* to_text(AlphaMode mode) {
  switch (mode) {
    case AlphaMode::opaque:
      return "OPAQUE";
    case AlphaMode::mask:
      return "MASK";
    default:
      return "BLEND";
  }
}

class MinimalDocument {
 public:
  explicit MinimalDocument(const Model& model) : model_(model), editor_(empty_document()) {}

  GltfDocument make(const std::vector<std::vector<std::uint32_t>>& bases,
                    std::vector<WrittenPrimitive>& written) {
    for (std::size_t p = 0; p < model_.primitives.size(); ++p) written.push_back(add_mesh(p, bases[p]));
    if (editor_.document().json.value("meshes", Json()).empty()) {
      throw Error(ErrorKind::nothing_to_do, model_.path + ": it holds no geometry to write");
    }
    add_nodes(written);
    return std::move(editor_.document());
  }

 private:
  static GltfDocument empty_document() {
    GltfDocument document;
    document.json["asset"] = {{"version", "2.0"}, {"generator", "pellucid " PELLUCID_VERSION}};
    document.json["scene"] = 0;
    for (const char* array :
         {"scenes", "nodes", "materials", "meshes", "accessors", "bufferViews", "buffers"}) {
      document.json[array] = Json::array();
    }
    return document;
  }

  std::uint64_t append(const char* array, Json value) {
    Json& values = editor_.document().json[array];
    values.push_back(std::move(value));
    return values.size() - 1;
  }

  std::uint64_t add_view(const Bytes& bytes, std::uint32_t target) {
    const std::uint64_t view = editor_.append_view(editor_.append_bytes(editor_.host_buffer(), bytes));
    editor_.document().json["bufferViews"][view]["target"] = target;
    return view;
  }

  std::uint64_t add_vectors(const std::vector<Vec3f>& vectors, bool with_bounds) {
    Json accessor;
    accessor["bufferView"] = add_view(bytes_of(vectors), kVertexTarget);
    accessor["componentType"] = single_float;
    accessor["count"] = vectors.size();
    accessor["type"] = "VEC3";
    if (with_bounds) {
      Vec3f low = vectors.front();
      Vec3f high = low;
      for (const Vec3f& v : vectors) {
        low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
        high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
      }
      accessor["min"] = to_json(low);
      accessor["max"] = to_json(high);
    }
    return append("accessors", std::move(accessor));
  }

  template <std::size_t N>
  void add_attribute(Json& json, const char* name, const std::vector<std::array<float, N>>& values,
                     const Primitive& primitive) {
    const std::vector<std::array<float, N>> all = with_new_vertices(values, primitive);
    if (all.empty() || all.size() != primitive.mesh.positions.size()) return;
    Json accessor;
    accessor["bufferView"] = add_view(bytes_of(all), kVertexTarget);
    accessor["componentType"] = single_float;
    accessor["count"] = all.size();
    accessor["type"] = "VEC" + std::to_string(N);
    json["attributes"][name] = append("accessors", std::move(accessor));
  }

  // Returns the number of the texture of an image file, which becomes a part of the file's data.
  std::uint64_t add_texture(const std::string& path) {
    if (const auto known = textures_.find(path); known != textures_.end()) return known->second;
    const Bytes file = read_file(path, kLargestImageFile);
    Json image;
    image["bufferView"] = editor_.append_view(editor_.append_bytes(editor_.host_buffer(), file));
    image["mimeType"] = !file.empty() && file[0] == std::byte{0x89} ? "image/png" : "image/jpeg";
    image["name"] = std::filesystem::path(path).stem().string();
    Json& document = editor_.document().json;
    for (const char* array : {"images", "textures"}) {
      if (!document.contains(array)) document[array] = Json::array();
    }
    const std::uint64_t source = append("images", std::move(image));
    return textures_[path] = append("textures", {{"source", source}});
  }

  std::uint64_t add_indices(const Mesh& mesh, const std::vector<std::uint32_t>& base) {
    std::vector<std::uint32_t> indices;
    indices.reserve(3 * base.size());
    for (const std::uint32_t triangle : base) {
      indices.insert(indices.end(), mesh.triangles[triangle].begin(), mesh.triangles[triangle].end());
    }
    const ComponentWidth width = vertex_index_width(mesh.positions.size());
    const std::uint64_t view = add_view(pack(indices, width), kIndexTarget);
    return editor_.append_accessor(view, 0, width, indices.size());
  }

  std::uint64_t add_material(const Primitive& primitive) {
    Json material;
    if (!primitive.material_name.empty()) material["name"] = primitive.material_name;
    Json color = Json::array();
    for (const float channel : primitive.base_color) {
      color.push_back(std::isfinite(channel) ? std::clamp(channel, 0.0F, 1.0F) : 1.0F);
    }
    material["pbrMetallicRoughness"]["baseColorFactor"] = std::move(color);
    material["pbrMetallicRoughness"]["metallicFactor"] = 0;
    if (!primitive.texture.empty() && !primitive.texcoords.empty())
      material["pbrMetallicRoughness"]["baseColorTexture"]["index"] = add_texture(primitive.texture);
    material["alphaMode"] = to_text(primitive.alpha_mode);
    material["doubleSided"] = primitive.double_sided;
    const Json& materials = editor_.document().json["materials"];
    const auto same = std::find(materials.begin(), materials.end(), material);
    if (same != materials.end()) return static_cast<std::uint64_t>(same - materials.begin());
    return append("materials", std::move(material));
  }

  WrittenPrimitive add_mesh(std::size_t p, const std::vector<std::uint32_t>& base) {
    const Primitive& primitive = model_.primitives[p];
    WrittenPrimitive written;
    if (primitive.mesh.positions.empty()) return written;
    for (const std::uint32_t triangle : base) {
      if (is_drawable(primitive.mesh, primitive.mesh.triangles[triangle])) written.base.push_back(triangle);
    }
    Json json;
    json["attributes"]["POSITION"] = add_vectors(finite_positions(primitive.mesh.positions), true);
    if (primitive.mesh.normals.size() == primitive.mesh.positions.size()) {
      json["attributes"]["NORMAL"] = add_vectors(unit_normals(primitive.mesh.normals), false);
    }
    add_attribute(json, "COLOR_0", primitive.colors, primitive);
    add_attribute(json, "TEXCOORD_0", primitive.texcoords, primitive);
    // A primitive without triangles is written as points.
    if (written.base.empty()) {
      json["mode"] = 0;
    } else {
      json["indices"] = add_indices(primitive.mesh, written.base);
    }
    json["material"] = add_material(primitive);
    Json mesh;
    if (!primitive.name.empty()) mesh["name"] = primitive.name;
    mesh["primitives"] = Json::array({std::move(json)});
    written.mesh = static_cast<std::uint32_t>(append("meshes", std::move(mesh)));
    written.present = true;
    return written;
  }

  void add_node(const std::string& name, std::uint32_t mesh, const Mat4& world) {
    Json node;
    if (!name.empty()) node["name"] = name;
    node["mesh"] = mesh;
    if (!(world == Mat4{})) node["matrix"] = world.m;
    append("nodes", std::move(node));
  }

  void add_nodes(const std::vector<WrittenPrimitive>& written) {
    for (const Instance& instance : model_.instances) {
      if (!written[instance.primitive].present) continue;
      add_node(instance.node_name, written[instance.primitive].mesh, instance.world);
    }
    // A model without instances draws every primitive once.
    for (std::size_t p = 0; model_.instances.empty() && p < written.size(); ++p) {
      if (written[p].present) add_node(model_.primitives[p].name, written[p].mesh, Mat4{});
    }
    Json nodes = Json::array();
    for (std::size_t i = 0; i < editor_.document().json["nodes"].size(); ++i) nodes.push_back(i);
    Json scene = Json::object();
    if (!nodes.empty()) scene["nodes"] = std::move(nodes);
    append("scenes", std::move(scene));
  }

  const Model& model_;
  DocumentEditor editor_;
  std::map<std::string, std::uint64_t> textures_;  // by the path of the image
};

}  // namespace

GltfDocument make_minimal_document(const Model& model, const std::vector<std::vector<std::uint32_t>>& bases,
                                   std::vector<WrittenPrimitive>& written) {
  return MinimalDocument(model).make(bases, written);
}

}  // namespace pellucid
