// Finds all occlusions between faces from all viewpoints of a view cell: the edges of T[n] and of the view
// regions R[n]. In: triangles, and the edges that the samples of the cell show. Out: these and all others.
//
// Based on: Han, Chen, Nehab, Sander, "In-Depth Buffers", PACMCGIT 1(1), 2018, sections 2.1 and 2.2.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/raster.h"
#include "pellucid/view.h"
#include "transparency/graph/occlusion_graph.h"

namespace pellucid {

// ---------------------------------------------------------------------------------- the viewpoints of a cell

// The viewpoints of a cell of T[n] or R[n] are a solid: a cone over a spherical triangle, between two
// distances. It is not a polytope, because it is hollow towards the centre and bulges outwards. So it is
// enclosed in the smallest frustum of five planes: three through the centre, the plane through the corners at
// the least distance, and the plane that touches the sphere of the greatest distance. The frustum is cut like
// any polytope. At the end holds_part_of() tests whether what is left still reaches the least distance. The
// farthest point of a polytope is a vertex, so this test is exact.

// The eyes with dot(normal, at) + offset * w >= 0. Eyes at infinity have w = 0.
struct HalfSpace {
  Vec3d normal;  // unit
  double offset = 0;
  [[nodiscard]] double value(const Eye& eye) const { return dot(normal, eye.at) + offset * eye.w; }
};

// A convex polytope of eyes, scaled so that |x| + |y| + |z| + w is about 1. Every vertex has one bit for each
// of its planes. Two vertices with two planes in common are the ends of an edge.
class ViewPolytope {
 public:
  struct Vertex {
    Eye eye;
    std::uint64_t planes;
  };
  // Becomes a copy of another polytope. This is faster than =, which also copies unused memory.
  void copy(const ViewPolytope& other);
  void clear() { count_ = 0; }
  // Keeps the part in the half-space and 1e-11 beyond it. Keeps everything if there are too many vertices or
  // planes.
  void cut(const HalfSpace& half_space);
  void add(const Eye& eye, std::uint64_t planes);
  void set_plane_count(std::uint32_t count) { plane_count_ = count; }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] std::span<const Vertex> vertices() const { return {vertices_.data(), count_}; }

 private:
  static constexpr std::size_t kMostVertices = 128;
  std::array<Vertex, kMostVertices> vertices_{};
  std::size_t count_ = 0;
  std::uint32_t plane_count_ = 0;
};

struct ViewSolid {
  Vec3d axis;       // unit: the same angle to all three corners
  double from = 0;  // least distance
  ViewPolytope frustum;
  // Returns whether a part of the frustum lies in the solid. Conservative only at the greatest distance.
  [[nodiscard]] bool holds_part_of(const ViewPolytope& polytope) const;
};

// Makes the solid of a cell from its three corner directions. Distances are in the units of positions, from
// their centre: 0 < from <= to; infinity is allowed.
ViewSolid make_view_solid(const std::array<Vec3d, 3>& corners, double from, double to);

// ------------------------------------------------------------ the viewpoints from which a face hides another

// Let A be the part of the front face before the plane of the other face, and B the part of the other face
// behind the plane of the front face. The line from y in B to x in A continues to the viewpoints x + t (x -
// y), t >= 0. All of these are A + cone(A - B). This is a convex set: the intersection of the half-spaces of
// all planes that separate A from B and touch both, with A in front. All its points see the fronts of both
// faces, and from no other point A hides B. Chen, Sander, Nehab, Yang, Hu, "Depth-Presorted Triangle Lists",
// SIGGRAPH Asia 2012, call it the occlusion region.

// One facing of a triangle, in bounding radii about the sphere's centre.
struct SolidFace {
  std::array<Vec3d, 3> corners;
  HalfSpace front;
  // A face that is seen under a smaller angle than this (radians) is edge-on. It does not hide and is not
  // hidden.
  double edge_on = 0;
};

// Sets `viewpoints` to the part of the solid's frustum from which `front` hides a part of `back`. It is never
// too small, except for viewpoints within `edge_on` of the plane of a face, and for parts that are nearer
// than 1e-7 to the plane of the other face.
void find_hiding_viewpoints(const ViewSolid& solid, const SolidFace& front, const SolidFace& back,
                            ViewPolytope& viewpoints);

// --------------------------------------------------------------------------------------- the edges of a cell

// Most edges of a cell are seen from its samples. Bounds exclude most other pairs. For the rest
// find_hiding_viewpoints() decides exactly whether some viewpoint sees the edge.

class RegionEdges {
 public:
  // `positions`: unit_positions(). With `front_only`, back faces do not hide and are not hidden. Faces are
  // narrowed by half of `tolerance` on all sides, so that overlaps thinner than `tolerance` (bounding radii,
  // in space) make no edge.
  RegionEdges(const std::vector<Triangle>& triangles, const std::vector<Vec3d>& positions,
              const ViewPartition& partition, bool front_only, double tolerance, double from, double to);

  // Returns the edges that the samples of the cell show, and all others that any of its viewpoints sees. No
  // weight is less than kUnseenWeight, which is the weight of edges that no sample shows. Takes
  // O(triangles^2).
  [[nodiscard]] EdgeRows complete(std::uint32_t cell, const EdgeRows& samples) const;

 private:
  const ViewPartition& partition_;
  double from_, to_;
  bool front_only_;
  std::vector<SolidFace> faces_;    // by node
  std::vector<std::uint8_t> wide_;  // per triangle: 1 if a part is left after narrowing
};

}  // namespace pellucid
