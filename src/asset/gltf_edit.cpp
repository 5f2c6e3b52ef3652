// Changes to a glTF document: see gltf_edit.h.
#include "asset/gltf_edit.h"

#include <algorithm>
#include <cstring>
#include <set>

#include "asset/json_fields.h"

namespace pellucid {
namespace {

// json[key], where json is an object that has it and it is an array; else an empty array.
const Json& array_in(const Json& json, const char* key) {
  static const Json kEmpty = Json::array();
  if (!json.is_object()) return kEmpty;
  const auto found = json.find(key);
  return found != json.end() && found->is_array() ? *found : kEmpty;
}

// json[key] as an index; `fallback` where there is none.
std::uint64_t index_in(const Json& json, const char* key, std::uint64_t fallback) {
  if (!json.is_object()) return fallback;
  const auto found = json.find(key);
  return found != json.end() ? as_index(*found).value_or(fallback) : fallback;
}

const Json* extension_in(const Json& json, const char* name) {
  if (!json.is_object() || !json.contains("extensions") || !json["extensions"].contains(name)) return nullptr;
  return &json["extensions"][name];
}

// Call `visit(index)` for every value of `key` that is an index, anywhere under `json`. The depth of a
// document is bounded by its parser.
template <class Visit>
void for_each_index(const Json& json, const char* key, const Visit& visit) {
  if (json.is_object()) {
    for (const auto& [name, value] : json.items()) {
      if (const auto index = name == key ? as_index(value) : std::nullopt) visit(*index);
      for_each_index(value, key, visit);
    }
  } else if (json.is_array()) {
    for (const Json& value : json) for_each_index(value, key, visit);
  }
}

// Accessors that glTF itself refers to: attributes, targets, indices, animations, skins.
std::set<std::uint64_t> core_accessors(const Json& document) {
  std::set<std::uint64_t> used;
  const auto add_all = [&](const Json& attributes) {
    for (const Json& value : attributes) {
      if (const auto index = as_index(value)) used.insert(*index);
    }
  };
  for (const Json& mesh : array_in(document, "meshes")) {
    for (const Json& primitive : array_in(mesh, "primitives")) {
      if (primitive.contains("attributes")) add_all(primitive["attributes"]);
      for (const Json& target : array_in(primitive, "targets")) add_all(target);
      if (primitive.contains("indices")) used.insert(index_in(primitive, "indices", 0));
    }
  }
  const auto add = [&](std::uint64_t accessor) { used.insert(accessor); };
  for_each_index(array_in(document, "animations"), "input", add);
  for_each_index(array_in(document, "animations"), "output", add);
  for_each_index(array_in(document, "skins"), "inverseBindMatrices", add);
  return used;
}

std::uint64_t size_of(const Json& document, const char* array) {
  return array_in(document, array).size();
}

Json range_json(const DocumentEditor::Range& range) {
  Json json;
  json["buffer"] = range.buffer;
  json["byteOffset"] = range.offset;
  json["byteLength"] = range.length;
  if (range.padding > 0) json["extras"]["padding"] = range.padding;
  return json;
}

// Both ranges of a view: its own and, where it is compressed, that of the compressed bytes.
std::vector<const Json*> ranges_of(const Json& view) {
  std::vector<const Json*> ranges{&view};
  for (const char* name : {kMeshoptExtension, kKhrMeshoptExtension}) {
    if (const Json* extension = extension_in(view, name)) ranges.push_back(extension);
  }
  return ranges;
}

}  // namespace

IndexWidth vertex_index_width(std::uint64_t vertices) {
  return bytes_per_index(vertices) == 2 ? IndexWidth::two_bytes : IndexWidth::four_bytes;
}

IndexWidth value_width(std::uint64_t count) {
  if (count <= 256) return IndexWidth::one_byte;
  return count <= 65536 ? IndexWidth::two_bytes : IndexWidth::four_bytes;
}

Bytes pack(std::span<const std::uint32_t> values, IndexWidth width) {
  const std::uint64_t step = bytes_of(width);
  Bytes bytes(values.size() * step);
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t k = 0; k < step; ++k) {
      bytes[i * step + k] = static_cast<std::byte>((values[i] >> (8U * k)) & 255U);
    }
  }
  return bytes;
}

DocumentEditor::DocumentEditor(GltfDocument document) : document_(std::move(document)) {}

Json& DocumentEditor::primitive(std::uint32_t mesh, std::uint32_t index) {
  return document_.json["meshes"][mesh]["primitives"][index];
}

std::uint64_t DocumentEditor::append(const char* array, Json value) {
  Json& values = document_.json[array];
  values.push_back(std::move(value));
  return values.size() - 1;
}

std::uint64_t DocumentEditor::host_buffer() {
  if (!document_.buffers.empty() && document_.buffers[0].bytes != nullptr) return 0;
  return append_buffer(document_.buffers.empty() ? BufferStorage::binary_chunk : BufferStorage::data_uri);
}

std::uint64_t DocumentEditor::append_buffer(BufferStorage storage) {
  Json buffer;
  buffer["byteLength"] = 0;
  document_.buffers.push_back({storage, std::make_shared<const Bytes>(), true});
  return append("buffers", std::move(buffer));
}

Bytes& DocumentEditor::mutable_bytes(std::uint64_t buffer) {
  owned_.resize(std::max<std::size_t>(owned_.size(), buffer + 1));
  GltfBuffer& entry = document_.buffers[buffer];
  if (owned_[buffer] == nullptr) {
    owned_[buffer] = std::make_shared<Bytes>(*entry.bytes);
    entry.bytes = owned_[buffer];
    entry.changed = true;
  }
  return *owned_[buffer];
}

DocumentEditor::Range DocumentEditor::append_bytes(std::uint64_t buffer, const Bytes& bytes) {
  Bytes& data = mutable_bytes(buffer);
  const std::uint64_t padding = (4 - data.size() % 4) % 4;
  data.resize(data.size() + padding);
  const Range range{buffer, data.size(), bytes.size(), padding};
  data.insert(data.end(), bytes.begin(), bytes.end());
  return range;
}

std::uint64_t DocumentEditor::append_view(const Range& range) {
  return append("bufferViews", range_json(range));
}

std::uint64_t DocumentEditor::append_compressed_view(const Range& fallback, const Range& compressed,
                                                     IndexWidth width) {
  Json view = range_json(fallback);
  Json& extension = view["extensions"][kMeshoptExtension];
  extension = range_json(compressed);
  extension["byteStride"] = bytes_of(width);
  extension["mode"] = "INDICES";
  extension["count"] = fallback.length / bytes_of(width);
  return append("bufferViews", std::move(view));
}

std::uint64_t DocumentEditor::append_accessor(std::uint64_t view, std::uint64_t offset, IndexWidth width,
                                              std::uint64_t count) {
  Json accessor;
  accessor["bufferView"] = view;
  if (offset > 0) accessor["byteOffset"] = offset;
  accessor["componentType"] = static_cast<std::uint32_t>(width);
  accessor["count"] = count;
  accessor["type"] = "SCALAR";
  return append_accessor(std::move(accessor));
}

std::uint64_t DocumentEditor::append_accessor(Json accessor) {
  return append("accessors", std::move(accessor));
}

void DocumentEditor::overwrite(std::uint64_t buffer, std::uint64_t offset, const Bytes& bytes) {
  const Bytes& before = *document_.buffers[buffer].bytes;
  if (std::equal(bytes.begin(), bytes.end(), before.begin() + static_cast<std::ptrdiff_t>(offset))) return;
  std::memcpy(mutable_bytes(buffer).data() + offset, bytes.data(), bytes.size());
}

void DocumentEditor::remove_orders() {
  std::set<std::uint64_t> accessors;
  for (std::size_t m = 0; m < array_in(document_.json, "meshes").size(); ++m) {
    for (std::size_t p = 0; p < array_in(document_.json["meshes"][m], "primitives").size(); ++p) {
      Json& json = document_.json["meshes"][m]["primitives"][p];
      const Json* extension = extension_in(json, kOrderExtension);
      if (extension == nullptr) continue;
      for (const char* key : {"cellOrders", "patchOffsets", "indices", "patches", "times", "spheres"}) {
        for_each_index(*extension, key, [&](std::uint64_t accessor) { accessors.insert(accessor); });
      }
      json["extensions"].erase(kOrderExtension);
      if (json["extensions"].empty()) json.erase("extensions");
    }
  }
  withdraw_extension(kOrderExtension);
  const std::set<std::uint64_t> core = core_accessors(document_.json);
  std::vector<std::uint64_t> removable;
  std::set_difference(accessors.begin(), accessors.end(), core.begin(), core.end(),
                      std::back_inserter(removable));
  pop_accessors(removable);
}

void DocumentEditor::pop_last(const char* array) {
  Json& values = document_.json[array];
  values.erase(values.size() - 1);
  if (values.empty()) document_.json.erase(array);
}

void DocumentEditor::pop_accessors(const std::vector<std::uint64_t>& removable) {
  std::set<std::uint64_t> views;
  for (auto last = removable.rbegin(); last != removable.rend(); ++last) {
    if (*last + 1 != size_of(document_.json, "accessors")) break;
    for_each_index(document_.json["accessors"].back(), "bufferView",
                   [&](std::uint64_t view) { views.insert(view); });
    pop_last("accessors");
  }
  std::set<std::uint64_t> used;
  for_each_index(document_.json, "bufferView", [&](std::uint64_t view) { used.insert(view); });
  std::vector<std::uint64_t> unused;
  std::set_difference(views.begin(), views.end(), used.begin(), used.end(), std::back_inserter(unused));
  pop_views(unused);
}

void DocumentEditor::pop_views(const std::vector<std::uint64_t>& removable) {
  std::vector<Json> popped;
  for (auto last = removable.rbegin(); last != removable.rend(); ++last) {
    if (*last + 1 != size_of(document_.json, "bufferViews")) break;
    popped.push_back(document_.json["bufferViews"].back());
    pop_last("bufferViews");
  }
  cut_off(popped);

  bool compressed = false;
  for (const Json& view : popped) compressed |= extension_in(view, kMeshoptExtension) != nullptr;
  for (const char* array : {"bufferViews", "buffers"}) {
    for (const Json& value : array_in(document_.json, array)) {
      if (extension_in(value, kMeshoptExtension) != nullptr) compressed = false;
    }
  }
  if (compressed) withdraw_extension(kMeshoptExtension);
}

// Past the last byte of a buffer that a view needs.
std::uint64_t DocumentEditor::used_end(std::uint64_t buffer) const {
  std::uint64_t end = 0;
  for (const Json& view : array_in(document_.json, "bufferViews")) {
    for (const Json* range : ranges_of(view)) {
      if (index_in(*range, "buffer", 0) != buffer) continue;
      end = std::max(end, index_in(*range, "byteOffset", 0) + index_in(*range, "byteLength", 0));
    }
  }
  return end;
}

// Shorten buffers by the ranges of views that are gone, last one first, as far as these end them.
void DocumentEditor::cut_off(const std::vector<Json>& popped_views) {
  std::set<std::uint64_t> touched;
  for (const Json& view : popped_views) {
    for (const Json* range : ranges_of(view)) {
      const std::uint64_t buffer = index_in(*range, "buffer", 0);
      const std::uint64_t offset = index_in(*range, "byteOffset", 0);
      if (buffer >= document_.buffers.size()) continue;
      touched.insert(buffer);
      if (document_.buffers[buffer].bytes == nullptr) continue;
      const std::uint64_t size = document_.buffers[buffer].bytes->size();
      if (offset > size || index_in(*range, "byteLength", 0) != size - offset) continue;
      std::uint64_t padding = 0;
      if (range->contains("extras")) padding = index_in((*range)["extras"], "padding", 0);
      const std::uint64_t end = offset - std::min<std::uint64_t>({padding, 3, offset});
      mutable_bytes(buffer).resize(std::min(size, std::max(end, used_end(buffer))));
    }
  }
  pop_buffers({touched.begin(), touched.end()});
}

// Buffers that held nothing but orders are empty now.
void DocumentEditor::pop_buffers(const std::vector<std::uint64_t>& removable) {
  for (auto last = removable.rbegin(); last != removable.rend(); ++last) {
    const GltfBuffer& buffer = document_.buffers[*last];
    if (*last + 1 != document_.buffers.size() || used_end(*last) > 0) return;
    if (buffer.bytes != nullptr && !buffer.bytes->empty()) return;
    document_.buffers.pop_back();
    owned_.resize(std::min(owned_.size(), document_.buffers.size()));
    pop_last("buffers");
  }
}

void DocumentEditor::declare_extension(const char* name) {
  Json& used = document_.json["extensionsUsed"];
  if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
}

void DocumentEditor::withdraw_extension(const char* name) {
  const auto used = document_.json.find("extensionsUsed");
  if (used == document_.json.end() || !used->is_array()) return;
  const auto found = std::find(used->begin(), used->end(), name);
  if (found == used->end()) return;
  used->erase(found);
  if (used->empty()) document_.json.erase("extensionsUsed");
}

}  // namespace pellucid
