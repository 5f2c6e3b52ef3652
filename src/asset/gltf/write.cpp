// Implements write_model() of pellucid/asset.h: writes models as glTF with their orders
// (docs/file-format.md).
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <numeric>

#include "asset/formats/text_cursor.h"
#include "asset/gltf/edit.h"
#include "asset/gltf/minimal_document.h"
#include "asset/gltf/textures_beside.h"
#include "asset/order_extension/order_extension.h"

namespace pellucid {
namespace {

namespace fs = std::filesystem;

// Extensions of a primitive that do not depend on the order of its triangles. The order extension is among
// them because it is written anew.
constexpr std::array kOrderFreeExtensions = {kOrderExtension, "KHR_materials_variants", "EXT_mesh_features",
                                             "EXT_structural_metadata", "CESIUM_primitive_outline"};

bool order_may_change(const Json& primitive) {
  if (!primitive.contains("extensions")) return true;
  for (const auto& [name, value] : primitive["extensions"].items()) {
    if (std::find(kOrderFreeExtensions.begin(), kOrderFreeExtensions.end(), name) ==
        kOrderFreeExtensions.end()) {
      return false;
    }
  }
  return true;
}

class ModelWriter {
 public:
  ModelWriter(const Model& model, const std::vector<OrderedPrimitive>& ordered, const std::string& path,
              const WriteOptions& options)
      : model_(model),
        path_(path),
        options_(options),
        editor_(make_document(ordered)),
        arrays_(editor_, options, fs::path(path).stem().string()) {}

  WriteReport write() {
    editor_.remove_orders();
    if (model_.document != nullptr) {
      textures_ = carry_textures(editor_, path_, options_.embed_textures, report_.notes);
      append_vertices();
      write_bases();
    }
    for (const OrderedPrimitive* entry : ordered_) write_orders(*entry);
    return write_files();
  }

 private:
  // Returns the document of the file, or a new one for other formats. Also sorts `ordered` by primitive, so
  // that the same orders give the same bytes.
  GltfDocument make_document(const std::vector<OrderedPrimitive>& ordered) {
    for (const OrderedPrimitive& entry : ordered) ordered_.push_back(&entry);
    std::sort(ordered_.begin(), ordered_.end(), [](const OrderedPrimitive* a, const OrderedPrimitive* b) {
      return a->primitive < b->primitive;
    });

    std::vector<std::vector<std::uint32_t>> bases;
    for (const Primitive& primitive : model_.primitives) {
      bases.emplace_back(primitive.mesh.triangles.size());
      std::iota(bases.back().begin(), bases.back().end(), 0U);
    }
    if (model_.document == nullptr) {
      for (const OrderedPrimitive* entry : ordered_) {
        if (bakes(entry->orders)) bases[entry->primitive] = complete_base(*entry);
      }
      return make_minimal_document(model_, bases, written_);
    }
    for (std::size_t p = 0; p < model_.primitives.size(); ++p) {
      const Primitive& primitive = model_.primitives[p];
      written_.push_back({true, primitive.mesh_index, primitive.primitive_index, std::move(bases[p])});
    }
    return *model_.document;
  }

  // Returns the base order, followed by the triangles that it leaves out because they draw nothing, so that
  // no triangle is lost.
  std::vector<std::uint32_t> complete_base(const OrderedPrimitive& entry) const {
    std::vector<std::uint32_t> base = entry.orders.base_sequence;
    std::vector<bool> listed(model_.primitives[entry.primitive].mesh.triangles.size(), false);
    for (const std::uint32_t triangle : base) listed[triangle] = true;
    for (std::uint32_t triangle = 0; triangle < listed.size(); ++triangle) {
      if (!listed[triangle]) base.push_back(triangle);
    }
    return base;
  }

  void append_vertices() {
    for (std::size_t p = 0; p < model_.primitives.size(); ++p) {
      const Primitive& primitive = model_.primitives[p];
      if (!primitive.new_vertices) continue;
      append_split_vertices(editor_, editor_.primitive(written_[p].mesh, written_[p].index), primitive);
    }
  }

  // Writes the base orders. Called before orders are written, so that orders are at the end of the file and
  // can be removed again.
  void write_bases() {
    const std::vector<bool> exclusive = exclusive_index_accessors(editor_.document());
    std::vector<const OrderedPrimitive*> entries(model_.primitives.size(), nullptr);
    for (const OrderedPrimitive* entry : ordered_) entries[entry->primitive] = entry;
    for (std::size_t p = 0; p < entries.size(); ++p) {
      const Primitive& primitive = model_.primitives[p];
      if (entries[p] == nullptr && !primitive.new_vertices) continue;
      WrittenPrimitive& written = written_[p];
      Json& json = editor_.primitive(written.mesh, written.index);
      const bool is_list = json.value("mode", 4) == 4;
      std::vector<std::uint32_t> base = written.base;
      if (entries[p] != nullptr && bakes(entries[p]->orders) && order_may_change(json)) {
        base = complete_base(*entries[p]);
      }
      if (is_list && base == written.base && !primitive.new_vertices) continue;
      written.base = std::move(base);
      write_base(json, primitive, written.base, exclusive);
      if (!is_list) json["mode"] = 4;
    }
  }

  void write_base(Json& json, const Primitive& primitive, const std::vector<std::uint32_t>& base,
                  const std::vector<bool>& exclusive) {
    const Mesh& mesh = primitive.mesh;
    std::vector<std::uint32_t> indices;
    indices.reserve(3 * base.size());
    for (const std::uint32_t triangle : base) {
      indices.insert(indices.end(), mesh.triangles[triangle].begin(), mesh.triangles[triangle].end());
    }
    // New vertices may have numbers that the index type of the file cannot hold.
    if (json.contains("indices") && !primitive.new_vertices) {
      const auto id = json["indices"].get<std::uint64_t>();
      const Json& accessor = editor_.document().json["accessors"][id];
      // A strip or fan has fewer indices than its list of triangles.
      if (exclusive[id] && accessor["count"] == indices.size()) {
        const Json& view =
            editor_.document().json["bufferViews"][accessor["bufferView"].get<std::uint64_t>()];
        const std::uint64_t offset =
            view.value("byteOffset", std::uint64_t{0}) + accessor.value("byteOffset", std::uint64_t{0});
        editor_.overwrite(view["buffer"].get<std::uint64_t>(), offset,
                          pack(indices, accessor["componentType"].get<ComponentWidth>()));
        return;
      }
    }
    const ComponentWidth width = vertex_index_width(mesh.positions.size());
    const std::uint64_t view =
        editor_.append_view(editor_.append_bytes(editor_.host_buffer(), pack(indices, width)));
    json["indices"] = editor_.append_accessor(view, 0, width, indices.size());
  }

  // Returns the encoding of a set. Patches are runs of primitive.indices in the order of the set, so if
  // primitive.indices must not change, orders are stored as indices.
  [[nodiscard]] OrderEncoding encoding_of(const OrderSet& set, const Json& primitive) const {
    const bool kept = set.purpose == OrderPurpose::overdraw && !order_may_change(primitive);
    return kept ? OrderEncoding::indices : options_.encoding;
  }

  [[nodiscard]] bool bakes(const OrderSet& set) const {
    return options_.bake_base ||
           (set.purpose == OrderPurpose::overdraw && options_.encoding != OrderEncoding::indices);
  }

  void write_orders(const OrderedPrimitive& entry) {
    const OrderSet& set = entry.orders;
    const Primitive& primitive = model_.primitives[entry.primitive];
    const WrittenPrimitive& written = written_[entry.primitive];
    const OrderEncoding encoding = encoding_of(set, editor_.primitive(written.mesh, written.index));
    // Triangles that glTF cannot hold were not written.
    const std::vector<std::uint32_t>& base = set.base_sequence;
    const bool in_place =
        written.base.size() >= base.size() && std::equal(base.begin(), base.end(), written.base.begin());
    if (set.purpose == OrderPurpose::overdraw && encoding != OrderEncoding::indices && !in_place) {
      throw Error(ErrorKind::bad_argument, "orders of primitive " + in_quotes(primitive.name) +
                                               ": a triangle of the base sequence cannot be written");
    }
    const OrderAccessors accessors = arrays_.write(set, primitive.mesh, written.base, encoding);
    editor_.primitive(written.mesh, written.index)["extensions"][kOrderExtension] =
        order_extension_json(set, entry.error, options_.direction, accessors);
    editor_.declare_extension(kOrderExtension);
  }

  WriteReport write_files() {
    DocumentFiles files = lay_out(editor_.document(), path_, arrays_.side_names());
    report_.order_bytes = arrays_.order_bytes();
    report_.files.push_back(path_);
    report_.file_bytes = files.main.size();

    if (fs::is_directory(fs::absolute(path_).parent_path())) {
      for (const auto& texture : textures_) fs::create_directories(fs::absolute(texture.first).parent_path());
    }
    std::move(textures_.begin(), textures_.end(), std::back_inserter(files.side_files));
    for (const auto& [name, bytes] : files.side_files) {
      report_.files.push_back(name);
      report_.file_bytes += bytes.size();
    }

    // The main file is written last, so that everything it names exists by then. If writing it fails, new
    // side files are removed again.
    std::vector<std::string> created;
    try {
      for (const auto& [name, bytes] : files.side_files) {
        const bool is_new = !fs::exists(name);
        write_file_atomically(name, bytes);
        if (is_new) created.push_back(name);
      }
      write_file_atomically(path_, files.main);
    } catch (...) {
      std::error_code ignored;
      for (const std::string& name : created) fs::remove(name, ignored);
      throw;
    }
    note_stale_files();
    return std::move(report_);
  }

  // An earlier run may have stored orders in files of their own, to which this file does not refer.
  void note_stale_files() {
    for (const char* suffix : {".orders.bin", ".orders-fallback.bin"}) {
      const std::string name = fs::path(path_).replace_extension().string() + suffix;
      const auto& files = report_.files;
      std::error_code ignored;
      if (fs::exists(name, ignored) && std::find(files.begin(), files.end(), name) == files.end())
        report_.notes.push_back(name + " is of an earlier run; " + path_ + " does not refer to it");
    }
  }

  const Model& model_;
  const std::string& path_;
  const WriteOptions& options_;
  std::vector<const OrderedPrimitive*> ordered_;
  std::vector<WrittenPrimitive> written_;  // one per primitive of the model
  DocumentEditor editor_;
  OrderArrayWriter arrays_;
  WriteReport report_;
  std::vector<SideFile> textures_;  // copies of textures beside the source
};

}  // namespace

bool triangles_may_change(const Model& model, std::uint32_t primitive) {
  if (model.document == nullptr) return true;
  const Primitive& entry = model.primitives[primitive];
  return order_may_change(
      model.document->json["meshes"][entry.mesh_index]["primitives"][entry.primitive_index]);
}

WriteReport write_model(const Model& model, const std::vector<OrderedPrimitive>& ordered,
                        const std::string& path, const WriteOptions& options) {
  const std::string extension = fs::path(path).extension().string();
  if (extension != ".glb" && extension != ".gltf") {
    throw Error(ErrorKind::bad_argument, path + ": orders are written as .glb or .gltf");
  }
  check_orders(model, ordered);
  for (std::uint32_t p = 0; p < model.primitives.size(); ++p) {
    if (model.primitives[p].new_vertices && !triangles_may_change(model, p)) {
      throw Error(ErrorKind::bad_argument,
                  model.path + ": " + model.primitives[p].name +
                      " cannot be split, because it has an extension that numbers its triangles");
    }
  }
  try {
    return ModelWriter(model, ordered, path, options).write();
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorKind::bad_input, model.path + ": malformed glTF: " + error.what());
  } catch (const fs::filesystem_error& error) {
    throw Error(ErrorKind::cannot_write, path + ": cannot write: " + error.code().message());
  }
}

}  // namespace pellucid
