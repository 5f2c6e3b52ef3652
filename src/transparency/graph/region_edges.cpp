// All occlusions between faces from all viewpoints of a view cell: see region_edges.h.
#include "transparency/graph/region_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace pellucid {
namespace {

// A face whose picture is smaller than this (square radii) is edge-on. Near cameras see faces up to 27 times
// as large: still no more than the least weight that edges of samples must have.
constexpr double kEdgeOnPicture = 1e-8;

// A triangle narrowed by `inset` on all sides: scaled about the centre of its incircle. False: nothing is
// left.
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
// slopes against the cell's axis: what decides for most pairs that no viewpoint sees one before the other.
// Structure of arrays, single precision, rounded outward.
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

  // No picture: in front of nothing, and behind nothing.
  void put_nothing(std::size_t triangle) {
    for (std::size_t k = 0; k < kAxes; ++k) {
      low_[k][triangle] = kFar;
      high_[k][triangle] = -kFar;
    }
    low_height_[triangle] = kFar;
    high_height_[triangle] = -kFar;
  }

  // maybe[t] = 0 where no viewpoint sees `front` before triangle t.
  void find_candidates(std::size_t front, const std::array<Vec3d, 3>& corners,
                       std::vector<std::uint32_t>& maybe) const {
    const Front f = front_of(front, corners);
    const std::size_t count = low_height_.size();
    for (std::size_t t = 0; t < count; ++t) {
      // A point of the front is so much higher than one of the other.
      const float least = std::max(0.0F, f.low_height - high_height_[t]);
      const float most = f.high_height - low_height_[t];
      unsigned meet = most > 0 ? 1U : 0U;
      for (std::size_t k = 0; k < kAxes; ++k) {
        // The front's points shifted across by height times slope must meet those of the other.
        const float up = std::max(f.high_slope[k] * least, f.high_slope[k] * most);
        const float down = std::min(f.low_slope[k] * least, f.low_slope[k] * most);
        // Without branches, for SIMD.
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

  // Slopes are quotients of linear functions in the eye and in the point: extreme at corners.
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
        // Beside the eye, or above it: it may look anywhere.
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

// One cell at a time: which facings its viewpoints see, and the edges between them.
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
    // Both by back node: merge.
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

  // The nodes that some viewpoint sees behind `front`, but no sample does.
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
    face.edge_on = kEdgeOnPicture / area;
    wide_[t] = area > kEdgeOnPicture && narrow(face.corners, 0.5 * tolerance) ? 1 : 0;
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
