// Narrow phase without SIMD: the scalar twin for the tests and the double-precision judge of doubtful pairs.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "pellucid/sequencing.h"
#include "transparency/graph/pair_test.h"

namespace pellucid {
namespace {

#include "transparency/graph/pair_test_kernel.h"

// One float a lane, with the minimum and maximum of x86 vectors (the second operand where one is NaN).
struct ScalarLanes {
  using V = float;
  using M = bool;
  static V set(float s) { return s; }
  static V add(V a, V b) { return a + b; }
  static V sub(V a, V b) { return a - b; }
  static V mul(V a, V b) { return a * b; }
  static V div(V a, V b) { return a / b; }
  static V sqrt(V a) { return std::sqrt(a); }
  static V abs(V a) { return std::fabs(a); }
  static V min(V a, V b) { return a < b ? a : b; }
  static V max(V a, V b) { return a > b ? a : b; }
  static M less(V a, V b) { return a < b; }
  static M less_equal(V a, V b) { return a <= b; }
  static V select(M m, V yes, V no) { return m ? yes : no; }
  static M either(M a, M b) { return a || b; }
  static M both(M a, M b) { return a && b; }
  static M negate(M a) { return !a; }
  static M none() { return false; }
};

pair_test::Corners<float> corners_from(const ScreenTriangle& t, float origin_x, float origin_y) {
  pair_test::Corners<float> corners;
  for (int i = 0; i < 3; ++i) {
    corners.x[i] = t.x[i] - origin_x;
    corners.y[i] = t.y[i] - origin_y;
  }
  return corners;
}

// A convex polygon of picture points; two triangles overlap in at most six corners, the height split adds
// one.
struct OverlapPolygon {
  struct Point {
    double x, y;
  };
  std::array<Point, 8> points;
  int count = 0;
  void push(Point p) { points[static_cast<std::size_t>(count++)] = p; }
};

using Plane3 = std::array<double, 3>;  // value(x, y) = [0] + [1] x + [2] y
double value_at(const Plane3& plane, const OverlapPolygon::Point& p) {
  return plane[0] + plane[1] * p.x + plane[2] * p.y;
}

// Keep the part where the linear function is positive (Sutherland-Hodgman, one plane).
OverlapPolygon keep_positive(const OverlapPolygon& polygon, const Plane3& plane) {
  OverlapPolygon kept;
  for (int i = 0; i < polygon.count; ++i) {
    const OverlapPolygon::Point& p = polygon.points[static_cast<std::size_t>(i)];
    const OverlapPolygon::Point& q = polygon.points[static_cast<std::size_t>((i + 1) % polygon.count)];
    const double vp = value_at(plane, p);
    const double vq = value_at(plane, q);
    if (vp >= 0) kept.push(p);
    if ((vp < 0) != (vq < 0)) {
      const double t = vp / (vp - vq);
      kept.push({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
    }
    if (kept.count >= 7) break;  // rounding cannot make a convex polygon grow further
  }
  return kept;
}

double area_of(const OverlapPolygon& polygon) {
  double doubled = 0;
  for (int i = 0; i < polygon.count; ++i) {
    const OverlapPolygon::Point& p = polygon.points[static_cast<std::size_t>(i)];
    const OverlapPolygon::Point& q = polygon.points[static_cast<std::size_t>((i + 1) % polygon.count)];
    doubled += p.x * q.y - p.y * q.x;
  }
  return 0.5 * doubled;
}

using Corners3 = std::array<Vec3d, 3>;

// Projected corners, counter-clockwise, relative to `origin` in the picture.
Corners3 corners_of_node(const ScreenTriangles& screen, const std::vector<Triangle>& triangles,
                         std::uint32_t index, const Vec3d& origin) {
  const NodeId node = screen.nodes[index];
  Triangle t = triangles[triangle_of(node)];
  if (is_flipped(node)) std::swap(t[1], t[2]);
  return {screen.vertices[t[0]] - origin, screen.vertices[t[1]] - origin, screen.vertices[t[2]] - origin};
}

Plane3 edge_plane(const Vec3d& p, const Vec3d& q) {
  const double dx = q.x - p.x;
  const double dy = q.y - p.y;
  return {dy * p.x - dx * p.y, -dy, dx};
}

Plane3 height_plane(const Corners3& c) {
  const Vec3d ab = c[1] - c[0];
  const Vec3d ac = c[2] - c[0];
  const double doubled_area = ab.x * ac.y - ac.x * ab.y;
  const double sx = (ab.z * ac.y - ac.z * ab.y) / doubled_area;
  const double sy = (ac.z * ab.x - ab.z * ac.x) / doubled_area;
  return {c[0].z - sx * c[0].x - sy * c[0].y, sx, sy};
}

}  // namespace

void test_pairs_scalar(const ScreenTriangles& screen, std::span<const CandidatePair> pairs, float tolerance,
                       std::vector<PairEdge>& edges, std::vector<CandidatePair>& doubtful) {
  for (const CandidatePair& pair : pairs) {
    const ScreenTriangle& a = screen.triangles[pair.a];
    const ScreenTriangle& b = screen.triangles[pair.b];
    const auto verdict = pair_test::decide<ScalarLanes>(
        corners_from(a, a.x[0], a.y[0]), {a.height, a.slope_x, a.slope_y}, corners_from(b, a.x[0], a.y[0]),
        {b.height, b.slope_x, b.slope_y}, tolerance);
    if (verdict.a_in_front) edges.push_back({pair.a, pair.b, verdict.area});
    if (verdict.b_in_front) edges.push_back({pair.b, pair.a, verdict.area});
    if (verdict.doubtful) doubtful.push_back(pair);
  }
}

bool test_pair_precisely(const ScreenTriangles& screen, const std::vector<Triangle>& triangles,
                         CandidatePair pair, std::vector<PairEdge>& edges) {
  const Vec3d origin = screen.vertices[triangles[triangle_of(screen.nodes[pair.a])][0]];
  const Corners3 a = corners_of_node(screen, triangles, pair.a, origin);
  const Corners3 b = corners_of_node(screen, triangles, pair.b, origin);

  // Clip A's picture by B's edges.
  OverlapPolygon overlap;
  for (const Vec3d& corner : a) overlap.push({corner.x, corner.y});
  for (std::size_t i = 0; i < 3 && overlap.count >= 3; ++i) {
    overlap = keep_positive(overlap, edge_plane(b[i], b[(i + 1) % 3]));
  }
  constexpr double kLeastArea = 1e-14;  // square radii: below the rounding of the clipping
  if (overlap.count < 3 || area_of(overlap) < kLeastArea) return false;

  // Compare heights where they differ most.
  const Plane3 plane_a = height_plane(a);
  const Plane3 plane_b = height_plane(b);
  const Plane3 difference{plane_a[0] - plane_b[0], plane_a[1] - plane_b[1], plane_a[2] - plane_b[2]};
  double lowest = 0;
  double highest = 0;
  for (int i = 0; i < overlap.count; ++i) {
    const double d = value_at(difference, overlap.points[static_cast<std::size_t>(i)]);
    lowest = std::min(lowest, d);
    highest = std::max(highest, d);
  }
  const double slopes =
      std::fabs(plane_a[1]) + std::fabs(plane_a[2]) + std::fabs(plane_b[1]) + std::fabs(plane_b[2]);
  // Positions come in single precision: what is closer than its rounding is one surface, not two.
  const double coincident = 1e-7 + 1e-13 * slopes;
  const bool a_nearer = highest > coincident;
  const bool b_nearer = lowest < -coincident;
  const auto area = static_cast<float>(area_of(overlap));
  if (a_nearer && b_nearer) {
    const auto area_a = static_cast<float>(area_of(keep_positive(overlap, difference)));
    if (area_a > 0) edges.push_back({pair.a, pair.b, area_a});
    if (area > area_a) edges.push_back({pair.b, pair.a, area - area_a});
    return true;
  }
  if (a_nearer) edges.push_back({pair.a, pair.b, area});
  if (b_nearer) edges.push_back({pair.b, pair.a, area});
  return false;
}

}  // namespace pellucid
