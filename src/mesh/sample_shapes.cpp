// Implements the shapes of the procedural samples.
#include "mesh/sample_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace pellucid {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

ProfilePoint mix(const ProfilePoint& a, const ProfilePoint& b, double t) {
  return {std::lerp(a.radius, b.radius, t), std::lerp(a.height, b.height, t)};
}

double distance(const ProfilePoint& a, const ProfilePoint& b) {
  return std::hypot(b.radius - a.radius, b.height - a.height);
}

// Returns a point of the span p[1]..p[2] of a Catmull-Rom spline with centripetal knots, by the pyramid of
// Barry and Goldman, SIGGRAPH 1988.
ProfilePoint spline_point(const std::array<ProfilePoint, 4>& p, double t) {
  std::array<double, 4> knot{};
  for (std::size_t i = 1; i < 4; ++i) knot[i] = knot[i - 1] + std::sqrt(distance(p[i - 1], p[i]));
  const double u = std::lerp(knot[1], knot[2], t);
  std::array<ProfilePoint, 4> q = p;
  for (std::size_t level = 1; level < 3; ++level) {
    for (std::size_t i = 0; i + level < 4; ++i) {
      q[i] = mix(q[i], q[i + 1], (u - knot[i]) / (knot[i + level] - knot[i]));
    }
  }
  return mix(q[0], q[1], t);
}

// Returns a control point beyond an end: the next one mirrored at the axis, or a straight continuation.
ProfilePoint beyond_end(const ProfilePoint& end, const ProfilePoint& next) {
  if (end.radius == 0) return {-next.radius, next.height};
  return {2 * end.radius - next.radius, 2 * end.height - next.height};
}

bool on_axis(const ProfilePoint& p) {
  return p.radius == 0;
}

// The vertices of one ring of a surface of revolution: a single pole, or `segments` vertices.
struct Ring {
  std::uint32_t first = 0;
  std::uint32_t count = 1;
  [[nodiscard]] std::uint32_t at(std::uint32_t j) const { return first + j % count; }
};

Ring add_ring(Mesh& mesh, const ProfilePoint& p, std::uint32_t segments, double depth_scale) {
  const Ring ring{static_cast<std::uint32_t>(mesh.positions.size()), on_axis(p) ? 1U : segments};
  for (std::uint32_t j = 0; j < ring.count; ++j) {
    const double angle = kTurn * j / segments;
    mesh.positions.push_back(
        to_float({p.radius * std::cos(angle), p.height, depth_scale * p.radius * std::sin(angle)}));
  }
  return ring;
}

void join_rings(Mesh& mesh, const Ring& low, const Ring& high, std::uint32_t segments) {
  for (std::uint32_t j = 0; j < segments; ++j) {
    if (high.count > 1) mesh.triangles.push_back({low.at(j), high.at(j), high.at(j + 1)});
    if (low.count > 1) mesh.triangles.push_back({low.at(j), high.at(j + 1), low.at(j + 1)});
  }
}

// The six sides of a cube: a corner of the lattice and two directions whose cross product points outwards.
struct CubeSide {
  std::array<std::uint32_t, 3> corner, u, v;  // corner in units of n
};
constexpr std::array<CubeSide, 6> kCubeSides{{{{0, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                              {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                              {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}},
                                              {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}},
                                              {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}},
                                              {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}}};

// Returns coordinates at equal angles instead of equal lengths, so that the squares have nearly the same size
// on the sphere.
double cube_coordinate(std::uint32_t i, std::uint32_t n) {
  return std::tan(std::numbers::pi / 4 * (2.0 * i / n - 1.0));
}

}  // namespace

Profile smooth_profile(std::span<const ProfilePoint> controls, std::uint32_t steps) {
  Profile result;
  const std::size_t spans = controls.size() - 1;
  for (std::size_t i = 0; i < spans; ++i) {
    const std::array<ProfilePoint, 4> p{
        i == 0 ? beyond_end(controls[0], controls[1]) : controls[i - 1], controls[i], controls[i + 1],
        i + 2 <= spans ? controls[i + 2] : beyond_end(controls[spans], controls[spans - 1])};
    result.push_back(controls[i]);
    for (std::uint32_t k = 1; k < steps; ++k)
      result.push_back(spline_point(p, static_cast<double>(k) / steps));
  }
  result.push_back(controls[spans]);
  return result;
}

Profile offset_profile(const Profile& profile, double distance_left) {
  Profile result = profile;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const ProfilePoint& before = profile[i == 0 ? 0 : i - 1];
    const ProfilePoint& after = profile[std::min(i + 1, profile.size() - 1)];
    const double size = distance(before, after);
    const double along_radius = (after.radius - before.radius) / size;
    const double along_height = (after.height - before.height) / size;
    if (on_axis(profile[i])) {
      result[i].height += distance_left;
    } else {
      result[i].radius -= distance_left * along_height;
      result[i].height += distance_left * along_radius;
    }
  }
  return result;
}

Mesh revolve(const Profile& profile, std::uint32_t segments, double depth_scale) {
  Mesh mesh;
  Ring low = add_ring(mesh, profile.front(), segments, depth_scale);
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const Ring high = add_ring(mesh, profile[i], segments, depth_scale);
    join_rings(mesh, low, high, segments);
    low = high;
  }
  mesh.normals = vertex_normals(mesh);
  return mesh;
}

Mesh tube(const std::function<CurvePoint(double)>& curve, double radius, std::uint32_t steps,
          std::uint32_t segments) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < steps; ++i) {
    const CurvePoint c = curve(static_cast<double>(i) / steps);
    const Vec3d tangent = normalized(c.tangent);
    const Vec3d side = normalized(c.side - tangent * dot(c.side, tangent));
    const Vec3d up = cross(tangent, side);
    for (std::uint32_t j = 0; j < segments; ++j) {
      const double angle = kTurn * j / segments;
      const Vec3d normal = side * std::cos(angle) + up * std::sin(angle);
      mesh.positions.push_back(to_float(c.position + normal * radius));
    }
  }
  const auto vertex = [&](std::uint32_t i, std::uint32_t j) { return i % steps * segments + j % segments; };
  for (std::uint32_t i = 0; i < steps; ++i) {
    for (std::uint32_t j = 0; j < segments; ++j) {
      mesh.triangles.push_back({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j)});
    }
  }
  mesh.normals = vertex_normals(mesh);
  return mesh;
}

Mesh star_shape(const std::function<double(const Vec3d&)>& radius, std::uint32_t n) {
  Mesh mesh;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> lattice;
  const auto vertex = [&](const std::array<std::uint32_t, 3>& at) {
    const auto [entry, is_new] = lattice.try_emplace(at, static_cast<std::uint32_t>(mesh.positions.size()));
    if (is_new) {
      const Vec3d direction =
          normalized(Vec3d{cube_coordinate(at[0], n), cube_coordinate(at[1], n), cube_coordinate(at[2], n)});
      mesh.positions.push_back(to_float(direction * radius(direction)));
    }
    return entry->second;
  };
  for (const CubeSide& side : kCubeSides) {
    const auto at = [&](std::uint32_t i, std::uint32_t j) {
      std::array<std::uint32_t, 3> p{};
      for (std::size_t k = 0; k < 3; ++k) p[k] = side.corner[k] * n + side.u[k] * i + side.v[k] * j;
      return vertex(p);
    };
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t j = 0; j < n; ++j) {
        mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
  }
  mesh.normals = vertex_normals(mesh);
  return mesh;
}

Mesh disc(double radius, double height, std::uint32_t segments) {
  // The profile runs from the rim to the pole, so that the normal points up.
  return revolve({{radius, height}, {0, height}}, segments);
}

Mesh grid(double half_width, double height, std::uint32_t n) {
  Mesh mesh;
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (std::uint32_t j = 0; j <= n; ++j) {
      mesh.positions.push_back(
          to_float({half_width * (2.0 * j / n - 1.0), height, half_width * (2.0 * i / n - 1.0)}));
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j;
      mesh.triangles.push_back({a, a + n + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + 1});
    }
  }
  mesh.normals = vertex_normals(mesh);
  return mesh;
}

void translate(Mesh& mesh, const Vec3f& by) {
  for (Vec3f& p : mesh.positions) p += by;
}

void turn_about_y(Mesh& mesh, double radians) {
  const double c = std::cos(radians);
  const double s = std::sin(radians);
  const auto turn = [&](Vec3f& p) { p = to_float({c * p.x + s * p.z, p.y, c * p.z - s * p.x}); };
  for (Vec3f& p : mesh.positions) turn(p);
  for (Vec3f& n : mesh.normals) turn(n);
}

void append(Mesh& mesh, const Mesh& more) {
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), more.positions.begin(), more.positions.end());
  mesh.normals.insert(mesh.normals.end(), more.normals.begin(), more.normals.end());
  for (const Triangle& t : more.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

Mesh flipped(const Mesh& mesh) {
  Mesh result = mesh;
  for (Triangle& t : result.triangles) std::swap(t[1], t[2]);
  for (Vec3f& n : result.normals) n = -n;
  return result;
}

}  // namespace pellucid
