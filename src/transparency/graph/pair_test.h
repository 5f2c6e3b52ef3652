// Narrow phase: which of two projected triangles covers the other, over what area of the picture?
//
// For triangles A and B (counter-clockwise) the 9 + 9 edge functions of one at the corners of the other
// decide everything without branches: whether they are apart, which part of every edge lies inside the other
// triangle (Liang-Barsky), and from these pieces of the overlap's boundary its area (Green's theorem) and the
// extremes of the height difference, which is linear over the overlap and so extreme at the pieces' ends.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "transparency/graph/screen_triangles.h"

namespace pellucid {

// A pair of indices into ScreenTriangles::triangles.
struct CandidatePair {
  std::uint32_t a, b;
  bool operator==(const CandidatePair&) const = default;
};

// Occlusion between two faces at one viewpoint: `front` covers `area` (square radii) of the picture of
// `back`.
struct PairEdge {
  std::uint32_t front, back;  // indices into ScreenTriangles::triangles
  float area;
};

// Append the edges of `pairs` to `edges`, and to `doubtful` the pairs that single precision cannot decide or
// that intersect. Overlaps thinner than `tolerance` radii (across any edge of either triangle) make no edge.
void test_pairs(const ScreenTriangles& screen, std::span<const CandidatePair> pairs, float tolerance,
                std::vector<PairEdge>& edges, std::vector<CandidatePair>& doubtful);

// The scalar twin of test_pairs, for its tests: the same arithmetic without SIMD, the same results to the
// bit.
void test_pairs_scalar(const ScreenTriangles& screen, std::span<const CandidatePair> pairs, float tolerance,
                       std::vector<PairEdge>& edges, std::vector<CandidatePair>& doubtful);

// One pair in double precision by polygon clipping. Faces that intersect each cover a part of the other: two
// edges. Coincident faces make none. Returns whether the pair intersects.
bool test_pair_precisely(const ScreenTriangles& screen, const std::vector<Triangle>& triangles,
                         CandidatePair pair, std::vector<PairEdge>& edges);

}  // namespace pellucid
