// Implements pellucid/subdivide.h: splits the input into oriented manifold pieces and refines these with
// OpenSubdiv, whose results are only defined for manifold input.
//
// The elements of the first step are the corners of triangles. Where two triangles become neighbours across
// an edge, their corners at its ends become one vertex. A corner has two edges and at most one neighbour
// across each, so the corners of a vertex form an open or closed fan of one orientation. An edge without
// neighbours can only be an end of such a fan, so at most two triangles of the result have it, and they use
// it in opposite directions. An edge with neighbours may occur twice in one fan, for example in a leaf
// modelled with front and back that are joined along the rim. Such an edge is cut and then has no neighbours.
#include "pellucid/subdivide.h"

#ifdef PELLUCID_WITH_OPENSUBDIV
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>
#endif

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <utility>

namespace pellucid {
namespace {

// ------------------------------------------------------------------------------------------- manifold pieces

struct ManifoldPieces {
  std::vector<Triangle> triangles;    // without those that have two equal welded vertices
  std::vector<std::uint32_t> source;  // per triangle: the triangle of the input
  std::vector<std::uint32_t> welded;  // per vertex: the welded vertex at its position
};

// The side of a triangle from its k-th corner to the next one. `corner` is 3 * triangle + k.
struct TriangleSide {
  std::uint32_t low = 0, high = 0;  // welded vertices
  std::uint32_t render_low = 0, render_high = 0;
  std::uint32_t corner = 0;
  bool forward = false;  // from low to high
};

std::uint32_t next_corner(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

bool same_edge(const TriangleSide& a, const TriangleSide& b) {
  return a.low == b.low && a.high == b.high;
}
bool same_render_edge(const TriangleSide& a, const TriangleSide& b) {
  return same_edge(a, b) && a.render_low == b.render_low && a.render_high == b.render_high;
}

// Two sides that are the common edge of two neighbours.
struct Link {
  std::uint32_t a = 0, b = 0;  // corners where the sides begin
};

// Sets of corners that become one vertex each (union-find).
class CornerSets {
 public:
  explicit CornerSets(std::size_t corners) : parent_(corners) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  std::uint32_t find(std::uint32_t corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  // Unites the corners at both ends of an edge. The two sides use the edge in opposite directions.
  void unite(const Link& link) {
    unite(link.a, next_corner(link.b));
    unite(next_corner(link.a), link.b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

std::vector<TriangleSide> sorted_sides(std::span<const Triangle> triangles,
                                       std::span<const std::uint32_t> weld,
                                       const std::vector<std::uint32_t>& kept) {
  std::vector<TriangleSide> sides;
  sides.reserve(3 * kept.size());
  for (std::uint32_t i = 0; i < kept.size(); ++i) {
    const Triangle& t = triangles[kept[i]];
    for (std::uint32_t k = 0; k < 3; ++k) {
      std::uint32_t low = t[k];
      std::uint32_t high = t[(k + 1) % 3];
      const bool forward = weld[low] < weld[high];
      if (!forward) std::swap(low, high);
      sides.push_back({weld[low], weld[high], low, high, 3 * i + k, forward});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const TriangleSide& a, const TriangleSide& b) {
    const auto key = [](const TriangleSide& s) {
      return std::array{s.low, s.high, s.render_low, s.render_high, s.corner};
    };
    return key(a) < key(b);
  });
  return sides;
}

// Links the sides at one edge. Sides that share their unwelded vertices come first, because the front and the
// back of a leaf that is modelled twice have the same positions but different vertices.
void link_neighbours(std::span<const TriangleSide> edge, std::vector<Link>& links) {
  std::vector<TriangleSide> unlinked;
  const auto link_pair = [&links](const TriangleSide& a, const TriangleSide& b) {
    if (a.forward == b.forward) return false;
    links.push_back({a.corner, b.corner});
    return true;
  };
  for (std::size_t begin = 0; begin < edge.size();) {
    std::size_t end = begin + 1;
    while (end < edge.size() && same_render_edge(edge[begin], edge[end])) ++end;
    if (end - begin != 2 || !link_pair(edge[begin], edge[begin + 1])) {
      unlinked.insert(unlinked.end(), edge.begin() + static_cast<std::ptrdiff_t>(begin),
                      edge.begin() + static_cast<std::ptrdiff_t>(end));
    }
    begin = end;
  }
  if (unlinked.size() == 2) link_pair(unlinked[0], unlinked[1]);
}

class Splitter {
 public:
  Splitter(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld)
      : triangles_(triangles), weld_(weld) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const std::uint32_t a = weld[triangles[t][0]], b = weld[triangles[t][1]], c = weld[triangles[t][2]];
      if (a != b && b != c && c != a) pieces_.source.push_back(t);
    }
  }

  ManifoldPieces run() {
    const std::vector<TriangleSide> sides = sorted_sides(triangles_, weld_, pieces_.source);
    CornerSets sets(sides.size());
    for_each_edge(sides, [&](std::span<const TriangleSide> edge) {
      std::vector<Link> links;
      link_neighbours(edge, links);
      for (const Link& link : links) sets.unite(link);
    });

    // Cuts only add vertices, so edges that were manifold before stay manifold.
    CornerSets cut_sets(sides.size());
    for_each_edge(sides, [&](std::span<const TriangleSide> edge) {
      if (edge.size() > 2 && is_repeated(edge, sets)) return;
      std::vector<Link> links;
      link_neighbours(edge, links);
      for (const Link& link : links) cut_sets.unite(link);
    });
    number_vertices(cut_sets);
    return std::move(pieces_);
  }

 private:
  template <class Visit>
  static void for_each_edge(std::span<const TriangleSide> sides, const Visit& visit) {
    for (std::size_t begin = 0; begin < sides.size();) {
      std::size_t end = begin + 1;
      while (end < sides.size() && same_edge(sides[begin], sides[end])) ++end;
      visit(sides.subspan(begin, end - begin));
      begin = end;
    }
  }

  // Returns whether more than two of these sides have the same vertices.
  static bool is_repeated(std::span<const TriangleSide> edge, CornerSets& sets) {
    std::vector<std::array<std::uint32_t, 2>> ends;
    for (const TriangleSide& side : edge) {
      std::array end{sets.find(side.corner), sets.find(next_corner(side.corner))};
      if (!side.forward) std::swap(end[0], end[1]);
      ends.push_back(end);
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 2; i < ends.size(); ++i) {
      if (ends[i] == ends[i - 2]) return true;
    }
    return false;
  }

  void number_vertices(CornerSets& sets) {
    // A set is numbered at its first corner, which find() returns.
    std::vector<std::uint32_t> vertex(3 * pieces_.source.size());
    for (std::uint32_t i = 0; i < pieces_.source.size(); ++i) {
      Triangle& triangle = pieces_.triangles.emplace_back();
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t corner = 3 * i + k;
        const std::uint32_t set = sets.find(corner);
        if (set == corner) {
          vertex[corner] = static_cast<std::uint32_t>(pieces_.welded.size());
          pieces_.welded.push_back(weld_[triangles_[pieces_.source[i]][k]]);
        }
        triangle[k] = vertex[set];
      }
    }
  }

  std::span<const Triangle> triangles_;
  std::span<const std::uint32_t> weld_;
  ManifoldPieces pieces_;
};

// Splits a set of triangles into oriented manifold pieces by duplicating vertices. Every edge of the result
// has one triangle, or two that use it in opposite directions, and the triangles at a vertex form one fan.
// The rule for neighbours is that of subdivide_loop(). Takes O(n log n).
ManifoldPieces make_manifold(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld) {
  return Splitter(triangles, weld).run();
}

// ------------------------------------------------------------------------------------------------ refinement

constexpr std::uint64_t kMostTriangles = std::uint64_t{1} << 28U;

#ifdef PELLUCID_WITH_OPENSUBDIV

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

std::unique_ptr<Far::TopologyRefiner> refine(const ManifoldPieces& pieces, std::uint32_t levels) {
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  std::vector<int> corners_of_faces(pieces.triangles.size(), 3);
  std::vector<Far::Index> corners;
  corners.reserve(3 * pieces.triangles.size());
  for (const Triangle& t : pieces.triangles) {
    for (const std::uint32_t v : t) corners.push_back(static_cast<Far::Index>(v));
  }
  Far::TopologyDescriptor topology;
  topology.numVertices = static_cast<int>(pieces.welded.size());
  topology.numFaces = static_cast<int>(pieces.triangles.size());
  topology.numVertsPerFace = corners_of_faces.data();
  topology.vertIndicesPerFace = corners.data();

  Sdc::Options rules;
  rules.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
  std::unique_ptr<Far::TopologyRefiner> refiner(
      Factory::Create(topology, Factory::Options(Sdc::SCHEME_LOOP, rules)));
  if (refiner == nullptr) throw Error(ErrorKind::internal, "subdivision: OpenSubdiv rejected the topology");
  refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(static_cast<int>(levels)));
  return refiner;
}

// Returns the faces of the last level, with the children of each face in a row.
std::vector<Far::Index> faces_by_parent(const Far::TopologyRefiner& refiner, std::uint32_t levels) {
  std::vector<Far::Index> faces(static_cast<std::size_t>(refiner.GetLevel(0).GetNumFaces()));
  for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = static_cast<Far::Index>(f);
  for (std::uint32_t level = 0; level < levels; ++level) {
    std::vector<Far::Index> children;
    children.reserve(4 * faces.size());
    for (const Far::Index face : faces) {
      const Far::ConstIndexArray next = refiner.GetLevel(static_cast<int>(level)).GetFaceChildFaces(face);
      children.insert(children.end(), next.begin(), next.end());
    }
    faces = std::move(children);
  }
  return faces;
}

void copy_triangles(const Far::TopologyRefiner& refiner, const ManifoldPieces& pieces, std::uint32_t levels,
                    Subdivision& result) {
  const std::vector<Far::Index> faces = faces_by_parent(refiner, levels);
  const Far::TopologyLevel& last = refiner.GetLevel(static_cast<int>(levels));
  result.triangles.reserve(faces.size());
  result.source.reserve(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Far::ConstIndexArray v = last.GetFaceVertices(faces[i]);
    result.triangles.push_back({static_cast<std::uint32_t>(v[0]), static_cast<std::uint32_t>(v[1]),
                                static_cast<std::uint32_t>(v[2])});
    result.source.push_back(pieces.source[i >> (2 * levels)]);
  }
}

void copy_stencils(const Far::TopologyRefiner& refiner, const ManifoldPieces& pieces, Subdivision& result) {
  using Factory = Far::StencilTableFactoryReal<double>;
  Factory::Options options;
  options.generateIntermediateLevels = false;
  const std::unique_ptr<const Far::StencilTableReal<double>> table(Factory::Create(refiner, options));
  result.first.reserve(table->GetSizes().size() + 1);
  for (const int size : table->GetSizes()) {
    result.first.push_back(result.first.back() + static_cast<std::uint32_t>(size));
  }
  result.control.reserve(table->GetControlIndices().size());
  for (const Far::Index v : table->GetControlIndices()) {
    result.control.push_back(pieces.welded[static_cast<std::size_t>(v)]);
  }
  result.weights = table->GetWeights();
}

void subdivide_pieces(const ManifoldPieces& pieces, std::uint32_t levels, Subdivision& result) {
  const auto refiner = refine(pieces, levels);
  copy_triangles(*refiner, pieces, levels, result);
  copy_stencils(*refiner, pieces, result);
}

#else

void subdivide_pieces(const ManifoldPieces& /*pieces*/, std::uint32_t /*levels*/, Subdivision& /*result*/) {
  throw Error(ErrorKind::bad_argument,
              "subdivision: this build of pellucid cannot subdivide; rebuild it with PELLUCID_OPENSUBDIV=ON");
}

#endif

void copy_control_mesh(const ManifoldPieces& pieces, Subdivision& result) {
  result.triangles = pieces.triangles;
  result.source = pieces.source;
  result.control = pieces.welded;
  result.weights.assign(pieces.welded.size(), 1.0);
  for (std::uint32_t v = 1; v <= pieces.welded.size(); ++v) result.first.push_back(v);
}

}  // namespace

bool can_subdivide() {
#ifdef PELLUCID_WITH_OPENSUBDIV
  return true;
#else
  return false;
#endif
}

Subdivision subdivide_loop(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld,
                           std::uint32_t levels) {
  if (levels > kMostSubdivisions) {
    throw Error(ErrorKind::bad_argument, "subdivision: " + std::to_string(levels) + " levels; the most is " +
                                             std::to_string(kMostSubdivisions));
  }
  if (triangles.size() > kMostTriangles >> (2 * levels)) {
    throw Error(ErrorKind::bad_argument, "subdivision: " + std::to_string(triangles.size()) +
                                             " triangles become more than " + std::to_string(kMostTriangles) +
                                             " in " + std::to_string(levels) + " levels; use fewer");
  }
  const ManifoldPieces pieces = make_manifold(triangles, weld);
  Subdivision result;
  if (levels == 0 || pieces.triangles.empty()) {
    copy_control_mesh(pieces, result);
    return result;
  }
  subdivide_pieces(pieces, levels, result);
  return result;
}

std::vector<Vec3f> refined_values(const Subdivision& subdivision, std::span<const Vec3f> values) {
  std::vector<Vec3f> refined(subdivision.vertices());
  for (std::size_t v = 0; v < refined.size(); ++v) {
    Vec3d sum;
    for (std::uint32_t i = subdivision.first[v]; i < subdivision.first[v + 1]; ++i) {
      sum += to_double(values[subdivision.control[i]]) * subdivision.weights[i];
    }
    refined[v] = to_float(sum);
  }
  return refined;
}

Mesh subdivide(const Mesh& mesh, std::uint32_t levels) {
  Subdivision subdivision = subdivide_loop(mesh.triangles, weld_by_position(mesh.positions), levels);
  Mesh refined;
  refined.positions = refined_values(subdivision, mesh.positions);
  refined.triangles = std::move(subdivision.triangles);
  if (!mesh.normals.empty()) refined.normals = vertex_normals(refined);
  return refined;
}

}  // namespace pellucid
