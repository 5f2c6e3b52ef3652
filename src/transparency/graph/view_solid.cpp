// The viewpoints of a view cell as a solid: see view_solid.h.
#include "transparency/graph/view_solid.h"

#include <algorithm>
#include <cmath>

namespace pellucid {
namespace {

constexpr double kSlack = 1e-11;  // what rounding may move a plane by, and more: cuts err to the outside

// The point at `share` of the way from p to q.
Eye between(const Eye& p, const Eye& q, double share) {
  return {p.at * (1 - share) + q.at * share, p.w * (1 - share) + q.w * share};
}

}  // namespace

void ViewPolytope::copy(const ViewPolytope& other) {
  std::copy_n(other.vertices_.begin(), other.count_, vertices_.begin());
  count_ = other.count_;
  plane_count_ = other.plane_count_;
}

void ViewPolytope::add(const Eye& eye, std::uint64_t planes) {
  vertices_[count_++] = {eye, planes};
}

void ViewPolytope::cut(const HalfSpace& half_space) {
  std::array<double, kMostVertices> values;  // not set beyond count_
  std::size_t inside = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    values[i] = half_space.value(vertices_[i].eye) + kSlack;
    if (values[i] >= 0) ++inside;
  }
  if (inside == count_) return;
  if (inside == 0) {
    count_ = 0;
    return;
  }
  if (plane_count_ == 64) return;

  // New vertices where edges cross the plane, behind the old ones.
  const std::uint64_t plane = std::uint64_t{1} << plane_count_;
  std::size_t end = count_;
  for (std::size_t i = 0; i < count_; ++i) {
    if (values[i] < 0) continue;
    for (std::size_t j = 0; j < count_; ++j) {
      if (values[j] >= 0) continue;
      const std::uint64_t common = vertices_[i].planes & vertices_[j].planes;
      if (std::popcount(common) < 2) continue;
      if (end == kMostVertices) return;
      const double share = values[i] / (values[i] - values[j]);
      vertices_[end++] = {between(vertices_[i].eye, vertices_[j].eye, share), common | plane};
    }
  }
  ++plane_count_;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < end; ++i) {
    if (i >= count_ || values[i] >= 0) vertices_[kept++] = vertices_[i];
  }
  count_ = kept;
}

bool ViewSolid::holds_part_of(const ViewPolytope& polytope) const {
  if (std::isinf(from)) return !polytope.empty();
  constexpr double kRounding = 1e-12;
  const double least = from * from * (1 - kRounding);
  return std::ranges::any_of(polytope.vertices(), [&](const ViewPolytope::Vertex& v) {
    return dot(v.eye.at, v.eye.at) >= least * v.eye.w * v.eye.w;
  });
}

ViewSolid make_view_solid(const std::array<Vec3d, 3>& corners, double from, double to) {
  ViewSolid solid;
  solid.axis = normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
  solid.from = from;
  // Corner k lies in the cone's planes k and k + 1; plane 3 is the near one, 4 the far one.
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint64_t sides = std::uint64_t{1} << k | std::uint64_t{1} << (k + 1) % 3;
    const auto put = [&](double distance, std::uint64_t planes) {
      const Eye eye = std::isinf(distance)
                          ? Eye{corners[k], 0}
                          : Eye{corners[k] * (distance / (1 + distance)), 1 / (1 + distance)};
      solid.frustum.add(eye, planes);
    };
    put(from, sides | 8U);
    put(to / dot(corners[k], solid.axis), sides | 16U);
  }
  solid.frustum.set_plane_count(5);
  return solid;
}

}  // namespace pellucid
