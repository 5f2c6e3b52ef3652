// Which triangles intersect, and their pieces that do not: see pellucid/split.h.
//
// A pair needs one cut only: where A is cut along the plane of B, no piece of A crosses B any more. The one
// is cut that the plane of the other meets along a shorter line: mostly this line lies inside the other, and
// its ends are where the neighbours cross the other too and need no further corner.
#include "pellucid/split.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/parallel.h"
#include "mesh/box_tree.h"
#include "mesh/polygon_mesh.h"

namespace pellucid {
namespace {

struct Tolerances {
  double crossing, thickness;
};

// In bounding radii; float32 coordinates far from the origin resolve less.
Tolerances tolerances_of(const Mesh& mesh) {
  const BoundingSphere sphere = bounding_sphere(mesh);
  if (!(sphere.radius > 0)) return {kLeastCrossing, kPlaneThickness};
  const Vec3d& c = sphere.center;
  const double largest = std::max({std::fabs(c.x), std::fabs(c.y), std::fabs(c.z)}) + sphere.radius;
  const double resolution = 4 * largest * 0x1.0p-24 / sphere.radius;
  return {std::max(kLeastCrossing, resolution), std::max(kPlaneThickness, resolution)};
}

// Where a plane meets the outline of a polygon, along the line of intersection with the polygon's own plane.
struct Chord {
  double begin = std::numeric_limits<double>::infinity();
  double end = -std::numeric_limits<double>::infinity();
  [[nodiscard]] double length() const { return end - begin; }
};

// How two polygons cross.
struct Crossing {
  double length = 0;  // of the line that they share
  Chord chords[2];    // of either polygon
};

// Scratch memory.
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

// Convex polygons in the planes a_plane and b_plane.
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

// All intersecting pairs, by number.
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
    // The longest crossings first: they are the most visible ones, should the limit be met.
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
