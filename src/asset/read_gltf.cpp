// glTF 2.0 in, .gltf or .glb: see readers.h.
//
// The JSON and the containers are read here and not by tinygltf, because the document must come out again as
// it was: tinygltf keeps only what it knows, checks few of the bounds that hostile files break, and would be
// a second parse beside the one that writing needs anyway.
#include <algorithm>
#include <array>

#include "asset/formats/reader.h"
#include "asset/gltf_primitive.h"
#include "asset/gltf_scene.h"
#include "asset/order_extension.h"

namespace pellucid {
namespace {

// A mesh of many primitives under many nodes multiplies.
constexpr std::size_t kMaxInstances = std::size_t{1} << 20U;

// Extensions that change what pellucid reads, and are read.
constexpr std::array kUnderstood = {kOrderExtension, kMeshoptExtension, kKhrMeshoptExtension,
                                    "KHR_mesh_quantization"};

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
    std::uint64_t gpu_instanced = 0;
    for_each_node(root_, [&](const Fields& node, std::uint64_t /*index*/, const Mat4& world) {
      const auto mesh = node.find_index("mesh");
      if (!mesh) return;
      if (*mesh + 1 >= first_primitive_.size())
        node.fail("mesh " + std::to_string(*mesh) + " does not exist");
      if (node.has("skin")) ++skinned;
      if (node.extension("EXT_mesh_gpu_instancing")) ++gpu_instanced;
      const std::string name = short_name(node.text_or("name", ""));
      for (std::size_t p = first_primitive_[*mesh]; p < first_primitive_[*mesh + 1]; ++p) {
        if (model_.instances.size() == kMaxInstances)
          node.fail("the scene draws more than a million primitives");
        if (node.has("skin")) model_.primitives[p].deforms = true;
        model_.instances.push_back({name, static_cast<std::uint32_t>(p), world});
      }
    });
    if (skinned > 0) note(plural(skinned, "skinned mesh", "skinned meshes") + ": only overdraw orders hold");
    if (gpu_instanced > 0) {
      note(plural(gpu_instanced, "node", "nodes") +
           " with EXT_mesh_gpu_instancing: kept, counted as one instance each");
    }
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
    const Json* used = root_.find_array("extensionsUsed");
    if (used == nullptr) return;
    for (const Json& name : *used) {
      if (!name.is_string()) root_.fail("extensionsUsed holds something that is not a string");
      const auto text = name.get<std::string>();
      const bool told = text == "KHR_materials_transmission" || text == "EXT_mesh_gpu_instancing";
      const bool understood = std::find(kUnderstood.begin(), kUnderstood.end(), text) != kUnderstood.end();
      if (!told && !understood) note(short_name(text) + " kept, not read");
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

// A .glb names itself; a .gltf is recognised as JSON by its first character.
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
