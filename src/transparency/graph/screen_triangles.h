// The mesh as one viewpoint sees it: projected, turned to face the camera, ready for pair tests.
//
// Projection. With unit axes (right, up, direction) and positions (a, b, c) in them relative to the bounding
// sphere (centre 0, radius 1), a camera at distance D sees the point at s * (a, b, c), s = D / (D - c); D =
// infinity gives s = 1. The map takes planes to planes and view rays to lines along the third coordinate, so
// that every pair test is orthographic afterwards: (x, y) is the picture in bounding radii at the sphere's
// centre depth, and a larger height h is nearer to the camera.
#pragma once

#include <cstdint>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/view.h"

namespace pellucid {

struct ViewAxes {
  Vec3d right, up, direction;
};
ViewAxes view_axes(const Vec3d& direction);

// Positions relative to the bounding sphere: centre 0, radius 1. One per mesh vertex.
std::vector<Vec3d> unit_positions(const Mesh& mesh, const BoundingSphere& sphere);

// What the narrow phase reads of a triangle: one cache line, gathered by pair.
struct alignas(64) ScreenTriangle {
  float x[3], y[3];        // corners, counter-clockwise in the picture
  float height;            // h at corner 0
  float slope_x, slope_y;  // dh/dx, dh/dy
  float min_height, max_height;
  float padding[5];
};
static_assert(sizeof(ScreenTriangle) == 64);

struct Bounds2 {
  float min_x, min_y, max_x, max_y;
};

struct ScreenTriangles {
  std::vector<Vec3d> vertices;            // projected (x, y, h) of every mesh vertex
  std::vector<ScreenTriangle> triangles;  // those that the camera sees with an area
  std::vector<Bounds2> bounds;
  std::vector<std::uint32_t> nodes;   // node id of each
  std::vector<std::uint8_t> flipped;  // per mesh triangle: does the camera see its back?
};

// Rebuild `out` for a viewpoint. With `front_only` triangles seen from behind are left out.
void project_triangles(const std::vector<Vec3d>& positions, const std::vector<Triangle>& triangles,
                       const Viewpoint& viewpoint, bool front_only, ScreenTriangles& out);

}  // namespace pellucid
