// Finds all occlusions between faces from one viewpoint, weighted by the area of the image that they concern.
// In: a mesh and a viewpoint. Out: edges (front, back, area), in rows by the triangle in front.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/raster.h"
#include "pellucid/sequencing.h"
#include "pellucid/view.h"
#include "transparency/graph/screen_pairs.h"

namespace pellucid {

// The edges of one viewpoint, grouped by the triangle in front. A viewpoint sees only one facing of a
// triangle, so `front_flipped` tells which node a row belongs to.
struct ViewpointEdges {
  std::vector<std::uint32_t> offsets;  // triangles + 1: rows by front triangle
  std::vector<NodeId> backs;
  std::vector<float> areas;                 // square bounding radii of the image
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
  std::vector<float> light;  // per triangle: mean light transmittance
  std::vector<std::uint64_t> keys;
};

// The input that is the same for all viewpoints.
struct OcclusionScene {
  const Mesh& mesh;
  BoundingSphere sphere;
  std::vector<Vec3d> positions;  // unit_positions()
  bool front_only = false;       // single-sided: back faces do not hide and are not hidden
  double tolerance = 0;          // bounding radii
  std::uint32_t raster_size = 512;
  double alpha = 0;  // > 0: areas are weighted by the light transmittance of the layers in front of them
};

// Finds every pair of faces that overlap in the image, by geometry (section 2.2 of the paper, one viewpoint).
void find_edges_exactly(const OcclusionScene& scene, const Viewpoint& viewpoint, OcclusionScratch& scratch,
                        ViewpointEdges& out);

// Finds pairs of faces that have consecutive fragments in a pixel, by sampling. The order along a ray is
// transitive, so these pairs imply the others. Overlaps that contain no pixel centre are missed.
void find_edges_by_raster(const OcclusionScene& scene, const Viewpoint& viewpoint, OcclusionScratch& scratch,
                          ViewpointEdges& out);

// ----------------------------------------------------------------------------------------- light
// transmittance

// With faces of opacity alpha, a fragment behind n others contributes (1 - alpha)^n of its colour, the light
// transmittance of these n layers. So the error of an overlap in the wrong order is weakened by that factor.

constexpr float kNoLightKnown = -1;

// Sets light[triangle], for all triangles below light.size(), to the mean of (1 - alpha)^(fragments in
// front) over the fragments of the triangle. Triangles without fragments get kNoLightKnown.
void find_light_of_triangles(const FragmentBuffer& fragments, double alpha, std::vector<float>& light);

// Does the same for all triangles that the viewpoint sees, with a small image. A triangle without fragments
// gets the light at the pixel of its middle. Takes O(triangles + fragments). `fragments` is scratch memory.
void find_light(const OcclusionScene& scene, const Viewpoint& viewpoint, const ScreenTriangles& screen,
                FragmentBuffer& fragments, std::vector<float>& light);

}  // namespace pellucid
