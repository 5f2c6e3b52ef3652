// Implements read_model() of pellucid/asset.h, which finds the reader of a file in the table of formats
// (formats/reader.h), and small functions on models.
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "asset/formats/reader.h"

namespace pellucid {
namespace {

std::string lower_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

// Returns the first bytes of a file, and none if it cannot be read. In that case its reader reports why.
std::string first_bytes(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  std::string bytes(64, '\0');
  bytes.resize(file == nullptr ? 0 : std::fread(bytes.data(), 1, bytes.size(), file.get()));
  return bytes;
}

const FormatReader* find_reader(const std::string& path) {
  // A format that identifies itself takes precedence over the name of the file.
  const std::string bytes = first_bytes(path);
  const std::string extension = lower_extension(path);
  const FormatReader* by_extension = nullptr;
  for (const FormatReader& reader : format_readers()) {
    if (reader.recognizes != nullptr && reader.recognizes(bytes)) return &reader;
    const auto& all = reader.extensions;
    if (std::find(all.begin(), all.end(), extension) != all.end()) by_extension = &reader;
  }
  return by_extension;
}

// Returns the list of extensions, such as ".glb .gltf .ply".
std::string list_of_extensions() {
  std::string list;
  for (const FormatReader& reader : format_readers()) {
    for (const std::string_view extension : reader.extensions)
      list.append(list.empty() ? "" : " ").append(extension);
  }
  return list;
}

}  // namespace

const std::vector<FormatReader>& format_readers() {
#define PELLUCID_ROW(name) name##_reader(),
  static const std::vector<FormatReader> kReaders{PELLUCID_MODEL_FORMATS(PELLUCID_ROW)};
#undef PELLUCID_ROW
  return kReaders;
}

Model read_model(const std::string& path, const ReadOptions& options) {
  if (const FormatReader* reader = find_reader(path)) return reader->read(path, options);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) read_file(path);  // throws and says what is wrong
  throw Error(ErrorKind::bad_input,
              path + ": not a model that pellucid reads (" + list_of_extensions() + ")");
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

bool is_known_translucent(const Model& model, const Primitive& primitive) {
  return primitive.alpha_mode == AlphaMode::blend && (is_gltf(model) || primitive.has_material);
}

std::uint64_t index_bytes(const OrderSet& set, const Mesh& mesh) {
  std::uint64_t nodes = 0;
  for (const NodeSequence& order : set.orders) nodes += order.size();
  return 3 * nodes * bytes_per_index(mesh.positions.size());
}

}  // namespace pellucid
