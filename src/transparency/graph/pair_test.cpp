// Narrow phase with SIMD lanes, one pair a lane: see pair_test.h.
#include "transparency/graph/pair_test.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

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

// Read one triangle a lane; corners relative to (origin_x, origin_y).
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

}  // namespace pellucid
#endif
