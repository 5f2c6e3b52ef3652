// All occlusions between faces from ALL viewpoints of a view cell: the edges of T[n] and of view regions
// R[n]. Based on: Han, Chen, Nehab, Sander, "In-Depth Buffers", PACMCGIT 1(1), 2018, sections 2.1 and 2.2.
//
// Most edges of a cell are seen from its samples. Whether there is a viewpoint that sees another one is
// decided exactly (hiding_viewpoints.h) for the pairs that bounds cannot tell apart.
#pragma once

#include <cstdint>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/view.h"
#include "transparency/graph/hiding_viewpoints.h"
#include "transparency/graph/occlusion_graph.h"

namespace pellucid {

class RegionEdges {
 public:
  // `positions`: unit_positions(). With `front_only` back faces neither hide nor are hidden. `tolerance`:
  // faces are narrowed by half of it on all sides, so that overlaps thinner than that (bounding radii, in
  // space) make no edge.
  RegionEdges(const std::vector<Triangle>& triangles, const std::vector<Vec3d>& positions,
              const ViewPartition& partition, bool front_only, double tolerance, double from, double to);

  // The edges that samples of the cell show, and all others that any of its viewpoints sees. Weights below
  // kUnseenWeight, those of edges that no sample shows among them, become that. O(triangles^2).
  [[nodiscard]] EdgeRows complete(std::uint32_t cell, const EdgeRows& samples) const;

 private:
  const ViewPartition& partition_;
  double from_, to_;
  bool front_only_;
  std::vector<SolidFace> faces_;    // by node
  std::vector<std::uint8_t> wide_;  // per triangle: is anything left after narrowing?
};

}  // namespace pellucid
