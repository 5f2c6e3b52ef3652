// projection.h - from object space to the picture's fixed-point grid.
//
// A *view position* has x along the camera's right, y along its up and z along its forward axis. A screen
// vertex is in pixels, x to the right and y down from the upper left corner; pixel (i, j) has its centre at
// (i + 0.5, j + 0.5).
#pragma once

#include <cstdint>
#include <span>

#include "pellucid/raster.h"

namespace pellucid::raster {

// Fixed-point steps per pixel; GPUs use the same.
constexpr std::int32_t kSubpixels = 256;
// Longest side of a picture, in pixels.
constexpr std::uint32_t kMaxSide = 1U << 20U;
// Vertices farther than this outside the picture are clipped. Together with kMaxSide it bounds fixed-point
// coordinate differences by 2^30, and edge functions by 2^61.
constexpr double kGuardBand = 1 << 20;

// Which planes a vertex is outside of: a set of bits.
constexpr std::uint8_t kOutsideNear = 1;
constexpr std::uint8_t kOutsideFar = 2;
constexpr std::uint8_t kOutsideLeft = 4;
constexpr std::uint8_t kOutsideRight = 8;
constexpr std::uint8_t kOutsideTop = 16;
constexpr std::uint8_t kOutsideBottom = 32;
constexpr std::uint8_t kNotFinite = 64;

struct ScreenVertex {
  double x = 0, y = 0;                    // pixels, not snapped
  double depth = 0;                       // 0..1
  std::int32_t fixed_x = 0, fixed_y = 0;  // x and y in 1/256 pixels, rounded; valid where `outside` is 0
  std::uint8_t outside = 0;               // set of kOutside...
};

// The camera's mapping with everything that does not depend on the vertex worked out.
class Projection {
 public:
  explicit Projection(const Camera& camera);

  [[nodiscard]] Vec3d view(const Vec3f& position) const {
    const Vec3d p = to_double(position) - camera_.eye;
    return {dot(p, camera_.right), dot(p, camera_.up), dot(p, camera_.forward)};
  }
  // For a view position that clipping left inside all planes, rounding aside.
  [[nodiscard]] ScreenVertex screen(const Vec3d& view) const;
  // The same for any view position: says in `outside` what is wrong with it.
  [[nodiscard]] ScreenVertex classified(const Vec3d& view) const;

  // Depth as a plane over the screen, offset + gradient_x * x + gradient_y * y, for the plane through three
  // view positions, of which some may lie behind the camera.
  struct Plane {
    double offset = 0, gradient_x = 0, gradient_y = 0;
  };
  [[nodiscard]] Plane depth_plane(const Vec3d& a, const Vec3d& b, const Vec3d& c) const;

  [[nodiscard]] const Camera& camera() const { return camera_; }
  // Pixels per unit of x / z (perspective) or x (orthographic).
  [[nodiscard]] double scale() const { return scale_; }

 private:
  [[nodiscard]] ScreenVertex unsnapped(const Vec3d& view) const;

  Camera camera_;
  double scale_, center_x_, center_y_;
  double inverse_near_ = 0, depth_scale_;
};

// Nearest fixed-point position, halves up; |pixels| <= 2^21 + 1.
constexpr std::int32_t snap(double pixels) {
  // The bias makes the truncating conversion round down for negative positions, too.
  constexpr double kBias = 1 << 30;
  return static_cast<std::int32_t>(pixels * kSubpixels + (kBias + 0.5)) - (1 << 30);
}

// Project positions[i] to vertices[i]; both of one length.
void project(const Projection& projection, std::span<const Vec3f> positions,
             std::span<ScreenVertex> vertices);

}  // namespace pellucid::raster
