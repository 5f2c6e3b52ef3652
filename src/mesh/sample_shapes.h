// Shapes that make up the procedural samples. In: dimensions and resolutions. Out: meshes with
// normals. All closed shapes share vertices across their seams, face outwards and have smooth normals.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pellucid/mesh.h"

namespace pellucid {

// A point of a profile that is rotated about the y axis.
struct ProfilePoint {
  double radius = 0;
  double height = 0;
};
using Profile = std::vector<ProfilePoint>;

// Returns a centripetal Catmull-Rom spline through `controls` with `steps` points per span. The spline meets
// the axis at a right angle, so that the surface is smooth there.
Profile smooth_profile(std::span<const ProfilePoint> controls, std::uint32_t steps);

// Returns the profile moved to its left by `distance`, which is into a body whose outside the profile climbs.
// Points on the axis stay on the axis.
Profile offset_profile(const Profile& profile, double distance);

// Returns a surface of revolution. Ends of the profile on the axis become poles; other ends stay open. The
// profile runs counter-clockwise in the radius-height plane, so that it climbs the outside. `depth_scale`
// scales the surface along z.
Mesh revolve(const Profile& profile, std::uint32_t segments, double depth_scale = 1.0);

// A point of a closed curve. `side` is a direction across the curve and is never parallel to it.
struct CurvePoint {
  Vec3d position, tangent, side;
};
// Returns a tube around the closed curve `curve`, whose period is 1.
Mesh tube(const std::function<CurvePoint(double)>& curve, double radius, std::uint32_t steps,
          std::uint32_t segments);

// Returns a closed star-shaped surface, given its radius in every direction. The vertices are those of a cube
// with n x n squares per side.
Mesh star_shape(const std::function<double(const Vec3d&)>& radius, std::uint32_t n);

// Return flat sheets in the plane y = height that face up.
Mesh disc(double radius, double height, std::uint32_t segments);
Mesh grid(double half_width, double height, std::uint32_t n);

// Change a mesh in place.
void translate(Mesh& mesh, const Vec3f& by);
void turn_about_y(Mesh& mesh, double radians);
void append(Mesh& mesh, const Mesh& more);
// Returns the mesh with reversed winding and normals.
Mesh flipped(const Mesh& mesh);

}  // namespace pellucid
