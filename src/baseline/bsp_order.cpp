// Implements the binary space partition of pellucid/baseline.h: builds the tree from the triangles, and walks
// it for an eye.
//
// Based on: Fuchs, Kedem, Naylor, "On Visible Surface Generation by A Priori Tree Structures", SIGGRAPH 1980.
// Splitters are the planes of the polygons themselves (autopartition), chosen from a sample by few splits and
// balance. Polygons stay convex, so that a cut makes exactly two. They become triangles at the end.
#include <algorithm>
#include <cmath>
#include <map>

#include "pellucid/baseline.h"
#include "pellucid/split.h"

namespace pellucid {
namespace {

// A point that is nearer to a plane than this (bounding radii) lies in it. The float32 positions of flat
// surfaces scatter by 1e-7, and an order that is wrong by this much is not visible.
constexpr double kThickness = 1e-6;
// Splitters tried per node, and polygons that each is tried on.
constexpr std::uint32_t kCandidates = 12;
constexpr std::uint32_t kTrialPolygons = 128;
// The cost of a split, relative to one polygon of imbalance between the two sides.
constexpr double kSplitWeight = 6;

struct Polygon {
  std::vector<std::uint32_t> corners;  // into points, convex, in the winding of the source
  std::uint32_t source = 0;
};

struct PlaneD {
  Vec3d normal;
  double offset = 0;
};

enum class Side { front, back, in_plane, across };

class BspBuilder {
 public:
  BspBuilder(const Mesh& mesh, const BspOptions& options)
      : mesh_(mesh), options_(options), random_(options.seed) {
    sphere_ = bounding_sphere(mesh);
    const double scale = sphere_.radius > 0 ? 1 / sphere_.radius : 1;
    points_.reserve(mesh.positions.size());
    for (const Vec3f& p : mesh.positions) points_.push_back((to_double(p) - sphere_.center) * scale);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) planes_.push_back(plane_of(t));
  }

  BspTree build() {
    begin_stage(options_.progress, "bsp", 0);
    std::vector<Polygon> all;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const Triangle& corners = mesh_.triangles[t];
      all.push_back({{corners.begin(), corners.end()}, t});
    }
    pieces_ = all.size();
    if (!all.empty()) push(std::move(all), 0, true);
    while (!work_.empty() && pieces_ <= options_.max_pieces) {
      stop_if_requested(options_.progress);
      Work work = std::move(work_.back());
      work_.pop_back();
      partition(std::move(work));
    }
    if (!work_.empty()) {
      tree_ = {};
      tree_.complete = false;
      return std::move(tree_);
    }
    for (const Vec3d& p : points_)
      tree_.mesh.positions.push_back(to_float(p * sphere_.radius + sphere_.center));
    std::copy(mesh_.positions.begin(), mesh_.positions.end(), tree_.mesh.positions.begin());
    return std::move(tree_);
  }

 private:
  struct Work {
    std::vector<Polygon> polygons;
    std::uint32_t parent = 0;
    bool in_front = false;
  };

  // Returns the plane through the points of the input, so that pieces keep the plane of their source.
  [[nodiscard]] PlaneD plane_of(std::uint32_t triangle) const {
    const Triangle& t = mesh_.triangles[triangle];
    const Vec3d normal = normalized(cross(points_[t[1]] - points_[t[0]], points_[t[2]] - points_[t[0]]));
    return {normal, dot(normal, points_[t[0]] + points_[t[1]] + points_[t[2]]) / 3};
  }

  void push(std::vector<Polygon> polygons, std::uint32_t parent, bool in_front) {
    if (!polygons.empty()) work_.push_back({std::move(polygons), parent, in_front});
  }

  [[nodiscard]] double height(const PlaneD& plane, std::uint32_t point) const {
    return dot(plane.normal, points_[point]) - plane.offset;
  }

  [[nodiscard]] Side classify(const PlaneD& plane, const Polygon& polygon) const {
    bool front = false;
    bool back = false;
    for (const std::uint32_t corner : polygon.corners) {
      const double h = height(plane, corner);
      front = front || h > kThickness;
      back = back || h < -kThickness;
    }
    if (front && back) return Side::across;
    if (front) return Side::front;
    return back ? Side::back : Side::in_plane;
  }

  // Returns the triangle whose plane splits few polygons and leaves about as many on either side.
  [[nodiscard]] std::uint32_t choose_splitter(const std::vector<Polygon>& polygons) {
    const std::size_t stride = (polygons.size() + kTrialPolygons - 1) / kTrialPolygons;
    std::uint32_t best = polygons.front().source;
    double best_cost = -1;
    for (std::uint32_t k = 0; k < std::min<std::size_t>(kCandidates, polygons.size()); ++k) {
      const std::uint32_t candidate = polygons[random_.below(polygons.size())].source;
      double splits = 0;
      double balance = 0;
      for (std::size_t i = 0; i < polygons.size(); i += stride) {
        const Side side = classify(planes_[candidate], polygons[i]);
        if (side == Side::across) ++splits;
        if (side == Side::front) ++balance;
        if (side == Side::back) --balance;
      }
      const double cost = kSplitWeight * splits + std::fabs(balance);
      if (best_cost < 0 || cost < best_cost) {
        best = candidate;
        best_cost = cost;
      }
    }
    return best;
  }

  void partition(Work work) {
    const std::uint32_t splitter = choose_splitter(work.polygons);
    const PlaneD plane = planes_[splitter];
    const auto index = static_cast<std::uint32_t>(tree_.nodes.size());
    if (index > 0) {
      BspNode& parent = tree_.nodes[work.parent];
      (work.in_front ? parent.front : parent.back) = index;
    }
    BspNode node;
    node.plane = stored(plane);
    node.first = static_cast<std::uint32_t>(tree_.mesh.triangles.size());
    std::vector<Polygon> front;
    std::vector<Polygon> back;
    cuts_.clear();
    for (Polygon& polygon : work.polygons) {
      // The plane of a sliver may be too uncertain for its own corners. The sliver still counts as lying in
      // it.
      const Side side = polygon.source == splitter ? Side::in_plane : classify(plane, polygon);
      switch (side) {
        case Side::front:
          front.push_back(std::move(polygon));
          break;
        case Side::back:
          back.push_back(std::move(polygon));
          break;
        case Side::in_plane:
          emit(polygon);
          break;
        case Side::across:
          split(plane, polygon, front, back);
          break;
      }
    }
    node.count = static_cast<std::uint32_t>(tree_.mesh.triangles.size()) - node.first;
    tree_.nodes.push_back(node);
    push(std::move(back), index, false);
    push(std::move(front), index, true);
  }

  [[nodiscard]] Plane stored(const PlaneD& plane) const {
    return {to_float(plane.normal),
            static_cast<float>(plane.offset * sphere_.radius + dot(plane.normal, sphere_.center))};
  }

  // Turns a convex polygon into a fan. Collinear corners make parts without area, which draw nothing.
  void emit(const Polygon& polygon) {
    for (std::size_t i = 2; i < polygon.corners.size(); ++i) {
      const Triangle t{polygon.corners[0], polygon.corners[i - 1], polygon.corners[i]};
      if (length(cross(points_[t[1]] - points_[t[0]], points_[t[2]] - points_[t[0]])) == 0) continue;
      tree_.mesh.triangles.push_back(t);
      tree_.source.push_back(polygon.source);
    }
  }

  void split(const PlaneD& plane, const Polygon& polygon, std::vector<Polygon>& front,
             std::vector<Polygon>& back) {
    Polygon near{{}, polygon.source};
    Polygon far{{}, polygon.source};
    std::vector<double> heights;
    for (const std::uint32_t corner : polygon.corners) heights.push_back(height(plane, corner));
    cut_convex(
        polygon.corners, heights, kThickness,
        [this](std::uint32_t a, std::uint32_t b, double ha, double hb) { return cut_edge(a, b, ha, hb); },
        near.corners, far.corners);
    front.push_back(std::move(near));
    back.push_back(std::move(far));
    ++tree_.splits;
    ++pieces_;
  }

  // Neighbours share the point where a plane cuts their common edge.
  std::uint32_t cut_edge(std::uint32_t a, std::uint32_t b, double ha, double hb) {
    if (a > b) {
      std::swap(a, b);
      std::swap(ha, hb);
    }
    const auto [at, fresh] = cuts_.try_emplace({a, b}, static_cast<std::uint32_t>(points_.size()));
    if (fresh) points_.push_back(points_[a] + (points_[b] - points_[a]) * (ha / (ha - hb)));
    return at->second;
  }

  const Mesh& mesh_;
  const BspOptions& options_;
  Random random_;
  BoundingSphere sphere_;
  std::vector<Vec3d> points_;  // unit sphere; of the input, then where edges were cut
  std::vector<PlaneD> planes_;
  std::vector<Work> work_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> cuts_;  // edge -> point, of one plane
  std::uint64_t pieces_ = 0;
  BspTree tree_;
};

}  // namespace

BspTree build_bsp(const Mesh& mesh, const BspOptions& options) {
  return BspBuilder(mesh, options).build();
}

void walk_bsp(const BspTree& tree, const Eye& eye, std::vector<std::uint32_t>& pieces) {
  pieces.resize(tree.mesh.triangles.size());
  if (tree.nodes.empty()) return;
  std::uint32_t* next = pieces.data();
  // Each node is on the stack twice: first to be opened, and then, after its near side, to be drawn.
  struct Visit {
    std::uint32_t node;
    bool draw;
  };
  std::vector<Visit> stack{{0, false}};
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    const BspNode& node = tree.nodes[visit.node];
    if (visit.draw) {
      for (std::uint32_t i = 0; i < node.count; ++i) *next++ = node.first + i;
      continue;
    }
    const bool in_front = side_of(node.plane, eye) >= 0;
    const std::uint32_t near = in_front ? node.front : node.back;
    const std::uint32_t far = in_front ? node.back : node.front;
    if (far != 0) stack.push_back({far, false});
    stack.push_back({visit.node, true});
    if (near != 0) stack.push_back({near, false});
  }
}

}  // namespace pellucid
