// pellucid/subdivide.h - module `mesh`: Loop subdivision, as triangles and stencils.
//
// After Loop, "Smooth subdivision surfaces based on triangles", University of Utah 1987, with the rule of
// Hoppe et al., SIGGRAPH 1994, at boundaries (uniform cubic B-splines); refined by OpenSubdiv.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/mesh.h"

namespace pellucid {

constexpr std::uint32_t kMostSubdivisions = 3;

// The refined mesh. Vertex v is the sum of weight * (value at control vertex) over the entries first[v] ..
// first[v + 1] - 1, whatever the value is: a position, a weight, a displacement. The weights of a vertex are
// >= 0 and their sum is 1.
struct Subdivision {
  std::vector<Triangle> triangles;
  // 4^levels triangles follow each other for every triangle of the input that has three distinct vertices
  // after welding; the input's other triangles have none. source[t]: triangle of the input.
  std::vector<std::uint32_t> source;
  std::vector<std::uint32_t> first{0};  // one more than vertices
  std::vector<std::uint32_t> control;   // welded: control == weld[control]
  std::vector<double> weights;

  [[nodiscard]] std::uint32_t vertices() const { return static_cast<std::uint32_t>(first.size() - 1); }
};

// Refine `levels` (0 .. kMostSubdivisions) times. weld[v] is the vertex that v is taken for
// (weld_by_position), with weld[weld[v]] == weld[v]; indices are in range. Two triangles are neighbours where
// they share a welded edge that they pass in opposite directions: those that share both unwelded vertices
// first, then the only two that are left. All other edges (with one triangle, with three, where fronts meet
// backs) are boundaries, so that each piece is an oriented manifold. Boundaries are smoothed along
// themselves: a triangle by itself becomes round, and pieces that meet stay together where their boundaries
// run on together. Deterministic. Throws Error{bad_argument} for more levels or a result of more than 2^28
// triangles, and for any level but 0 where can_subdivide() is false.
Subdivision subdivide_loop(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld,
                           std::uint32_t levels);

// Returns false in a build without OpenSubdiv (PELLUCID_OPENSUBDIV).
bool can_subdivide();

// Values of the refined vertices; one value per control vertex.
std::vector<Vec3f> refined_values(const Subdivision& subdivision, std::span<const Vec3f> values);

// A mesh welded by position, refined; it has normals (recomputed) if the input has.
Mesh subdivide(const Mesh& mesh, std::uint32_t levels);

}  // namespace pellucid
