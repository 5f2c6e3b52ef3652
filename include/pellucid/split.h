// pellucid/split.h - cuts triangles along the planes of other triangles.
//
// Faces that pass through each other, and faces that overlap in a cycle, have no correct draw order, but
// their pieces have one. In: a clean Mesh. Out: the same surface with more triangles, and the origin of every
// new triangle and vertex, so that the caller can interpolate its attributes. pellucid/transparency.h finds
// the cycles. The method and its cost are described in docs/in-depth-buffers.md, section 8.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/mesh.h"

namespace pellucid {

// ------------------------------------------------------------------------------------------- convex polygons

// Makes the point on the edge a - b of a polygon whose corners have the signed distances height_a and
// height_b from the plane, and returns its index.
using CutEdge =
    std::function<std::uint32_t(std::uint32_t a, std::uint32_t b, double height_a, double height_b)>;

// Cuts a convex polygon in two by a plane. `heights` are the signed distances of its corners from the plane.
// Corners nearer than `thickness` lie in the plane and can become corners of both parts. Where the plane
// crosses an edge between its ends, `cut_edge` is called once to make the new corner. Appends the corners of
// the parts to `front` (positive heights) and `back`, with the winding of the polygon. Requires corners on
// both sides, see crosses().
void cut_convex(std::span<const std::uint32_t> corners, std::span<const double> heights, double thickness,
                const CutEdge& cut_edge, std::vector<std::uint32_t>& front, std::vector<std::uint32_t>& back);

// Returns whether there are corners farther than `thickness` on both sides of the plane.
bool crosses(std::span<const double> heights, double thickness);

// ------------------------------------------------------------------------------------------------ the result

// A vertex that splitting added: a weighted sum of three vertices of the input. They are the corners of one
// triangle. On an edge, one of them is repeated with the weight 0.
struct SplitVertex {
  Triangle sources{};
  std::array<double, 3> weights{};  // >= 0 with the sum 1
};

struct MeshSplit {
  // The vertices of the input followed by the new ones, and every triangle of the input or its pieces in its
  // place.
  Mesh mesh;
  std::vector<SplitVertex> new_vertices;  // mesh.positions[vertices of the input + i]
  std::vector<std::uint32_t> source;      // per triangle of `mesh`: the triangle of the input
  bool complete = true;                   // false if max_new_triangles prevented a cut
};
// Returns two consecutive splits as one: `second` was made from the result of `first`.
MeshSplit compose(const MeshSplit& first, MeshSplit second);

// ------------------------------------------------------------------------------------------- intersections

// Tolerances are in bounding radii. If coordinates are so large compared to the radius that float32 resolves
// less, four times the resolution of float32 replaces the smaller tolerances.

// Triangles that extend less than this beyond each other's plane, or that cross along a shorter line, do not
// count as intersecting. With 1000 pixels across the mesh this is 1/200 of a pixel.
constexpr double kLeastCrossing = 1e-5;
// A point nearer to a plane than this lies in the plane.
constexpr double kPlaneThickness = 1e-6;

struct SplitOptions {
  // The largest number of triangles by which the result may exceed the input. Unlimited by default.
  std::uint64_t max_new_triangles = ~std::uint64_t{0};
  Progress* progress = nullptr;  // may be null
};

// Returns the pairs of triangles that pass through each other, each with the smaller index first, in sorted
// order. Neighbours that share an edge, triangles that only touch, and coplanar overlaps do not count. Takes
// O(n log n + pairs of overlapping boxes). Throws Error{interrupted} if `progress` requests it.
std::vector<std::array<std::uint32_t, 2>> find_intersections(const Mesh& mesh, Progress* progress = nullptr);

struct IntersectionSplit {
  MeshSplit split;
  std::uint64_t pairs = 0;  // intersecting pairs of the input
  std::uint64_t left = 0;   // pairs of the input that still have intersecting pieces
};
// Cuts one triangle of every intersecting pair along the plane of the other, and only those pieces that still
// cross the other. Neighbours receive the new vertices of their edges, with exactly the same positions, so
// that no gaps open. Vertices on the two sides of a seam stay separate. New positions are rounded to float32,
// so pieces stay coplanar up to that rounding. Deterministic. The mesh must be clean. Throws
// Error{interrupted} if options.progress requests it.
IntersectionSplit split_intersections(const Mesh& mesh, const SplitOptions& options = {});

// A cut of a triangle along the plane of another one.
struct TriangleCut {
  std::uint32_t triangle = 0;
  std::uint32_t by = 0;  // the triangle whose plane cuts
};
// Makes the given cuts in their order, under the same guarantees as split_intersections().
MeshSplit cut_triangles(const Mesh& mesh, std::span<const TriangleCut> cuts,
                        const SplitOptions& options = {});

}  // namespace pellucid
