// clip.h - cut triangles at the near and far planes and at the guard band.
//
// Based on: Sutherland, Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974. Two triangles that share an
// edge get bit-equal cut points on it, so that clipping opens no cracks.
#pragma once

#include <array>
#include <span>

#include "raster/projection.h"

namespace pellucid::raster {

// A convex polygon in view space: a triangle and at most one more corner per plane. Rounding can make a
// sliver not quite convex, which gives room for a few more; what exceeds even that is dropped.
class ClippedPolygon {
 public:
  static constexpr std::size_t kMaxCorners = 3 + 2 * 6;

  void add(const Vec3d& corner) {
    if (count_ < kMaxCorners) corners_[count_++] = corner;
  }
  [[nodiscard]] std::span<const Vec3d> corners() const { return {corners_.data(), count_}; }

 private:
  std::array<Vec3d, kMaxCorners> corners_;
  std::size_t count_ = 0;
};

// The part of a triangle (view positions) inside all planes, same winding; fewer than three corners: nothing
// is left.
ClippedPolygon clip_triangle(const Projection& projection, const std::array<Vec3d, 3>& triangle);

}  // namespace pellucid::raster
