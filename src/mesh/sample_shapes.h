// Internal to the module `mesh`: the shapes that procedural samples are made of. All closed shapes share
// vertices across their seams, face outwards and have smooth normals.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pellucid/mesh.h"

namespace pellucid {

// A point of a profile that turns round the y axis.
struct ProfilePoint {
  double radius = 0;
  double height = 0;
};
using Profile = std::vector<ProfilePoint>;

// Centripetal Catmull-Rom spline through `controls`, `steps` points for each span. An end on the axis is met
// at a right angle, so that the surface is smooth there.
Profile smooth_profile(std::span<const ProfilePoint> controls, std::uint32_t steps);

// The profile moved by `distance` to its left (into a body whose outside the profile climbs). Points on the
// axis stay there.
Profile offset_profile(const Profile& profile, double distance);

// Surface of revolution. Ends of the profile on the axis become poles; ends off the axis stay open. The
// profile climbs the outside (counter-clockwise in the radius-height plane). `depth_scale` squeezes it along
// z.
Mesh revolve(const Profile& profile, std::uint32_t segments, double depth_scale = 1.0);

// Tube round the closed curve that `curve` (period 1) draws; `side` gives a direction across it, never
// parallel to it.
struct CurvePoint {
  Vec3d position, tangent, side;
};
Mesh tube(const std::function<CurvePoint(double)>& curve, double radius, std::uint32_t steps,
          std::uint32_t segments);

// Closed star-shaped surface: the radius in every direction, over the lattice of a cube with n x n squares a
// side.
Mesh star_shape(const std::function<double(const Vec3d&)>& radius, std::uint32_t n);

// Flat sheets in the plane y = height, facing up.
Mesh disc(double radius, double height, std::uint32_t segments);
Mesh grid(double half_width, double height, std::uint32_t n);

// Changes in place.
void translate(Mesh& mesh, const Vec3f& by);
void turn_about_y(Mesh& mesh, double radians);
void append(Mesh& mesh, const Mesh& more);
Mesh flipped(const Mesh& mesh);

}  // namespace pellucid
