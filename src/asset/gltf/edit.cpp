// Implements edit.h: appends and removes accessors, buffer views and bytes, and finds which bytes are shared.
#include "asset/gltf/edit.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <set>

#include "asset/gltf/accessors.h"
#include "asset/gltf/json_fields.h"

namespace pellucid {
namespace {

// Returns json[key] if it is an array, or else an empty array.
const Json& array_in(const Json& json, const char* key) {
  static const Json kEmpty = Json::array();
  if (!json.is_object()) return kEmpty;
  const auto found = json.find(key);
  return found != json.end() && found->is_array() ? *found : kEmpty;
}

// Returns json[key] as an index, or `fallback` if there is none.
std::uint64_t index_in(const Json& json, const char* key, std::uint64_t fallback) {
  if (!json.is_object()) return fallback;
  const auto found = json.find(key);
  return found != json.end() ? as_index(*found).value_or(fallback) : fallback;
}

const Json* extension_in(const Json& json, const char* name) {
  if (!json.is_object() || !json.contains("extensions") || !json["extensions"].contains(name)) return nullptr;
  return &json["extensions"][name];
}

// Calls `visit(index)` for every value of `key` that is an index, anywhere under `json`. The parser limits
// the depth of a document.
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

// Returns the accessors that glTF itself refers to: attributes, targets, indices, animations, skins.
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

// Returns the ranges of a view: its own and, if it is compressed, that of the compressed bytes.
std::vector<const Json*> ranges_of(const Json& view) {
  std::vector<const Json*> ranges{&view};
  for (const char* name : {kMeshoptExtension, kKhrMeshoptExtension}) {
    if (const Json* extension = extension_in(view, name)) ranges.push_back(extension);
  }
  return ranges;
}

constexpr std::uint64_t kNobody = std::numeric_limits<std::uint64_t>::max();

// Bytes [begin, end) of a buffer, and the accessor that they belong to.
struct Claim {
  std::uint64_t buffer, begin, end, accessor;
};

void count_view_references(const Json& json, std::map<std::uint64_t, std::uint64_t>& references) {
  if (json.is_object()) {
    for (const auto& [key, value] : json.items()) {
      if (const auto view = key == "bufferView" ? as_index(value) : std::nullopt) ++references[*view];
      count_view_references(value, references);
    }
  } else if (json.is_array()) {
    for (const Json& value : json) count_view_references(value, references);
  }
}

// Returns 1 for every accessor that is used once as an index array and never as anything else, and another
// number for all others.
std::vector<std::uint32_t> count_references(const Fields& root) {
  std::vector<std::uint32_t> references(root.size("accessors"), 0);
  const auto add = [&](const Json& value, std::uint32_t weight) {
    const auto accessor = as_index(value);
    if (accessor && *accessor < references.size()) references[*accessor] += weight;
  };
  for (std::uint64_t m = 0; m < root.size("meshes"); ++m) {
    const Fields mesh = root.element("meshes", m);
    for (std::uint64_t p = 0; p < mesh.size("primitives"); ++p) {
      const Fields primitive = mesh.element("primitives", p);
      if (const Json* indices = primitive.find("indices")) add(*indices, 1);
      if (const auto attributes = primitive.find_object("attributes")) {
        for (const Json& value : attributes->json()) add(value, 2);
      }
    }
  }
  return references;
}

// Returns the size of an index, or 0 for a component type that indices cannot have.
std::uint64_t bytes_of_index(std::uint64_t component_type) {
  const bool is_unsigned =
      component_type == unsigned_byte || component_type == unsigned_short || component_type == unsigned_int;
  return is_unsigned ? bytes_of(component_type) : 0;
}

// Returns the bytes of the accessor if it is a plain index array, and nothing otherwise.
std::optional<Claim> plain_index_claim(const Fields& root, const Fields& accessor, std::uint64_t id) {
  const auto view_index = accessor.find_index("bufferView");
  if (!view_index || *view_index >= root.size("bufferViews")) return std::nullopt;
  const Fields view = root.element("bufferViews", *view_index);
  const std::uint64_t bytes = bytes_of_index(accessor.index("componentType"));
  if (bytes == 0 || accessor.text("type") != "SCALAR") return std::nullopt;
  if (accessor.has("sparse") || view.has("byteStride") || view.has("extensions")) return std::nullopt;
  const std::uint64_t begin = view.index_or("byteOffset", 0) + accessor.index_or("byteOffset", 0);
  return Claim{view.index("buffer"), begin, begin + accessor.index("count") * bytes, id};
}

// Returns one claim per plain index accessor of a view, and one for the whole view if anything else also
// refers to it.
std::vector<Claim> collect_claims(const Fields& root) {
  std::map<std::uint64_t, std::uint64_t> references;
  count_view_references(root.json(), references);
  std::map<std::uint64_t, std::vector<Claim>> by_view;
  for (std::uint64_t a = 0; a < root.size("accessors"); ++a) {
    const Fields accessor = root.element("accessors", a);
    if (const auto claim = plain_index_claim(root, accessor, a))
      by_view[accessor.index("bufferView")].push_back(*claim);
  }

  std::vector<Claim> claims;
  const auto claim_whole = [&](const Fields& range) {
    const std::uint64_t begin = range.index_or("byteOffset", 0);
    claims.push_back({range.index("buffer"), begin, begin + range.index("byteLength"), kNobody});
  };
  for (std::uint64_t v = 0; v < root.size("bufferViews"); ++v) {
    const Fields view = root.element("bufferViews", v);
    const std::vector<Claim>& plain = by_view[v];
    if (plain.size() == references[v] && !plain.empty()) {
      claims.insert(claims.end(), plain.begin(), plain.end());
    } else {
      claim_whole(view);
    }
    for (const char* name : {kMeshoptExtension, kKhrMeshoptExtension}) {
      if (const auto compression = view.extension(name)) claim_whole(*compression);
    }
  }
  return claims;
}

}  // namespace

ComponentWidth vertex_index_width(std::uint64_t vertices) {
  return bytes_per_index(vertices) == 2 ? ComponentWidth::two_bytes : ComponentWidth::four_bytes;
}

ComponentWidth value_width(std::uint64_t count) {
  if (count <= 256) return ComponentWidth::one_byte;
  return count <= 65536 ? ComponentWidth::two_bytes : ComponentWidth::four_bytes;
}

Bytes pack(std::span<const std::uint32_t> values, ComponentWidth width) {
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
                                                     ComponentWidth width) {
  Json view = range_json(fallback);
  Json& extension = view["extensions"][kMeshoptExtension];
  extension = range_json(compressed);
  extension["byteStride"] = bytes_of(width);
  extension["mode"] = "INDICES";
  extension["count"] = fallback.length / bytes_of(width);
  return append("bufferViews", std::move(view));
}

std::uint64_t DocumentEditor::append_accessor(std::uint64_t view, std::uint64_t offset, ComponentWidth width,
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

// Returns the end of the last byte of a buffer that a view needs.
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

// Shortens buffers by the ranges of removed views, the last one first, as long as these are at the end of the
// buffers.
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

// Removes buffers that held only orders and are now empty.
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

std::vector<bool> exclusive_index_accessors(const GltfDocument& document) {
  const Fields root(document.path, document.json, "");
  const std::vector<std::uint32_t> references = count_references(root);
  std::vector<Claim> claims = collect_claims(root);
  std::sort(claims.begin(), claims.end(), [](const Claim& a, const Claim& b) {
    return std::tuple(a.buffer, a.begin, a.end) < std::tuple(b.buffer, b.begin, b.end);
  });

  std::vector<bool> exclusive(references.size(), false);
  std::uint64_t covered = 0;  // the largest end of earlier claims in the same buffer
  for (std::size_t i = 0; i < claims.size(); ++i) {
    const Claim& claim = claims[i];
    if (i > 0 && claims[i - 1].buffer != claim.buffer) covered = 0;
    const bool overlaps_next =
        i + 1 < claims.size() && claims[i + 1].buffer == claim.buffer && claims[i + 1].begin < claim.end;
    if (claim.accessor != kNobody) {
      exclusive[claim.accessor] = references[claim.accessor] == 1 && covered <= claim.begin && !overlaps_next;
    }
    covered = std::max(covered, claim.end);
  }
  return exclusive;
}

}  // namespace pellucid
