// Implements simple_order.h.
#include "transparency/simple_order.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "transparency/order_problem.h"

namespace pellucid {
namespace {

// Vertices nearer to a plane than this many radii lie in it. No pixel shows the difference.
constexpr double kThickness = 1e-6;

// Larger meshes on a hull are searched like any other.
constexpr std::size_t kLargestHull = 2000;

struct Plane {
  Vec3d normal;  // unit
  double offset = 0;
};

Plane plane_of(const Mesh& mesh, std::uint32_t triangle) {
  const Vec3d normal = triangle_normal(mesh, triangle);
  return {normal, dot(normal, to_double(mesh.positions[mesh.triangles[triangle][0]]))};
}

std::vector<std::uint32_t> used_vertices(const Mesh& mesh) {
  std::vector<bool> used(mesh.positions.size(), false);
  std::vector<std::uint32_t> vertices;
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      if (!used[vertex]) vertices.push_back(vertex);
      used[vertex] = true;
    }
  }
  return vertices;
}

// The heights of vertices over a plane.
struct Heights {
  double low = 0, high = 0;
};
Heights heights_over(const Plane& plane, const Mesh& mesh, const std::vector<std::uint32_t>& vertices,
                     double thickness) {
  Heights heights;
  for (const std::uint32_t vertex : vertices) {
    const double height = dot(plane.normal, to_double(mesh.positions[vertex])) - plane.offset;
    heights.low = std::min(heights.low, height);
    heights.high = std::max(heights.high, height);
    // On both sides: neither flat nor on the hull.
    if (heights.low < -thickness && heights.high > thickness) break;
  }
  return heights;
}

bool share_an_edge(const Mesh& mesh, std::uint32_t a, std::uint32_t b) {
  int shared = 0;
  for (const std::uint32_t corner : mesh.triangles[a]) {
    for (const std::uint32_t other : mesh.triangles[b])
      shared += mesh.positions[corner] == mesh.positions[other] ? 1 : 0;
  }
  return shared == 2;
}

// Returns whether no plane holds more than the two halves of a quadrilateral. Then no faces of the hull
// coincide. Takes O(T^2).
bool has_single_faces(const Mesh& mesh, const std::vector<Plane>& planes, double radius) {
  constexpr double kParallel = 1e-5;
  std::vector<std::uint8_t> paired(planes.size(), 0);
  for (std::uint32_t a = 0; a < planes.size(); ++a) {
    for (std::uint32_t b = a + 1; b < planes.size(); ++b) {
      const double side = dot(planes[a].normal, planes[b].normal);
      if (std::abs(side) < 0.9 || length(cross(planes[a].normal, planes[b].normal)) > kParallel) continue;
      const double offset = side > 0 ? planes[b].offset : -planes[b].offset;
      if (std::abs(planes[a].offset - offset) > kParallel * radius) continue;
      if (side < 0 || paired[a] != 0 || paired[b] != 0 || !share_an_edge(mesh, a, b)) return false;
      paired[a] = paired[b] = 1;
    }
  }
  return true;
}

// Returns triangles in this order, first those that show their outer side unflipped.
NodeSequence hull_order(const std::vector<std::uint32_t>& triangles, const std::vector<std::uint8_t>& outward,
                        Facing facing) {
  NodeSequence nodes;
  for (const bool outer : {true, false}) {
    for (const std::uint32_t t : triangles) {
      const bool flipped = (outward[t] != 0) != outer;
      if (!flipped || facing == Facing::duplicated) nodes.push_back(node_of(t, flipped));
    }
  }
  return nodes;
}

}  // namespace

std::optional<SimpleOrder> find_simple_order(const Mesh& mesh, const BoundingSphere& sphere, Facing facing) {
  const double thickness = kThickness * sphere.radius;
  const std::vector<std::uint32_t> vertices = used_vertices(mesh);
  std::vector<Plane> planes;
  std::vector<std::uint8_t> outward;
  bool flat = true;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    planes.push_back(plane_of(mesh, t));
    const Heights heights = heights_over(planes.back(), mesh, vertices, thickness);
    if (heights.low < -thickness && heights.high > thickness) return {};
    flat = flat && heights.low >= -thickness && heights.high <= thickness;
    outward.push_back(heights.high <= thickness ? 1 : 0);
  }
  SimpleOrder simple;
  simple.base.resize(mesh.triangles.size());
  std::iota(simple.base.begin(), simple.base.end(), 0U);
  if (flat) {
    // Each side of the plane shows one side of every face. The last face of the file was painted over the
    // others.
    for (auto t = simple.base.rbegin(); t != simple.base.rend(); ++t) {
      simple.front_to_back.push_back(node_of(*t, false));
      if (facing == Facing::duplicated) simple.front_to_back.push_back(node_of(*t, true));
    }
    return simple;
  }
  if (mesh.triangles.size() > kLargestHull || !has_single_faces(mesh, planes, sphere.radius)) return {};
  const std::vector<std::uint32_t> positions = cache_positions(mesh);
  for (std::uint32_t t = 0; t < positions.size(); ++t) simple.base[positions[t]] = t;
  simple.front_to_back = hull_order(simple.base, outward, facing);
  return simple;
}

}  // namespace pellucid
