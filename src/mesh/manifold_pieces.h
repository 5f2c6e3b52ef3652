// Internal to the module `mesh`: a triangle soup becomes oriented manifold pieces, by doubling vertices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/mesh.h"

namespace pellucid {

struct ManifoldPieces {
  std::vector<Triangle> triangles;    // without those that have two equal welded vertices
  std::vector<std::uint32_t> source;  // triangle of the input
  std::vector<std::uint32_t> welded;  // of every new vertex: the welded vertex that it stands at
};

// Every edge of the result has one triangle or two that pass it in opposite directions, and the triangles at
// a vertex form one fan. O(n log n). Neighbours: see pellucid/subdivide.h.
ManifoldPieces make_manifold(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld);

}  // namespace pellucid
