// Implements cleaned.h: meshes as they are written.
#include "cleaned.h"

#include <limits>

namespace pellucid::cli {
namespace {

constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

}  // namespace

Mesh compacted(const Mesh& mesh) {
  std::vector<std::uint32_t> new_number(mesh.positions.size(), kNowhere);
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) new_number[vertex] = 0;
  }
  Mesh compact;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (new_number[v] == kNowhere) continue;
    new_number[v] = static_cast<std::uint32_t>(compact.positions.size());
    compact.positions.push_back(mesh.positions[v]);
    if (!mesh.normals.empty()) compact.normals.push_back(mesh.normals[v]);
  }
  compact.triangles = mesh.triangles;
  for (Triangle& triangle : compact.triangles) {
    for (std::uint32_t& vertex : triangle) vertex = new_number[vertex];
  }
  return compact;
}

}  // namespace pellucid::cli
