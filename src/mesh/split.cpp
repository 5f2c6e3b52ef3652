// Implements pellucid/split.h: finds triangles that intersect and cuts them into pieces that do not.
//
// One cut per pair is enough: after triangle A is cut along the plane of B, no piece of A crosses B. Of the
// two triangles, the one that the plane of the other meets along a shorter line is cut. This line mostly lies
// inside the other triangle. At its ends the neighbours cross the other triangle, too, and therefore need no
// further corner.
#include "pellucid/split.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "mesh/polygon_mesh.h"

namespace pellucid {
namespace {

// ------------------------------------------------------------------------------------------- a tree of boxes

// An axis-aligned box.
struct Box3 {
  Vec3d low, high;

  [[nodiscard]] bool overlaps(const Box3& b) const {
    return low.x <= b.high.x && b.low.x <= high.x && low.y <= b.high.y && b.low.y <= high.y &&
           low.z <= b.high.z && b.low.z <= high.z;
  }
  void include(const Vec3d& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
};

constexpr std::uint32_t kLeafSize = 4;

double component(const Vec3d& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

int longest_axis(const Box3& box) {
  const Vec3d size = box.high - box.low;
  if (size.x >= size.y && size.x >= size.z) return 0;
  return size.y >= size.z ? 1 : 2;
}

// A binary tree of boxes. Every node is split at the median of the box centres along its longest side.
// Building takes O(n log n).
class BoxTree {
 public:
  explicit BoxTree(std::span<const Box3> boxes) : boxes_(boxes), ids_(boxes.size()) {
    std::iota(ids_.begin(), ids_.end(), 0U);
    if (boxes.empty()) return;
    const auto count = static_cast<std::uint32_t>(boxes.size());
    nodes_.push_back({box_of(0, count), 0, 0, count});
    // Children follow their parents in the list, so one pass over the growing list visits every node.
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
      if (nodes_[node].count > kLeafSize) halve(node);
    }
  }

  // Calls visit(i) for every box that overlaps `query`, in an order that depends on the boxes alone.
  template <class Visit>
  void for_each_overlap(const Box3& query, const Visit& visit) const {
    if (nodes_.empty()) return;
    std::vector<std::uint32_t> stack{0};
    while (!stack.empty()) {
      const Node& node = nodes_[stack.back()];
      stack.pop_back();
      if (!node.box.overlaps(query)) continue;
      if (node.left != 0) {
        stack.push_back(node.left + 1);
        stack.push_back(node.left);
        continue;
      }
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        if (boxes_[ids_[i]].overlaps(query)) visit(ids_[i]);
      }
    }
  }

 private:
  struct Node {
    Box3 box;
    std::uint32_t left = 0;  // children are left and left + 1; 0: a leaf
    std::uint32_t first = 0, count = 0;
  };

  [[nodiscard]] Box3 box_of(std::uint32_t first, std::uint32_t count) const {
    Box3 box = boxes_[ids_[first]];
    for (std::uint32_t i = first + 1; i < first + count; ++i) {
      box.include(boxes_[ids_[i]].low);
      box.include(boxes_[ids_[i]].high);
    }
    return box;
  }

  void halve(std::uint32_t node) {
    const std::uint32_t first = nodes_[node].first;
    const std::uint32_t count = nodes_[node].count;
    const std::uint32_t half = count / 2;
    const int axis = longest_axis(nodes_[node].box);
    const auto middle = [&](std::uint32_t id) {
      return component(boxes_[id].low, axis) + component(boxes_[id].high, axis);
    };
    // The index breaks ties, so that the tree is the same everywhere.
    std::nth_element(ids_.begin() + first, ids_.begin() + first + half, ids_.begin() + first + count,
                     [&](std::uint32_t a, std::uint32_t b) {
                       const double key_a = middle(a);
                       const double key_b = middle(b);
                       return key_a < key_b || (key_a == key_b && a < b);
                     });
    nodes_[node].left = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({box_of(first, half), 0, first, half});
    nodes_.push_back({box_of(first + half, count - half), 0, first + half, count - half});
  }

  std::span<const Box3> boxes_;
  std::vector<std::uint32_t> ids_;
  std::vector<Node> nodes_;
};

// ---------------------------------------------------------------------------------------- intersecting pairs

struct Tolerances {
  double crossing, thickness;
};

// Returns the tolerances in bounding radii. They grow if the mesh is so far from the origin that float32
// coordinates resolve less.
Tolerances tolerances_of(const Mesh& mesh) {
  const BoundingSphere sphere = bounding_sphere(mesh);
  if (!(sphere.radius > 0)) return {kLeastCrossing, kPlaneThickness};
  const Vec3d& c = sphere.center;
  const double largest = std::max({std::fabs(c.x), std::fabs(c.y), std::fabs(c.z)}) + sphere.radius;
  const double resolution = 4 * largest * 0x1.0p-24 / sphere.radius;
  return {std::max(kLeastCrossing, resolution), std::max(kPlaneThickness, resolution)};
}

// The interval in which a plane meets a polygon, measured along the line where it meets the plane of the
// polygon.
struct Chord {
  double begin = std::numeric_limits<double>::infinity();
  double end = -std::numeric_limits<double>::infinity();
  [[nodiscard]] double length() const { return end - begin; }
};

// How two polygons cross.
struct Crossing {
  double length = 0;  // of the part of the line that both polygons share
  Chord chords[2];    // of each polygon
};

// A polygon and the signed distances of its corners from a plane. Reused as scratch memory.
struct PolygonHeights {
  std::vector<Vec3d> corners;
  std::vector<double> heights;
};

Chord chord_of(const PolygonHeights& polygon, const Vec3d& direction) {
  Chord chord;
  const std::size_t count = polygon.corners.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    const double h = polygon.heights[i];
    const double g = polygon.heights[next];
    if ((h > 0) == (g > 0)) continue;
    const Vec3d at = polygon.corners[i] + (polygon.corners[next] - polygon.corners[i]) * (h / (h - g));
    const double place = dot(direction, at);
    chord.begin = std::min(chord.begin, place);
    chord.end = std::max(chord.end, place);
  }
  return chord;
}

void measure(const CutPlane& plane, PolygonHeights& polygon) {
  polygon.heights.clear();
  for (const Vec3d& corner : polygon.corners) polygon.heights.push_back(plane.height(corner));
}

// Returns how the convex polygons `a` and `b` in the planes `a_plane` and `b_plane` cross, or nothing if they
// do not cross by more than `least`.
std::optional<Crossing> crossing_of(PolygonHeights& a, const CutPlane& a_plane, PolygonHeights& b,
                                    const CutPlane& b_plane, double least) {
  measure(b_plane, a);
  if (!crosses(a.heights, least)) return std::nullopt;
  measure(a_plane, b);
  if (!crosses(b.heights, least)) return std::nullopt;
  const Vec3d direction = normalized(cross(a_plane.normal, b_plane.normal));
  Crossing crossing;
  crossing.chords[0] = chord_of(a, direction);
  crossing.chords[1] = chord_of(b, direction);
  crossing.length = std::min(crossing.chords[0].end, crossing.chords[1].end) -
                    std::max(crossing.chords[0].begin, crossing.chords[1].begin);
  if (!(crossing.length > least)) return std::nullopt;
  return crossing;
}

struct IntersectingPair {
  std::uint32_t a, b;
  double length;
};

// Returns all intersecting pairs, sorted by their indices.
std::vector<IntersectingPair> intersecting_pairs(const Mesh& mesh, double least, Progress* progress) {
  const UnitGeometry geometry(mesh);
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  std::vector<Box3> boxes(count);
  std::vector<CutPlane> planes(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    const Triangle& corners = mesh.triangles[t];
    boxes[t] = {geometry.positions[corners[0]], geometry.positions[corners[0]]};
    for (const std::uint32_t v : corners) boxes[t].include(geometry.positions[v]);
    planes[t] = geometry.plane_of(corners);
  }
  const BoxTree tree(boxes);
  constexpr std::uint32_t kPerBlock = 512;
  const std::uint32_t blocks = (count + kPerBlock - 1) / kPerBlock;
  std::vector<std::vector<IntersectingPair>> found(blocks);
  begin_stage(progress, "intersections", blocks);
  parallel_loop(std::uint32_t{0}, blocks, [&](std::uint32_t block) {
    stop_if_requested(progress);
    PolygonHeights a;
    PolygonHeights b;
    const auto load = [&](std::uint32_t t, PolygonHeights& polygon) {
      polygon.corners.clear();
      for (const std::uint32_t v : mesh.triangles[t]) polygon.corners.push_back(geometry.positions[v]);
    };
    for (std::uint32_t t = block * kPerBlock; t < std::min((block + 1) * kPerBlock, count); ++t) {
      load(t, a);
      const std::size_t first = found[block].size();
      tree.for_each_overlap(boxes[t], [&](std::uint32_t other) {
        if (other <= t) return;
        load(other, b);
        const auto crossing = crossing_of(a, planes[t], b, planes[other], least);
        if (crossing) found[block].push_back({t, other, crossing->length});
      });
      std::sort(found[block].begin() + static_cast<std::ptrdiff_t>(first), found[block].end(),
                [](const IntersectingPair& x, const IntersectingPair& y) { return x.b < y.b; });
    }
    advance_stage(progress, 1);
  });
  std::vector<IntersectingPair> pairs;
  for (const auto& part : found) pairs.insert(pairs.end(), part.begin(), part.end());
  return pairs;
}

// ------------------------------------------------------------------------------------------------- splitting

class IntersectionSplitter {
 public:
  IntersectionSplitter(const Mesh& mesh, std::vector<IntersectingPair> pairs, const Tolerances& tolerances,
                       const SplitOptions& options)
      : pairs_(std::move(pairs)),
        tolerances_(tolerances),
        progress_(options.progress),
        polygons_(mesh, members(), tolerances.thickness, options.max_new_triangles) {}

  IntersectionSplit run() {
    IntersectionSplit result;
    result.pairs = pairs_.size();
    // Cut the longest crossings first, because they are the most visible ones if the limit is reached.
    std::vector<IntersectingPair> pairs = pairs_;
    std::stable_sort(pairs.begin(), pairs.end(), [](const IntersectingPair& x, const IntersectingPair& y) {
      return x.length > y.length;
    });
    begin_stage(progress_, "split", pairs.size());
    for (const IntersectingPair& pair : pairs) {
      stop_if_requested(progress_);
      separate(pair);
      advance_stage(progress_, 1);
    }
    for (const IntersectingPair& pair : pairs_) {
      if (still_crossing(pair)) ++result.left;
    }
    result.split = polygons_.finish();
    return result;
  }

 private:
  [[nodiscard]] std::vector<std::uint32_t> members() const {
    std::vector<std::uint32_t> triangles;
    for (const IntersectingPair& pair : pairs_) triangles.insert(triangles.end(), {pair.a, pair.b});
    return triangles;
  }

  std::optional<Crossing> crossing_of_pieces(std::uint32_t p, const CutPlane& p_plane, std::uint32_t q,
                                             const CutPlane& q_plane) {
    const auto load = [&](std::uint32_t polygon, PolygonHeights& out) {
      out.corners.clear();
      for (const std::uint32_t v : polygons_.polygon(polygon).corners)
        out.corners.push_back(polygons_.unit_position(v));
    };
    load(p, first_);
    load(q, second_);
    return crossing_of(first_, p_plane, second_, q_plane, tolerances_.crossing);
  }

  void separate(const IntersectingPair& pair) {
    const CutPlane a_plane = polygons_.plane_of(pair.a);
    const CutPlane b_plane = polygons_.plane_of(pair.b);
    for (std::size_t i = 0; i < polygons_.pieces(pair.a).size(); ++i) {
      for (std::size_t k = 0; k < polygons_.pieces(pair.b).size(); ++k) {
        const std::uint32_t p = polygons_.pieces(pair.a)[i];
        const std::uint32_t q = polygons_.pieces(pair.b)[k];
        const auto crossing = crossing_of_pieces(p, a_plane, q, b_plane);
        if (!crossing) continue;
        if (crossing->chords[0].length() <= crossing->chords[1].length()) {
          polygons_.cut(p, b_plane);
        } else {
          polygons_.cut(q, a_plane);
        }
      }
    }
  }

  bool still_crossing(const IntersectingPair& pair) {
    const CutPlane a_plane = polygons_.plane_of(pair.a);
    const CutPlane b_plane = polygons_.plane_of(pair.b);
    for (const std::uint32_t p : polygons_.pieces(pair.a)) {
      for (const std::uint32_t q : polygons_.pieces(pair.b)) {
        if (crossing_of_pieces(p, a_plane, q, b_plane)) return true;
      }
    }
    return false;
  }

  std::vector<IntersectingPair> pairs_;
  Tolerances tolerances_;
  Progress* progress_;
  PolygonMesh polygons_;
  PolygonHeights first_, second_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 2>> find_intersections(const Mesh& mesh, Progress* progress) {
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (const IntersectingPair& pair : intersecting_pairs(mesh, tolerances_of(mesh).crossing, progress)) {
    pairs.push_back({pair.a, pair.b});
  }
  return pairs;
}

IntersectionSplit split_intersections(const Mesh& mesh, const SplitOptions& options) {
  const Tolerances tolerances = tolerances_of(mesh);
  return IntersectionSplitter(mesh, intersecting_pairs(mesh, tolerances.crossing, options.progress),
                              tolerances, options)
      .run();
}

MeshSplit cut_triangles(const Mesh& mesh, std::span<const TriangleCut> cuts, const SplitOptions& options) {
  const double thickness = tolerances_of(mesh).thickness;
  std::vector<std::uint32_t> members;
  for (const TriangleCut& cut : cuts) members.push_back(cut.triangle);
  PolygonMesh polygons(mesh, members, thickness, options.max_new_triangles);
  std::vector<double> heights;
  for (const TriangleCut& cut : cuts) {
    stop_if_requested(options.progress);
    const CutPlane plane = polygons.plane_of(cut.by);
    const std::size_t before = polygons.pieces(cut.triangle).size();
    for (std::size_t i = 0; i < before; ++i) {
      const std::uint32_t piece = polygons.pieces(cut.triangle)[i];
      polygons.heights_over(plane, piece, heights);
      if (crosses(heights, thickness)) polygons.cut(piece, plane);
    }
  }
  return polygons.finish();
}

MeshSplit compose(const MeshSplit& first, MeshSplit second) {
  const std::size_t inputs = first.mesh.positions.size() - first.new_vertices.size();
  std::vector<SplitVertex> vertices = first.new_vertices;
  for (const SplitVertex& vertex : second.new_vertices) {
    VertexMix mix;
    for (std::size_t i = 0; i < 3; ++i) {
      mix.add(provenance(vertex.sources[i], inputs, first.new_vertices), vertex.weights[i]);
    }
    vertices.push_back(mix.result());
  }
  for (std::uint32_t& source : second.source) source = first.source[source];
  second.new_vertices = std::move(vertices);
  second.complete = first.complete && second.complete;
  return second;
}

}  // namespace pellucid
