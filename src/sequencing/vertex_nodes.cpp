// Which nodes use a vertex: see vertex_nodes.h.
#include "sequencing/vertex_nodes.h"

#include <numeric>

namespace pellucid {

VertexNodes::VertexNodes(const Mesh& mesh, std::span<const std::uint8_t> drawn) {
  offsets_.assign(mesh.positions.size() + 1, 0);
  for (NodeId node = 0; node < drawn.size(); ++node) {
    if (drawn[node] == 0) continue;
    for (const std::uint32_t vertex : mesh.triangles[triangle_of(node)]) ++offsets_[vertex + 1];
  }
  std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
  nodes_.resize(offsets_.back());
  std::vector<std::uint32_t> cursor(offsets_.begin(), offsets_.end() - 1);
  for (NodeId node = 0; node < drawn.size(); ++node) {
    if (drawn[node] == 0) continue;
    for (const std::uint32_t vertex : mesh.triangles[triangle_of(node)]) nodes_[cursor[vertex]++] = node;
  }
}

}  // namespace pellucid
