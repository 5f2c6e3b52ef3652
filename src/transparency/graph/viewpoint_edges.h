// All occlusions between faces from one viewpoint, weighted by the area of the picture that they concern.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/raster.h"
#include "pellucid/sequencing.h"
#include "pellucid/view.h"
#include "transparency/graph/pair_search.h"
#include "transparency/graph/pair_test.h"
#include "transparency/graph/screen_triangles.h"

namespace pellucid {

// Edges of one viewpoint, grouped by the triangle in front. From one viewpoint a triangle shows one facing
// only, so `front_flipped` tells which node a row belongs to.
struct ViewpointEdges {
  std::vector<std::uint32_t> offsets;  // triangles + 1: rows by front triangle
  std::vector<NodeId> backs;
  std::vector<float> areas;                 // square bounding radii of the picture
  std::vector<std::uint8_t> front_flipped;  // per triangle
  std::uint64_t intersecting = 0;           // pairs of faces that each hide a part of the other
  void clear() { *this = {}; }
};

// Scratch memory for one thread.
struct OcclusionScratch {
  ScreenTriangles screen;
  PairSearch search;
  std::vector<CandidatePair> pairs, doubtful;
  std::vector<PairEdge> edges;
  FragmentBuffer fragments;
  std::vector<float> light;  // per triangle
  std::vector<std::uint64_t> keys;
};

// What does not change from viewpoint to viewpoint.
struct OcclusionScene {
  const Mesh& mesh;
  BoundingSphere sphere;
  std::vector<Vec3d> positions;  // unit_positions()
  bool front_only = false;       // single-sided: back faces neither hide nor are hidden
  double tolerance = 0;          // bounding radii
  std::uint32_t raster_size = 512;
  double alpha = 0;  // > 0: areas are weighed by the light that reaches them (transmittance.h)
};

// By geometry: every pair of faces that overlap in the picture (section 2.2 of the paper, one viewpoint).
void find_edges_exactly(const OcclusionScene& scene, const Viewpoint& viewpoint, OcclusionScratch& scratch,
                        ViewpointEdges& out);

// By sampling: faces of consecutive fragments of a pixel. Order along a ray is transitive, so these imply the
// rest; overlaps that no pixel centre meets are missed.
void find_edges_by_raster(const OcclusionScene& scene, const Viewpoint& viewpoint, OcclusionScratch& scratch,
                          ViewpointEdges& out);

}  // namespace pellucid
