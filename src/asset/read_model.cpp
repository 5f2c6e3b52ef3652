// Any model file to its reader, and the small functions on models: see pellucid/asset.h.
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "asset/gltf_edit.h"
#include "asset/readers.h"

namespace pellucid {
namespace {

std::string lower_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

// The first bytes of a file; empty where it cannot be read (its reader will say why).
std::string first_bytes(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  std::string bytes(64, '\0');
  bytes.resize(file == nullptr ? 0 : std::fread(bytes.data(), 1, bytes.size(), file.get()));
  return bytes;
}

using Reader = Model (*)(const std::string&, const ReadOptions&);

// Formats that name themselves win over the file's name.
Reader reader_by_content(const std::string& bytes) {
  if (bytes.starts_with("glTF")) return read_gltf;
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) return read_ply;
  const std::string_view text = std::string_view(bytes).substr(bytes.starts_with("\xEF\xBB\xBF") ? 3 : 0);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && text[first] == '{') return read_gltf;
  return nullptr;
}

Reader reader_by_extension(const std::string& extension) {
  if (extension == ".gltf" || extension == ".glb") return read_gltf;
  if (extension == ".ply") return read_ply;
  if (extension == ".obj") return read_obj;
  if (extension == ".stl") return read_stl;
  if (extension == ".off") return read_off;
  return nullptr;
}

}  // namespace

Model read_model(const std::string& path, const ReadOptions& options) {
  Reader reader = reader_by_content(first_bytes(path));
  if (reader == nullptr) reader = reader_by_extension(lower_extension(path));
  if (reader == nullptr) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) read_file(path);  // says what is wrong with it
    throw Error(ErrorKind::bad_input,
                path + ": not a model that pellucid reads (.glb .gltf .ply .obj .stl .off)");
  }
  return reader(path, options);
}

Model make_model(const std::vector<SamplePart>& parts, const std::string& name) {
  Model model;
  model.path = name;
  model.format = "sample";
  for (const SamplePart& part : parts) {
    Primitive primitive;
    primitive.name = part.name;
    primitive.mesh_index = static_cast<std::uint32_t>(model.primitives.size());
    primitive.mesh = part.mesh;
    primitive.alpha_mode = part.base_color[3] < 1 ? AlphaMode::blend : AlphaMode::opaque;
    primitive.base_color = part.base_color;
    primitive.material_name = part.name;
    model.instances.push_back({part.name, primitive.mesh_index, Mat4{}});
    model.primitives.push_back(std::move(primitive));
  }
  return model;
}

std::uint64_t index_bytes(const OrderSet& set, const Mesh& mesh) {
  std::uint64_t nodes = 0;
  for (const NodeSequence& order : set.orders) nodes += order.size();
  return 3 * nodes * bytes_of(vertex_index_width(mesh.positions.size()));
}

}  // namespace pellucid
