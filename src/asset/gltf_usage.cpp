// Which accessors may be overwritten in place: see gltf_usage.h.
#include "asset/gltf_usage.h"

#include <algorithm>
#include <limits>
#include <map>

#include "asset/json_fields.h"

namespace pellucid {
namespace {

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

// Every accessor index that is used as an index array once, and never as anything else: 1; others: more, or
// 0.
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

std::uint64_t index_bytes(std::uint64_t component_type) {
  switch (component_type) {
    case 5121:
      return 1;
    case 5123:
      return 2;
    case 5125:
      return 4;
    default:
      return 0;
  }
}

// The accessor's own bytes where it is a plain index array; empty where it is anything else.
std::optional<Claim> plain_index_claim(const Fields& root, const Fields& accessor, std::uint64_t id) {
  const auto view_index = accessor.find_index("bufferView");
  if (!view_index || *view_index >= root.size("bufferViews")) return std::nullopt;
  const Fields view = root.element("bufferViews", *view_index);
  const std::uint64_t bytes = index_bytes(accessor.index("componentType"));
  if (bytes == 0 || accessor.text("type") != "SCALAR") return std::nullopt;
  if (accessor.has("sparse") || view.has("byteStride") || view.has("extensions")) return std::nullopt;
  const std::uint64_t begin = view.index_or("byteOffset", 0) + accessor.index_or("byteOffset", 0);
  return Claim{view.index("buffer"), begin, begin + accessor.index("count") * bytes, id};
}

// One claim per plain index accessor of a view; the whole view where anything else looks into it too.
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

std::vector<bool> exclusive_index_accessors(const GltfDocument& document) {
  const Fields root(document.path, document.json, "");
  const std::vector<std::uint32_t> references = count_references(root);
  std::vector<Claim> claims = collect_claims(root);
  std::sort(claims.begin(), claims.end(), [](const Claim& a, const Claim& b) {
    return std::tuple(a.buffer, a.begin, a.end) < std::tuple(b.buffer, b.begin, b.end);
  });

  std::vector<bool> exclusive(references.size(), false);
  std::uint64_t covered = 0;  // furthest end of the claims before this one, in its buffer
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
