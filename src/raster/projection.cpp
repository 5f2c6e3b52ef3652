// projection.cpp - see projection.h.
#include "raster/projection.h"

#include <cmath>

namespace pellucid::raster {

Projection::Projection(const Camera& camera)
    : camera_(camera),
      scale_(0.5 * camera.height / camera.half_height),
      center_x_(0.5 * camera.width),
      center_y_(0.5 * camera.height) {
  if (camera.perspective) {
    inverse_near_ = 1.0 / camera.near_plane;
    depth_scale_ = 1.0 / (inverse_near_ - 1.0 / camera.far_plane);
  } else {
    depth_scale_ = 1.0 / (camera.far_plane - camera.near_plane);
  }
}

ScreenVertex Projection::unsnapped(const Vec3d& view) const {
  ScreenVertex v;
  const double inverse_z = camera_.perspective ? 1.0 / view.z : 1.0;
  v.x = center_x_ + view.x * inverse_z * scale_;
  v.y = center_y_ - view.y * inverse_z * scale_;
  v.depth = camera_.perspective ? (inverse_near_ - inverse_z) * depth_scale_
                                : (view.z - camera_.near_plane) * depth_scale_;
  return v;
}

ScreenVertex Projection::screen(const Vec3d& view) const {
  ScreenVertex v = unsnapped(view);
  v.fixed_x = snap(v.x);
  v.fixed_y = snap(v.y);
  return v;
}

ScreenVertex Projection::classified(const Vec3d& view) const {
  ScreenVertex v;
  if (!std::isfinite(view.x + view.y + view.z)) {
    v.outside = kNotFinite;
    return v;
  }
  if (view.z < camera_.near_plane) {
    v.outside = kOutsideNear;
    return v;
  }
  v = unsnapped(view);
  unsigned outside = 0;
  if (view.z > camera_.far_plane) outside |= kOutsideFar;
  if (v.x < -kGuardBand) outside |= kOutsideLeft;
  if (v.x > camera_.width + kGuardBand) outside |= kOutsideRight;
  if (v.y < -kGuardBand) outside |= kOutsideTop;
  if (v.y > camera_.height + kGuardBand) outside |= kOutsideBottom;
  v.outside = static_cast<std::uint8_t>(outside);
  if (outside == 0) {
    v.fixed_x = snap(v.x);
    v.fixed_y = snap(v.y);
  }
  return v;
}

Projection::Plane Projection::depth_plane(const Vec3d& a, const Vec3d& b, const Vec3d& c) const {
  // The plane is dot(normal, p) = offset.
  const Vec3d normal = cross(b - a, c - a);
  const double offset = dot(normal, a);
  Plane plane;
  if (camera_.perspective) {
    // With p = z (X, Y, 1): 1 / z = dot(normal, (X, Y, 1)) / offset.
    const double k = -depth_scale_ / offset;
    plane.gradient_x = k * normal.x / scale_;
    plane.gradient_y = -k * normal.y / scale_;
    plane.offset = inverse_near_ * depth_scale_ + k * normal.z;
  } else {
    // With p = (X, Y, z): z = (offset - normal.x X - normal.y Y) / normal.z.
    const double k = depth_scale_ / normal.z;
    plane.gradient_x = -k * normal.x / scale_;
    plane.gradient_y = k * normal.y / scale_;
    plane.offset = k * offset - camera_.near_plane * depth_scale_;
  }
  plane.offset -= plane.gradient_x * center_x_ + plane.gradient_y * center_y_;
  return plane;
}

void project(const Projection& projection, std::span<const Vec3f> positions,
             std::span<ScreenVertex> vertices) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    vertices[i] = projection.classified(projection.view(positions[i]));
  }
}

}  // namespace pellucid::raster
