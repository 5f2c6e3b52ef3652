// The viewpoints of a view cell as a solid: all of T[n]'s triangle or R[n]'s region, at all distances.
//
// A cell is a cone over a spherical triangle. Between two distances it is no polytope: it is hollow towards
// the centre and bulges outwards. So it is held in the smallest such frustum (three planes through the
// centre, the plane through the corners at the least distance, the plane that touches the sphere of the
// greatest), which is cut like any polytope, and asked at the end whether it still reaches the least
// distance: the farthest point of a polytope is a vertex, so that this answer is exact.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "pellucid/baseline.h"
#include "pellucid/view.h"

namespace pellucid {

// Eyes with dot(normal, at) + offset * w >= 0, for eyes at infinity (w = 0) too.
struct HalfSpace {
  Vec3d normal;  // unit
  double offset = 0;
  [[nodiscard]] double value(const Eye& eye) const { return dot(normal, eye.at) + offset * eye.w; }
};

// A convex polytope of eyes, scaled so that |x| + |y| + |z| + w is about 1. A vertex knows its planes, one
// bit each: vertices with two planes in common are the ends of an edge.
class ViewPolytope {
 public:
  struct Vertex {
    Eye eye;
    std::uint64_t planes;
  };
  // Become a copy of another: faster than =, which copies room for vertices that are not there.
  void copy(const ViewPolytope& other);
  void clear() { count_ = 0; }
  // Keep the part in the half-space, and 1e-11 beyond it. Too many vertices or planes: keep all.
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
  // Does a part of the frustum lie in the solid? Conservative at the greatest distance only.
  [[nodiscard]] bool holds_part_of(const ViewPolytope& polytope) const;
};

// Distances in the units of positions, relative to their centre; 0 < from <= to, infinity allowed.
ViewSolid make_view_solid(const std::array<Vec3d, 3>& corners, double from, double to);

}  // namespace pellucid
