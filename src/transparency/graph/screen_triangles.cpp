// The mesh as one viewpoint sees it: see screen_triangles.h.
#include "transparency/graph/screen_triangles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pellucid/sequencing.h"

namespace pellucid {
namespace {

// A face whose picture is smaller than this (square radii) is edge-on: it covers no pixel of any real
// picture.
constexpr double kEdgeOnArea = 1e-12;

void project_vertices(const std::vector<Vec3d>& positions, const Viewpoint& viewpoint,
                      std::vector<Vec3d>& out) {
  const ViewAxes axes = view_axes(viewpoint.direction);
  const bool orthographic = std::isinf(viewpoint.distance);
  // Points beside or behind the camera have no picture; a camera that close is outside every valid range.
  constexpr double kNearest = 1e-3;
  out.resize(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3d& p = positions[i];
    const Vec3d q{dot(p, axes.right), dot(p, axes.up), dot(p, axes.direction)};
    const double s =
        orthographic ? 1.0
                     : viewpoint.distance / std::max(viewpoint.distance - q.z, kNearest * viewpoint.distance);
    out[i] = q * s;
  }
}

ScreenTriangle make_screen_triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, double doubled_area) {
  const Vec3d ab = b - a;
  const Vec3d ac = c - a;
  ScreenTriangle t{};
  const Vec3d* corners[3] = {&a, &b, &c};
  for (int i = 0; i < 3; ++i) {
    t.x[i] = static_cast<float>(corners[i]->x);
    t.y[i] = static_cast<float>(corners[i]->y);
  }
  t.height = static_cast<float>(a.z);
  t.slope_x = static_cast<float>((ab.z * ac.y - ac.z * ab.y) / doubled_area);
  t.slope_y = static_cast<float>((ac.z * ab.x - ab.z * ac.x) / doubled_area);
  t.min_height = static_cast<float>(std::min({a.z, b.z, c.z}));
  t.max_height = static_cast<float>(std::max({a.z, b.z, c.z}));
  return t;
}

Bounds2 bounds_of(const ScreenTriangle& t) {
  return {std::min({t.x[0], t.x[1], t.x[2]}), std::min({t.y[0], t.y[1], t.y[2]}),
          std::max({t.x[0], t.x[1], t.x[2]}), std::max({t.y[0], t.y[1], t.y[2]})};
}

}  // namespace

ViewAxes view_axes(const Vec3d& direction) {
  const Vec3d helper = std::fabs(direction.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
  const Vec3d right = normalized(cross(helper, direction));
  return {right, cross(direction, right), direction};
}

std::vector<Vec3d> unit_positions(const Mesh& mesh, const BoundingSphere& sphere) {
  const double scale = sphere.radius > 0 ? 1.0 / sphere.radius : 0.0;
  std::vector<Vec3d> positions(mesh.positions.size());
  std::transform(mesh.positions.begin(), mesh.positions.end(), positions.begin(),
                 [&](const Vec3f& p) { return (to_double(p) - sphere.center) * scale; });
  return positions;
}

void project_triangles(const std::vector<Vec3d>& positions, const std::vector<Triangle>& triangles,
                       const Viewpoint& viewpoint, bool front_only, ScreenTriangles& out) {
  project_vertices(positions, viewpoint, out.vertices);
  out.triangles.clear();
  out.bounds.clear();
  out.nodes.clear();
  out.flipped.assign(triangles.size(), 0);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Vec3d& a = out.vertices[triangles[t][0]];
    const Vec3d* b = &out.vertices[triangles[t][1]];
    const Vec3d* c = &out.vertices[triangles[t][2]];
    double doubled_area = (b->x - a.x) * (c->y - a.y) - (c->x - a.x) * (b->y - a.y);
    const bool flipped = doubled_area < 0;
    if (flipped) {
      doubled_area = -doubled_area;
      std::swap(b, c);
    }
    out.flipped[t] = flipped ? 1 : 0;
    if (!(doubled_area > kEdgeOnArea) || (flipped && front_only)) continue;
    out.triangles.push_back(make_screen_triangle(a, *b, *c, doubled_area));
    out.bounds.push_back(bounds_of(out.triangles.back()));
    out.nodes.push_back(node_of(t, flipped));
  }
}

}  // namespace pellucid
