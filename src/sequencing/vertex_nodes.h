// Which nodes use a vertex: what every vertex-cache method walks along.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/sequencing.h"

namespace pellucid {

class VertexNodes {
 public:
  VertexNodes(const Mesh& mesh, std::span<const std::uint8_t> drawn);

  [[nodiscard]] std::span<const NodeId> of(std::uint32_t vertex) const {
    return std::span(nodes_).subspan(offsets_[vertex], offsets_[vertex + 1] - offsets_[vertex]);
  }

 private:
  std::vector<std::uint32_t> offsets_;  // vertices + 1
  std::vector<NodeId> nodes_;           // drawn nodes, ascending for every vertex
};

}  // namespace pellucid
