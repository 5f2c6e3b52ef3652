// Broad phase: all pairs of projected triangles whose picture bounds overlap, each exactly once.
#pragma once

#include <cstdint>
#include <vector>

#include "transparency/graph/pair_test.h"
#include "transparency/graph/screen_triangles.h"

namespace pellucid {

// A uniform grid over the picture, about one triangle wide, kept between viewpoints to reuse its memory.
// A pair is reported in the one grid cell that holds the lower corner of the intersection of its bounds.
// Expected O(triangles + pairs) for triangles of similar size.
class PairSearch {
 public:
  // Replace `pairs` by all overlapping pairs, in an order that depends on the input alone.
  void find(const std::vector<Bounds2>& bounds, std::vector<CandidatePair>& pairs);

 private:
  struct CellRange {
    std::int32_t x0, y0, x1, y1;
  };
  void choose_grid(const std::vector<Bounds2>& bounds);
  void fill_grid(const std::vector<Bounds2>& bounds);
  [[nodiscard]] CellRange cells_of(const Bounds2& b) const;

  float origin_x_ = 0, origin_y_ = 0, scale_ = 1;
  std::int32_t columns_ = 1, rows_ = 1;
  std::vector<std::uint32_t> starts_;  // per grid cell, into the entry arrays
  std::vector<std::uint32_t> cursor_;
  // One entry per triangle and grid cell it touches, structure of arrays in cell order. `begins` has bit 0
  // set where the triangle's bounds begin in this column, bit 1 for the row.
  std::vector<float> min_x_, min_y_, max_x_, max_y_;
  std::vector<std::int32_t> begins_, index_;
};

}  // namespace pellucid
