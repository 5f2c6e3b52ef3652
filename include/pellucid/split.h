// pellucid/split.h - module `mesh`: triangles cut along each other's planes.
//
// Faces that pass through each other, and faces that overlap in a cycle, have no right drawing order; their
// pieces have one. In: a clean Mesh. Out: the same surface with more triangles, and where each of them and of
// the new vertices comes from, so that whoever holds attributes can interpolate them. pellucid/transparency.h
// (module `transparency`) finds the cycles. How it works and what it costs: docs/in-depth-buffers.md,
// section 8.
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

// Cut a convex polygon in two by a plane. `heights` are the signed distances of its corners from the plane;
// corners nearer than `thickness` are in it. Where no corner is, `cut_edge(a, b, height_a, height_b)` makes
// the point between two neighbouring corners (it is asked once per edge). Every edge of the polygon is in
// exactly one part. Only for polygons with corners on both sides, see crosses().
using CutEdge = std::function<std::uint32_t(std::uint32_t, std::uint32_t, double, double)>;
void cut_convex(std::span<const std::uint32_t> corners, std::span<const double> heights, double thickness,
                const CutEdge& cut_edge, std::vector<std::uint32_t>& front, std::vector<std::uint32_t>& back);

// Is there a corner further than `thickness` on either side?
bool crosses(std::span<const double> heights, double thickness);

// ------------------------------------------------------------------------------------------------ the result

// A vertex that splitting added: the weighted sum of three vertices of the input. They are the corners of one
// triangle, or twice the same vertex with a weight of 0 where only the ends of an edge count.
struct SplitVertex {
  Triangle sources{};
  std::array<double, 3> weights{};  // >= 0, their sum is 1
};

struct MeshSplit {
  // The vertices of the input, then the new ones; every triangle of the input or, in its place, its pieces.
  Mesh mesh;
  std::vector<SplitVertex> new_vertices;  // mesh.positions[vertices of the input + i]
  std::vector<std::uint32_t> source;      // per triangle of `mesh`: the triangle of the input
  bool complete = true;                   // false: max_new_triangles was met
};
// First `first`, then `second` on its result, as one split of the input of `first`.
MeshSplit compose(const MeshSplit& first, MeshSplit second);

// ------------------------------------------------------------------------------------------- intersections

// All tolerances are in bounding radii. Where the coordinates are large against the radius, so that float32
// resolves less, four times their resolution takes the place of the smaller ones.

// Faces that reach less than this beyond each other's plane, or cross along less, do not count as
// intersecting: at 1000 pixels across the mesh this is a two-hundredth of a pixel.
constexpr double kLeastCrossing = 1e-5;
// Nearer to a plane than this is in it.
constexpr double kPlaneThickness = 1e-6;

struct SplitOptions {
  // The result has at most so many triangles more than the input (unlimited by default).
  std::uint64_t max_new_triangles = ~std::uint64_t{0};
  Progress* progress = nullptr;
};

// Pairs of triangles (smaller number first, sorted) that pass through each other. Neighbours that share an
// edge or only touch do not; coplanar overlaps are none. O(n log n + pairs of overlapping boxes).
std::vector<std::array<std::uint32_t, 2>> find_intersections(const Mesh& mesh, Progress* progress = nullptr);

struct IntersectionSplit {
  MeshSplit split;
  std::uint64_t pairs = 0;  // of intersecting triangles of the input
  std::uint64_t left = 0;   // of these, pairs that still have intersecting pieces
};
// Cut one triangle of every intersecting pair along the plane of the other, and only those of its pieces that
// still meet the other. Neighbours get the new vertices of their edges too: their positions are equal to the
// bit, so that the surface stays as tight as it was. Seams keep vertices of their own on either side.
// Coplanar pieces stay pieces of their triangle: new positions are rounded to float32 and nothing else.
// Deterministic. The mesh must be clean.
IntersectionSplit split_intersections(const Mesh& mesh, const SplitOptions& options = {});

// Cut triangles by planes of others.
struct TriangleCut {
  std::uint32_t triangle = 0;
  std::uint32_t by = 0;  // the triangle whose plane cuts
};
MeshSplit cut_triangles(const Mesh& mesh, std::span<const TriangleCut> cuts,
                        const SplitOptions& options = {});

}  // namespace pellucid
