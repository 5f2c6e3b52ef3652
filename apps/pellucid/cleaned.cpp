// Implements cleaned.h: meshes as they are written.
#include "cleaned.h"

#include <limits>

namespace pellucid::cli {
namespace {

constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

// Keeps the entries of an attribute that belong to `kept` vertices.
template <class Entry>
void keep_entries(std::vector<Entry>& entries, const std::vector<std::uint32_t>& kept) {
  if (entries.empty()) return;
  // Vertices keep their order, so none is overwritten before it is read.
  for (std::size_t i = 0; i < kept.size(); ++i) entries[i] = entries[kept[i]];
  entries.resize(kept.size());
}

}  // namespace

Mesh compacted(const Mesh& mesh, std::vector<std::uint32_t>* kept) {
  std::vector<std::uint32_t> new_number(mesh.positions.size(), kNowhere);
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) new_number[vertex] = 0;
  }
  Mesh compact;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (new_number[v] == kNowhere) continue;
    new_number[v] = static_cast<std::uint32_t>(compact.positions.size());
    compact.positions.push_back(mesh.positions[v]);
    if (kept != nullptr) kept->push_back(static_cast<std::uint32_t>(v));
    if (!mesh.normals.empty()) compact.normals.push_back(mesh.normals[v]);
  }
  compact.triangles = mesh.triangles;
  for (Triangle& triangle : compact.triangles) {
    for (std::uint32_t& vertex : triangle) vertex = new_number[vertex];
  }
  return compact;
}

void clean_for_writing(Primitive& primitive, const CleanOptions& options) {
  std::vector<std::uint32_t> kept;
  primitive.mesh = compacted(clean(primitive.mesh, options, primitive.name).mesh, &kept);
  keep_entries(primitive.colors, kept);
  keep_entries(primitive.texcoords, kept);
}

}  // namespace pellucid::cli
