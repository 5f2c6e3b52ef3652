// pellucid/cycles.h - module `order`: faces without a right drawing order, what they cost, and how to split
// them.
//
// From one viewpoint faces that pass through each other, and faces that overlap in a cycle, cannot all be
// drawn in the right order. In: a clean mesh. Out: how much of the picture that concerns, and the mesh with
// such faces cut (pellucid/split.h).
#pragma once

#include <cstdint>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/order.h"
#include "pellucid/split.h"
#include "pellucid/view.h"

namespace pellucid {

struct CycleOptions {
  std::vector<double> distances;  // of the viewpoints, as in OrderOptions; empty: default_distances()
  Facing facing = Facing::duplicated;
  std::uint64_t max_new_triangles = ~std::uint64_t{0};
  Progress* progress = nullptr;
};

struct SplitResult {
  MeshSplit split;
  std::uint64_t intersecting_pairs = 0;  // of triangles of the input
  std::uint64_t pairs_left = 0;          // of these, pairs that still intersect
  std::uint32_t viewpoints = 0;          // that cycles were looked for from
  std::uint32_t cyclic_before = 0;       // of these, viewpoints with a cycle; intersections were split before
  std::uint32_t cyclic_left = 0;
  std::uint64_t added_by_intersections = 0, added_by_cycles = 0;  // triangles
};
// Split intersecting triangles first. Then from 162 viewpoints (an icosphere's vertices, which take turns
// with the distances) find the strongly connected components of the exact occlusion graph, without edges that
// no pixel shows, and cut in each a triangle along the plane of another member, that which leaves the fewest
// triangles in cycles; again until no cycle is left, or no cut helps, or there are too many triangles.
// Components of more than 24 triangles are left alone. The mesh must be clean. Deterministic.
SplitResult split_unordered(const Mesh& mesh, const CycleOptions& options);

// Ranks of all nodes in the best order that is found for one viewpoint alone, by the raster: nodes in no
// cycle are right, the others are sifted. Pixels that it draws wrong have no right order (up to what sifting
// misses).
std::vector<std::uint32_t> best_ranks(const Mesh& mesh, const BoundingSphere& sphere,
                                      const Viewpoint& viewpoint, std::uint32_t raster_size, Facing facing);

}  // namespace pellucid
