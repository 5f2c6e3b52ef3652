// pellucid/subdivide.h - Loop subdivision of triangle meshes.
//
// In: triangles and the vertices that are welded. Out: the refined triangles, and for every refined vertex
// its weights over the vertices of the input, which apply to positions and to any other value per vertex.
//
// Based on: Loop, "Smooth subdivision surfaces based on triangles", University of Utah 1987, with the
// boundary rule of Hoppe et al., "Piecewise smooth surface reconstruction", SIGGRAPH 1994 (uniform cubic
// B-splines). OpenSubdiv performs the refinement.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/mesh.h"

namespace pellucid {

// The largest number of levels.
constexpr std::uint32_t kMostSubdivisions = 3;

// A refined mesh. The value at refined vertex v is the sum of weights[i] * (value at input vertex control[i])
// for i in first[v] .. first[v + 1] - 1. The value may be a position, a skinning weight or a displacement.
// The weights of a vertex are >= 0 and have the sum 1.
struct Subdivision {
  std::vector<Triangle> triangles;
  // Per refined triangle: the triangle of the input. Every triangle of the input with three distinct vertices
  // after welding has 4^levels consecutive triangles here; the others have none.
  std::vector<std::uint32_t> source;
  std::vector<std::uint32_t> first{0};  // one entry more than vertices
  std::vector<std::uint32_t> control;   // welded vertices: weld[control[i]] == control[i]
  std::vector<double> weights;          // as long as `control`

  [[nodiscard]] std::uint32_t vertices() const { return static_cast<std::uint32_t>(first.size() - 1); }
};

// Refines triangles `levels` (0 .. kMostSubdivisions) times. weld[v] is the vertex that stands for v, as
// returned by weld_by_position(), so weld[weld[v]] == weld[v]. Indices must be in range.
//
// Two triangles are neighbours if they use a welded edge in opposite directions. Pairs that share both
// unwelded vertices are joined first, and then the remaining two if there are exactly two. All other edges
// are boundaries: edges with one triangle, with three or more, or where two fronts meet with opposite
// winding. Each piece is therefore an oriented manifold. Boundaries are smoothed along themselves, so that a
// single triangle becomes round.
//
// Deterministic. Throws Error{bad_argument} for more levels, for a result of more than 2^28 triangles, and
// for levels > 0 if can_subdivide() is false.
Subdivision subdivide_loop(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld,
                           std::uint32_t levels);

// Returns false in a build without OpenSubdiv (PELLUCID_OPENSUBDIV=OFF).
bool can_subdivide();

// Returns the values at the refined vertices. `values` has one value per vertex of the input.
std::vector<Vec3f> refined_values(const Subdivision& subdivision, std::span<const Vec3f> values);

// Welds a mesh by position and refines it. The result has new normals if the input has normals. Throws as
// subdivide_loop().
Mesh subdivide(const Mesh& mesh, std::uint32_t levels);

}  // namespace pellucid
