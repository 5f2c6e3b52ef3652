// Implements the narrow phase of screen_pairs.h: tests one pair of triangles per SIMD lane. Has the same
// arithmetic without SIMD for the tests, and a test in double precision for the pairs that single precision
// cannot decide.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include "pellucid/sequencing.h"
#include "transparency/graph/screen_pairs.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transparency/graph/pair_test.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pellucid {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "transparency/graph/each_lane-inl.h"
#include "transparency/graph/pair_test_kernel.h"

constexpr hn::ScalableTag<float> kFloats;
constexpr hn::RebindToSigned<decltype(kFloats)> kInts;

struct VectorLanes {
  using V = hn::Vec<decltype(kFloats)>;
  using M = hn::Mask<decltype(kFloats)>;
  static V set(float s) { return hn::Set(kFloats, s); }
  static V add(V a, V b) { return hn::Add(a, b); }
  static V sub(V a, V b) { return hn::Sub(a, b); }
  static V mul(V a, V b) { return hn::Mul(a, b); }
  static V div(V a, V b) { return hn::Div(a, b); }
  static V sqrt(V a) { return hn::Sqrt(a); }
  static V abs(V a) { return hn::Abs(a); }
  static V min(V a, V b) { return hn::Min(a, b); }
  static V max(V a, V b) { return hn::Max(a, b); }
  static M less(V a, V b) { return hn::Lt(a, b); }
  static M less_equal(V a, V b) { return hn::Le(a, b); }
  static V select(M m, V yes, V no) { return hn::IfThenElse(m, yes, no); }
  static M either(M a, M b) { return hn::Or(a, b); }
  static M both(M a, M b) { return hn::And(a, b); }
  static M negate(M a) { return hn::Not(a); }
  static M none() { return hn::FirstN(kFloats, 0); }
};

using Ints = hn::Vec<decltype(kInts)>;

// Loads one triangle per lane, with corners relative to (origin_x, origin_y).
void load_triangles(const float* triangles, Ints indices, pair_test::Corners<VectorLanes::V>& corners,
                    pair_test::Plane<VectorLanes::V>& plane) {
  const Ints first = hn::ShiftLeft<4>(indices);  // 16 floats a triangle
  const auto field = [&](int k) { return hn::GatherIndex(kFloats, triangles + k, first); };
  for (int i = 0; i < 3; ++i) {
    corners.x[i] = field(i);
    corners.y[i] = field(3 + i);
  }
  plane = {field(6), field(7), field(8)};
}

void append_edges(VectorLanes::M mask, Ints front, Ints back, VectorLanes::V area,
                  std::vector<PairEdge>& edges) {
  HWY_ALIGN std::int32_t fronts[hn::MaxLanes(kInts)];
  HWY_ALIGN std::int32_t backs[hn::MaxLanes(kInts)];
  HWY_ALIGN float areas[hn::MaxLanes(kFloats)];
  hn::Store(front, kInts, fronts);
  hn::Store(back, kInts, backs);
  hn::Store(area, kFloats, areas);
  for_each_lane(kFloats, mask, [&](std::size_t i) {
    edges.push_back({static_cast<std::uint32_t>(fronts[i]), static_cast<std::uint32_t>(backs[i]), areas[i]});
  });
}

void test_pairs(const ScreenTriangles& screen, std::span<const CandidatePair> pairs, float tolerance,
                std::vector<PairEdge>& edges, std::vector<CandidatePair>& doubtful) {
  const std::size_t lanes = hn::Lanes(kFloats);
  const float* triangles = &screen.triangles.data()->x[0];
  HWY_ALIGN std::int32_t a_indices[hn::MaxLanes(kInts)] = {};
  HWY_ALIGN std::int32_t b_indices[hn::MaxLanes(kInts)] = {};
  for (std::size_t begin = 0; begin < pairs.size(); begin += lanes) {
    // Load the next pairs; lanes past the end repeat an earlier pair and are masked off.
    const std::size_t count = std::min(lanes, pairs.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      a_indices[i] = static_cast<std::int32_t>(pairs[begin + i].a);
      b_indices[i] = static_cast<std::int32_t>(pairs[begin + i].b);
    }
    const Ints a_index = hn::Load(kInts, a_indices);
    const Ints b_index = hn::Load(kInts, b_indices);
    pair_test::Corners<VectorLanes::V> a;
    pair_test::Corners<VectorLanes::V> b;
    pair_test::Plane<VectorLanes::V> plane_a;
    pair_test::Plane<VectorLanes::V> plane_b;
    load_triangles(triangles, a_index, a, plane_a);
    load_triangles(triangles, b_index, b, plane_b);
    const VectorLanes::V origin_x = a.x[0];
    const VectorLanes::V origin_y = a.y[0];
    for (int i = 0; i < 3; ++i) {
      a.x[i] = hn::Sub(a.x[i], origin_x);
      a.y[i] = hn::Sub(a.y[i], origin_y);
      b.x[i] = hn::Sub(b.x[i], origin_x);
      b.y[i] = hn::Sub(b.y[i], origin_y);
    }

    const auto verdict = pair_test::decide<VectorLanes>(a, plane_a, b, plane_b, hn::Set(kFloats, tolerance));
    const auto used = hn::FirstN(kFloats, count);
    const auto a_front = hn::And(used, verdict.a_in_front);
    const auto edge = hn::And(used, hn::Or(verdict.a_in_front, verdict.b_in_front));
    const auto int_front = hn::RebindMask(kInts, a_front);
    append_edges(edge, hn::IfThenElse(int_front, a_index, b_index),
                 hn::IfThenElse(int_front, b_index, a_index), verdict.area, edges);

    const auto unsure = hn::And(used, verdict.doubtful);
    for_each_lane(kFloats, unsure, [&](std::size_t i) { doubtful.push_back(pairs[begin + i]); });
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace pellucid
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pellucid {

HWY_EXPORT(test_pairs);

void test_pairs(const ScreenTriangles& screen, std::span<const CandidatePair> pairs, float tolerance,
                std::vector<PairEdge>& edges, std::vector<CandidatePair>& doubtful) {
  if (pairs.empty()) return;
  HWY_DYNAMIC_DISPATCH(test_pairs)(screen, pairs, tolerance, edges, doubtful);
}

// ---------------------------------------------------------------------------------------------- without SIMD

namespace {

#include "transparency/graph/pair_test_kernel.h"

// A lane type of one float. Its minimum and maximum are those of x86 vectors: the second operand if one is
// NaN.
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

// A convex polygon in the image. Two triangles overlap in at most six corners, and the cut by height adds
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

// Returns the part where the linear function is positive (one step of Sutherland-Hodgman).
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

// Returns the projected corners, counter-clockwise, relative to `origin` in the image.
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

  // Clip the image of A by the edges of B.
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
  // Positions are in single precision. Surfaces that are closer than its rounding count as one.
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
#endif
