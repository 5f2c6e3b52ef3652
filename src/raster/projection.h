// Projects positions from object space to the fixed-point grid of the image, and clips triangles. In: a
// camera and positions. Out: screen vertices, and the parts of triangles inside the view volume.
//
// A *view position* has x along the camera's right axis, y along its up axis and z along its forward axis. A
// screen vertex is in pixels, with x to the right and y down from the upper left corner. Pixel (i, j) has its
// centre at (i + 0.5, j + 0.5).
//
// Clipping is based on: Sutherland, Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974. Two triangles
// that share an edge get cut points with equal bits on it, so that clipping opens no cracks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "pellucid/raster.h"

namespace pellucid::raster {

// Fixed-point steps per pixel, as on GPUs.
constexpr std::int32_t kSubpixels = 256;
// The longest side of an image, in pixels.
constexpr std::uint32_t kMaxSide = 1U << 20U;
// Triangles are clipped at this distance outside of the image, in pixels. Together with kMaxSide it bounds
// differences of fixed-point coordinates by 2^30 and edge functions by 2^61.
constexpr double kGuardBand = 1 << 20;

// Bits that say which planes a vertex is outside of.
constexpr std::uint8_t kOutsideNear = 1;
constexpr std::uint8_t kOutsideFar = 2;
constexpr std::uint8_t kOutsideLeft = 4;
constexpr std::uint8_t kOutsideRight = 8;
constexpr std::uint8_t kOutsideTop = 16;
constexpr std::uint8_t kOutsideBottom = 32;
constexpr std::uint8_t kNotFinite = 64;

// A projected vertex.
struct ScreenVertex {
  double x = 0, y = 0;                    // pixels, not snapped
  double depth = 0;                       // 0..1
  std::int32_t fixed_x = 0, fixed_y = 0;  // x and y in 1/256 pixels, rounded; valid where `outside` is 0
  std::uint8_t outside = 0;               // kOutside... bits
};

// The mapping of a camera, with the terms that do not depend on the vertex precomputed.
class Projection {
 public:
  explicit Projection(const Camera& camera);

  // Returns the view position of a position in object space.
  [[nodiscard]] Vec3d view(const Vec3f& position) const {
    const Vec3d p = to_double(position) - camera_.eye;
    return {dot(p, camera_.right), dot(p, camera_.up), dot(p, camera_.forward)};
  }
  // Projects a view position that is inside all planes up to rounding.
  [[nodiscard]] ScreenVertex screen(const Vec3d& view) const;
  // Projects any view position and sets its `outside` bits.
  [[nodiscard]] ScreenVertex classified(const Vec3d& view) const;

  // Depth as a linear function of the screen position: offset + gradient_x * x + gradient_y * y.
  struct Plane {
    double offset = 0, gradient_x = 0, gradient_y = 0;
  };
  // Returns the depth of the plane through three view positions, some of which may be behind the camera.
  [[nodiscard]] Plane depth_plane(const Vec3d& a, const Vec3d& b, const Vec3d& c) const;

  [[nodiscard]] const Camera& camera() const { return camera_; }
  // Returns the pixels per unit of x / z (perspective) or x (orthographic).
  [[nodiscard]] double scale() const { return scale_; }

 private:
  [[nodiscard]] ScreenVertex unsnapped(const Vec3d& view) const;

  Camera camera_;
  double scale_, center_x_, center_y_;
  double inverse_near_ = 0, depth_scale_;
};

// Returns the nearest fixed-point position and rounds halves up. Requires |pixels| <= 2^21 + 1.
constexpr std::int32_t snap(double pixels) {
  // With the bias, the truncating conversion also rounds negative positions down.
  constexpr double kBias = 1 << 30;
  return static_cast<std::int32_t>(pixels * kSubpixels + (kBias + 0.5)) - (1 << 30);
}

// Projects positions[i] to vertices[i]. Both have the same length.
void project(const Projection& projection, std::span<const Vec3f> positions,
             std::span<ScreenVertex> vertices);

// -------------------------------------------------------------------------------------------------- clipping

// A convex polygon in view space: a triangle with at most one more corner per plane. Rounding can make a
// sliver slightly concave, so there is space for as many again; further corners are dropped.
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

// Returns the part of a triangle (view positions) inside all planes, with the same winding. A result with
// fewer than three corners is empty.
ClippedPolygon clip_triangle(const Projection& projection, const std::array<Vec3d, 3>& triangle);

}  // namespace pellucid::raster
