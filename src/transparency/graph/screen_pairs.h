// Projects a mesh for one viewpoint, finds the pairs of triangles that overlap in the image, and decides
// which of the two is in front. In: positions, triangles and a viewpoint. Out: pairs with the area of their
// overlap.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/view.h"

namespace pellucid {

// ------------------------------------------------------------------------------------------------ projection

// Take unit axes (right, up, direction), and positions (a, b, c) in them relative to the bounding sphere
// (centre 0, radius 1). A camera at distance D sees the point at s * (a, b, c) with s = D / (D - c); D =
// infinity gives s = 1. The map takes planes to planes, and view rays to lines along the third coordinate. So
// every pair test is orthographic afterwards: (x, y) is the image in bounding radii at the depth of the
// sphere's centre, and a larger height h is nearer to the camera.

struct ViewAxes {
  Vec3d right, up, direction;
};
ViewAxes view_axes(const Vec3d& direction);

// Returns the positions of all mesh vertices relative to the bounding sphere: centre 0, radius 1.
std::vector<Vec3d> unit_positions(const Mesh& mesh, const BoundingSphere& sphere);

// The data of a triangle that the narrow phase reads. It fills one cache line.
struct alignas(64) ScreenTriangle {
  float x[3], y[3];        // corners, counter-clockwise in the image
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

// Projects all triangles into `out` and turns those that are seen from behind, so that all are
// counter-clockwise. With `front_only`, triangles seen from behind are left out.
void project_triangles(const std::vector<Vec3d>& positions, const std::vector<Triangle>& triangles,
                       const Viewpoint& viewpoint, bool front_only, ScreenTriangles& out);

// ----------------------------------------------------------------------------------------------- broad phase

// A pair of indices into ScreenTriangles::triangles.
struct CandidatePair {
  std::uint32_t a, b;
  bool operator==(const CandidatePair&) const = default;
};

// Finds all pairs of projected triangles whose bounds overlap in the image, each exactly once. It uses a
// uniform grid over the image with cells about one triangle wide; the object is kept between viewpoints to
// reuse its memory. A pair is reported in the grid cell that holds the lower corner of the intersection of
// its bounds. Expected O(triangles + pairs) for triangles of similar size.
class PairSearch {
 public:
  // Replaces `pairs` by all overlapping pairs, in an order that depends on the input alone.
  void find(const std::vector<Bounds2>& bounds, std::vector<CandidatePair>& pairs);

 private:
  struct CellRange {
    std::int32_t x0, y0, x1, y1;
  };
  void choose_grid(const std::vector<Bounds2>& bounds);
  void fill_grid(const std::vector<Bounds2>& bounds);
  [[nodiscard]] CellRange cells_of(const Bounds2& b) const;

  float origin_x_ = 0, origin_y_ = 0, scale_ = 1;
  std::int32_t columns_ = 1, rows_ = 1;
  std::vector<std::uint32_t> starts_;  // per grid cell, into the entry arrays
  std::vector<std::uint32_t> cursor_;
  // One entry per triangle and grid cell it touches, structure of arrays in cell order. `begins` has bit 0
  // set where the triangle's bounds begin in this column, bit 1 for the row.
  std::vector<float> min_x_, min_y_, max_x_, max_y_;
  std::vector<std::int32_t> begins_, index_;
};

// ---------------------------------------------------------------------------------------------- narrow phase

// Decides which of two projected triangles covers the other, and over what area of the image. For
// counter-clockwise triangles A and B, the 9 + 9 edge functions of one at the corners of the other give the
// answer without branches: whether they are apart, and which part of every edge lies inside the other
// triangle (Liang-Barsky). These parts are the boundary of the overlap. They give its area (Green's theorem)
// and the extremes of the height difference, which is linear over the overlap and therefore extreme at the
// ends of the parts.

// An occlusion between two faces at one viewpoint: `front` covers `area` (square radii) of the image of
// `back`.
struct PairEdge {
  std::uint32_t front, back;  // indices into ScreenTriangles::triangles
  float area;
};

// Appends the edges of `pairs` to `edges`, and appends to `doubtful` the pairs that single precision cannot
// decide or that intersect. Overlaps thinner than `tolerance` radii (across any edge of either triangle) make
// no edge.
void test_pairs(const ScreenTriangles& screen, std::span<const CandidatePair> pairs, float tolerance,
                std::vector<PairEdge>& edges, std::vector<CandidatePair>& doubtful);

// Does the same arithmetic without SIMD and gives the same bits. The tests compare the two.
void test_pairs_scalar(const ScreenTriangles& screen, std::span<const CandidatePair> pairs, float tolerance,
                       std::vector<PairEdge>& edges, std::vector<CandidatePair>& doubtful);

// Tests one pair in double precision by polygon clipping. Faces that intersect each cover a part of the other
// and make two edges. Coincident faces make none. Returns whether the pair intersects.
bool test_pair_precisely(const ScreenTriangles& screen, const std::vector<Triangle>& triangles,
                         CandidatePair pair, std::vector<PairEdge>& edges);

}  // namespace pellucid
