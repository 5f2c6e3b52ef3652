// Implements region_edges.h: cuts the polytope of the viewpoints from which one face hides another, and finds
// the edges of a view cell that no sample shows.
#include "transparency/graph/region_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace pellucid {

// ---------------------------------------------------------------------------------- the viewpoints of a cell

namespace {

constexpr double kSlack = 1e-11;  // more than rounding can move a plane, so that cuts never remove too much

// Returns the point at `share` of the way from p to q.
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

  // Append new vertices where edges cross the plane.
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

// ------------------------------------------------------------ the viewpoints from which a face hides another

namespace {

// Parts of a face that are nearer to the plane of the other than this lie in it, because positions are
// rounded to 6e-8.
constexpr double kApart = 1e-7;
// If an edge and a point are nearer to each other than this, the plane through them is too uncertain for a
// cut.
constexpr double kCloseToEdge = 1e-7;
// A corner that is at most this far on the wrong side touches a separating plane.
constexpr double kOnPlane = 1e-10;

// The part of a triangle on one side of a plane.
struct FacePart {
  std::array<Vec3d, 4> points;
  std::size_t count = 0;
  void push(const Vec3d& p) { points[count++] = p; }
};

// Returns the part where the signed distance is positive. It is empty if no distance is above kApart.
FacePart part_in_front(const std::array<Vec3d, 3>& corners, const std::array<double, 3>& distances) {
  FacePart part;
  if (std::ranges::max(distances) <= kApart) return part;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (distances[i] >= 0) part.push(corners[i]);
    if ((distances[i] < 0) != (distances[j] < 0)) {
      part.push(corners[i] + (corners[j] - corners[i]) * (distances[i] / (distances[i] - distances[j])));
    }
  }
  return part;
}

// Returns the signed distances of the corners of a face before (sign = 1) or behind (-1) a plane.
std::array<double, 3> distances_from(const HalfSpace& plane, const std::array<Vec3d, 3>& corners,
                                     double sign) {
  std::array<double, 3> distances{};
  for (std::size_t i = 0; i < 3; ++i) distances[i] = sign * plane.value({corners[i], 1});
  return distances;
}

struct Extent {
  double low, high;
};
Extent extent_along(const FacePart& part, const Vec3d& normal, const Vec3d& origin) {
  Extent extent{HUGE_VAL, -HUGE_VAL};
  for (std::size_t i = 0; i < part.count; ++i) {
    const double d = dot(normal, part.points[i] - origin);
    extent = {std::min(extent.low, d), std::max(extent.high, d)};
  }
  return extent;
}

// Returns the half-space of the plane through p, q and r, if the plane separates the parts and `front` is
// inside.
std::optional<HalfSpace> separating(const FacePart& front, const FacePart& back, const Vec3d& p,
                                    const Vec3d& q, const Vec3d& r) {
  const Vec3d edge = q - p;
  Vec3d normal = cross(edge, r - p);
  const double size = length(normal);
  if (size <= kCloseToEdge * length(edge)) return std::nullopt;
  normal = normal / size;
  const Extent a = extent_along(front, normal, p);
  const Extent b = extent_along(back, normal, p);
  const bool upright = a.low >= -kOnPlane && b.high <= kOnPlane;
  const bool reversed = a.high <= kOnPlane && b.low >= -kOnPlane;
  if (upright == reversed) return std::nullopt;
  if (reversed) normal = -normal;
  return HalfSpace{normal, -dot(normal, p)};
}

// Cuts by every separating plane through an edge of one part and a corner of the other.
void cut_by_tangents(ViewPolytope& viewpoints, const FacePart& front, const FacePart& back,
                     bool edges_of_front) {
  const FacePart& with_edge = edges_of_front ? front : back;
  const FacePart& with_corner = edges_of_front ? back : front;
  for (std::size_t i = 0; i < with_edge.count; ++i) {
    const Vec3d& p = with_edge.points[i];
    const Vec3d& q = with_edge.points[(i + 1) % with_edge.count];
    for (std::size_t k = 0; k < with_corner.count; ++k) {
      const auto half_space = separating(front, back, p, q, with_corner.points[k]);
      if (!half_space) continue;
      viewpoints.cut(*half_space);
      if (viewpoints.empty()) return;
    }
  }
}

// Returns the half-space in front of a face, tilted by its edge-on angle.
HalfSpace clearly_in_front(const SolidFace& face, const ViewSolid& solid) {
  return {face.front.normal - solid.axis * face.edge_on, face.front.offset};
}

}  // namespace

void find_hiding_viewpoints(const ViewSolid& solid, const SolidFace& front, const SolidFace& back,
                            ViewPolytope& viewpoints) {
  viewpoints.clear();
  const FacePart hiding = part_in_front(front.corners, distances_from(back.front, front.corners, 1));
  if (hiding.count == 0) return;
  const FacePart hidden = part_in_front(back.corners, distances_from(front.front, back.corners, -1));
  if (hidden.count == 0) return;

  viewpoints.copy(solid.frustum);
  viewpoints.cut(clearly_in_front(front, solid));
  viewpoints.cut(clearly_in_front(back, solid));
  if (!viewpoints.empty()) cut_by_tangents(viewpoints, hiding, hidden, true);
  if (!viewpoints.empty()) cut_by_tangents(viewpoints, hiding, hidden, false);
}

// --------------------------------------------------------------------------------------- the edges of a cell

namespace {

// A face whose image is smaller than this (square radii) is edge-on. Near cameras see faces up to 27 times as
// large, which is still no more than the least weight of the edges of samples.
constexpr double kEdgeOnImageArea = 1e-8;

// Narrows a triangle by `inset` on all sides: scales it about the centre of its incircle. Returns false if
// nothing is left.
bool narrow(std::array<Vec3d, 3>& corners, double inset) {
  const double a = length(corners[2] - corners[1]);
  const double b = length(corners[0] - corners[2]);
  const double c = length(corners[1] - corners[0]);
  const double around = a + b + c;
  const double doubled_area = length(cross(corners[1] - corners[0], corners[2] - corners[0]));
  if (!(doubled_area > inset * around)) return false;  // the incircle's radius is doubled_area / around
  const Vec3d middle = (corners[0] * a + corners[1] * b + corners[2] * c) / around;
  const double scale = 1 - inset * around / doubled_area;
  for (Vec3d& corner : corners) corner = middle + (corner - middle) * scale;
  return true;
}

// Bounds of all triangles in a frame of the cell, and of the directions from them to its viewpoints, as
// slopes against the axis of the cell. They show for most pairs that no viewpoint sees one triangle before
// the other. Structure of arrays, single precision, rounded outward.
class RegionBounds {
 public:
  RegionBounds(const ViewSolid& solid, std::size_t triangle_count) : solid_(solid) {
    // Across the three sides of the cell.
    const auto frustum = solid.frustum.vertices();
    for (std::size_t k = 0; k < kAxes; ++k) {
      const Vec3d side = cross(frustum[2 * k].eye.at, frustum[(2 * k + 2) % 6].eye.at);
      across_[k] = normalized(side - solid.axis * dot(side, solid.axis));
    }
    for (std::size_t k = 0; k < kAxes; ++k) {
      low_[k].resize(triangle_count);
      high_[k].resize(triangle_count);
    }
    low_height_.resize(triangle_count);
    high_height_.resize(triangle_count);
  }

  void put(std::size_t triangle, const std::array<Vec3d, 3>& corners) {
    for (std::size_t k = 0; k < kAxes; ++k) {
      const auto [low, high] = interval(corners, across_[k]);
      low_[k][triangle] = low;
      high_[k][triangle] = high;
    }
    const auto [low, high] = interval(corners, solid_.axis);
    low_height_[triangle] = low;
    high_height_[triangle] = high;
  }

  // Stores a triangle without an image: it is in front of nothing and behind nothing.
  void put_nothing(std::size_t triangle) {
    for (std::size_t k = 0; k < kAxes; ++k) {
      low_[k][triangle] = kFar;
      high_[k][triangle] = -kFar;
    }
    low_height_[triangle] = kFar;
    high_height_[triangle] = -kFar;
  }

  // Sets maybe[t] to 0 if no viewpoint sees `front` before triangle t.
  void find_candidates(std::size_t front, const std::array<Vec3d, 3>& corners,
                       std::vector<std::uint32_t>& maybe) const {
    const Front f = front_of(front, corners);
    const std::size_t count = low_height_.size();
    for (std::size_t t = 0; t < count; ++t) {
      // The range of the height of a point of the front above a point of the other.
      const float least = std::max(0.0F, f.low_height - high_height_[t]);
      const float most = f.high_height - low_height_[t];
      unsigned meet = most > 0 ? 1U : 0U;
      for (std::size_t k = 0; k < kAxes; ++k) {
        // The front's points shifted across by height times slope must meet those of the other.
        const float up = std::max(f.high_slope[k] * least, f.high_slope[k] * most);
        const float down = std::min(f.low_slope[k] * least, f.low_slope[k] * most);
        // There are no branches, so that the compiler uses SIMD.
        meet &= static_cast<unsigned>(f.low[k] - high_[k][t] <= up);
        meet &= static_cast<unsigned>(f.high[k] - low_[k][t] >= down);
      }
      maybe[t] = meet;
    }
  }

 private:
  static constexpr std::size_t kAxes = 3;
  static constexpr float kFar = 1e3F;        // beyond all positions, which are in bounding radii
  static constexpr float kSteep = 1e4F;      // a slope beyond all others
  static constexpr float kRounding = 1e-6F;  // of positions and, in proportion, of slopes

  struct Interval {
    float low, high;
  };
  struct Front {
    std::array<float, kAxes> low, high, low_slope, high_slope;
    float low_height, high_height;
  };

  static Interval interval(const std::array<Vec3d, 3>& corners, const Vec3d& axis) {
    const double a = dot(corners[0], axis);
    const double b = dot(corners[1], axis);
    const double c = dot(corners[2], axis);
    return {static_cast<float>(std::min({a, b, c})) - kRounding,
            static_cast<float>(std::max({a, b, c})) + kRounding};
  }

  // Slopes are quotients of linear functions in the eye and in the point. So they are extreme at corners.
  [[nodiscard]] Front front_of(std::size_t triangle, const std::array<Vec3d, 3>& corners) const {
    Front f{};
    for (std::size_t k = 0; k < kAxes; ++k) {
      f.low[k] = low_[k][triangle];
      f.high[k] = high_[k][triangle];
      f.low_slope[k] = kSteep;
      f.high_slope[k] = -kSteep;
    }
    f.low_height = low_height_[triangle];
    f.high_height = high_height_[triangle];
    for (const ViewPolytope::Vertex& v : solid_.frustum.vertices()) {
      for (const Vec3d& corner : corners) {
        const Vec3d way = v.eye.at - corner * v.eye.w;
        const double height = dot(way, solid_.axis);
        // The corner is beside the eye or above it, so any direction is possible.
        if (height < 1e-3) return anywhere(f);
        for (std::size_t k = 0; k < kAxes; ++k) {
          const auto slope = static_cast<float>(dot(way, across_[k]) / height);
          const float margin = kRounding * (1 + std::fabs(slope));
          f.low_slope[k] = std::min(f.low_slope[k], slope - margin);
          f.high_slope[k] = std::max(f.high_slope[k], slope + margin);
        }
      }
    }
    return f;
  }

  static Front anywhere(Front f) {
    f.low_height = -kFar;
    f.high_height = kFar;
    f.low_slope.fill(-kSteep);
    f.high_slope.fill(kSteep);
    return f;
  }

  const ViewSolid& solid_;
  std::array<Vec3d, kAxes> across_;
  std::array<std::vector<float>, kAxes> low_, high_;
  std::vector<float> low_height_, high_height_;
};

// Finds the facings that the viewpoints of one cell see, and the edges between them.
class CellEdges {
 public:
  CellEdges(const ViewSolid& solid, const std::vector<SolidFace>& faces, const EdgeRows& samples)
      : solid_(solid),
        faces_(faces),
        samples_(samples),
        bounds_(solid, faces.size() / 2),
        maybe_(faces.size() / 2),
        seen_(faces.size()),
        known_(faces.size()) {}

  void see(NodeId node) { seen_[node] = can_be_seen(faces_[node]) ? 1 : 0; }

  EdgeRows find() {
    const auto triangle_count = static_cast<std::uint32_t>(faces_.size() / 2);
    for (std::uint32_t t = 0; t < triangle_count; ++t) {
      if (shown(t)) {
        bounds_.put(t, faces_[node_of(t, false)].corners);
      } else {
        bounds_.put_nothing(t);
      }
    }
    EdgeRows rows;
    rows.offsets.reserve(faces_.size() + 1);
    rows.offsets.push_back(0);
    for (std::uint32_t t = 0; t < triangle_count; ++t) {
      if (shown(t)) bounds_.find_candidates(t, faces_[node_of(t, false)].corners, maybe_);
      for (const bool flipped : {false, true}) append_row(node_of(t, flipped), rows);
    }
    return rows;
  }

 private:
  [[nodiscard]] bool shown(std::uint32_t triangle) const {
    return (seen_[node_of(triangle, false)] | seen_[node_of(triangle, true)]) != 0;
  }

  [[nodiscard]] bool can_be_seen(const SolidFace& face) const {
    return std::ranges::any_of(solid_.frustum.vertices(), [&](const ViewPolytope::Vertex& v) {
      return face.front.value(v.eye) > face.edge_on * dot(solid_.axis, v.eye.at);
    });
  }

  void append_row(NodeId front, EdgeRows& rows) {
    const std::uint32_t begin = samples_.offsets[front];
    const std::uint32_t end = samples_.offsets[front + 1];
    if (seen_[front] != 0) {
      for (std::uint32_t i = begin; i < end; ++i) known_[samples_.backs[i]] = 1;
      find_unseen(front);
      for (std::uint32_t i = begin; i < end; ++i) known_[samples_.backs[i]] = 0;
    }
    // Both lists are sorted by back node. Merge them.
    std::size_t next = 0;
    const auto add_unseen = [&](NodeId before) {
      for (; next < unseen_.size() && unseen_[next] < before; ++next) {
        rows.backs.push_back(unseen_[next]);
        rows.weights.push_back(kUnseenWeight);
      }
    };
    for (std::uint32_t i = begin; i < end; ++i) {
      add_unseen(samples_.backs[i]);
      rows.backs.push_back(samples_.backs[i]);
      rows.weights.push_back(std::max(samples_.weights[i], kUnseenWeight));
    }
    add_unseen(static_cast<NodeId>(faces_.size()));
    unseen_.clear();
    rows.offsets.push_back(static_cast<std::uint32_t>(rows.backs.size()));
  }

  // Finds the nodes that some viewpoint sees behind `front`, although no sample does.
  void find_unseen(NodeId front) {
    for (std::uint32_t t = 0; t < maybe_.size(); ++t) {
      if (maybe_[t] == 0 || t == triangle_of(front)) continue;
      for (const bool flipped : {false, true}) {
        const NodeId back = node_of(t, flipped);
        if (seen_[back] == 0 || known_[back] != 0) continue;
        find_hiding_viewpoints(solid_, faces_[front], faces_[back], viewpoints_);
        if (solid_.holds_part_of(viewpoints_)) unseen_.push_back(back);
      }
    }
  }

  const ViewSolid& solid_;
  const std::vector<SolidFace>& faces_;
  const EdgeRows& samples_;
  RegionBounds bounds_;
  std::vector<std::uint32_t> maybe_;  // per triangle
  std::vector<std::uint8_t> seen_, known_;
  std::vector<NodeId> unseen_;
  ViewPolytope viewpoints_;
};

}  // namespace

RegionEdges::RegionEdges(const std::vector<Triangle>& triangles, const std::vector<Vec3d>& positions,
                         const ViewPartition& partition, bool front_only, double tolerance, double from,
                         double to)
    : partition_(partition),
      from_(from),
      to_(to),
      front_only_(front_only),
      faces_(2 * triangles.size()),
      wide_(triangles.size()) {
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    SolidFace face;
    for (std::size_t k = 0; k < 3; ++k) face.corners[k] = positions[triangles[t][k]];
    const Vec3d perpendicular = cross(face.corners[1] - face.corners[0], face.corners[2] - face.corners[0]);
    const double area = 0.5 * length(perpendicular);
    face.front.normal = normalized(perpendicular);
    face.front.offset = -dot(face.front.normal, face.corners[0]);
    face.edge_on = kEdgeOnImageArea / area;
    wide_[t] = area > kEdgeOnImageArea && narrow(face.corners, 0.5 * tolerance) ? 1 : 0;
    faces_[node_of(t, false)] = face;
    face.front = {-face.front.normal, -face.front.offset};
    faces_[node_of(t, true)] = face;
  }
}

EdgeRows RegionEdges::complete(std::uint32_t cell, const EdgeRows& samples) const {
  const ViewSolid solid = make_view_solid(partition_.corners[cell], from_, to_);
  CellEdges edges(solid, faces_, samples);
  for (std::uint32_t t = 0; t < wide_.size(); ++t) {
    if (wide_[t] == 0) continue;
    edges.see(node_of(t, false));
    if (!front_only_) edges.see(node_of(t, true));
  }
  return edges.find();
}

}  // namespace pellucid
