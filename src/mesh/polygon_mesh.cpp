// Implements polygon_mesh.h and cut_convex() of pellucid/split.h: cuts polygons by planes and turns the
// pieces into triangles.
#include "mesh/polygon_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace pellucid {
namespace {

// ----------------------------------------------------------------------------------------- cutting a polygon

enum class Side : signed char { back = -1, in_plane = 0, front = 1 };

Side side_of(double height, double thickness) {
  if (height > thickness) return Side::front;
  return height < -thickness ? Side::back : Side::in_plane;
}

// Assigns corners in the plane to one side, except for one corner at each change of sides. Otherwise a run of
// such corners would belong to both parts. `sides` has corners on both sides.
void settle_corners_in_plane(std::span<const double> heights, std::vector<Side>& sides) {
  const std::size_t count = sides.size();
  std::size_t first = 0;
  while (sides[first] == Side::in_plane) ++first;
  for (std::size_t begin = first; begin < first + count;) {
    std::size_t end = begin + 1;
    while (sides[end % count] == Side::in_plane) ++end;
    const Side before = sides[begin % count];
    const Side after = sides[end % count];
    std::size_t nearest = begin + 1;
    for (std::size_t i = begin + 1; i < end; ++i) {
      if (std::fabs(heights[i % count]) < std::fabs(heights[nearest % count])) nearest = i;
    }
    for (std::size_t i = begin + 1; i < end; ++i) {
      if (before == after || i != nearest) sides[i % count] = i < nearest ? before : after;
    }
    begin = end;
  }
}

// ----------------------------------------------------------------------------------- triangulating a polygon

// Polygons with more corners are halved before dynamic programming, which takes O(n^3).
constexpr std::size_t kMostByProgram = 32;

using Ids = std::vector<std::uint32_t>;

class Triangulation {
 public:
  Triangulation(std::span<const Vec3d> corners, const Vec3d& normal,
                std::vector<std::array<std::uint32_t, 3>>& triangles)
      : corners_(corners), normal_(normal), triangles_(triangles) {}

  void add(const Ids& polygon) {
    if (polygon.size() > kMostByProgram) {
      halve(polygon);
    } else {
      add_best(polygon);
    }
  }

 private:
  // Returns the height over the longest side, negative for a triangle of the wrong winding.
  [[nodiscard]] double thickness(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vec3d ab = corners_[b] - corners_[a];
    const Vec3d ac = corners_[c] - corners_[a];
    const Vec3d bc = corners_[c] - corners_[b];
    const double longest = std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
    return longest > 0 ? dot(cross(ab, ac), normal_) / std::sqrt(longest) : 0;
  }

  // Finds the best triangulation by dynamic programming over the chains of corners first .. last, which are
  // closed by the diagonal between first and last.
  void add_best(const Ids& polygon) {
    const std::size_t n = polygon.size();
    std::vector<double> best(n * n, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> apex(n * n, 0);
    for (std::size_t span = 2; span < n; ++span) {
      for (std::size_t first = 0; first + span < n; ++first) {
        const std::size_t last = first + span;
        double& value = best[first * n + last];
        value = -std::numeric_limits<double>::infinity();
        for (std::size_t k = first + 1; k < last; ++k) {
          const double worst = std::min({thickness(polygon[first], polygon[k], polygon[last]),
                                         best[first * n + k], best[k * n + last]});
          if (worst > value) {
            value = worst;
            apex[first * n + last] = k;
          }
        }
      }
    }
    std::vector<std::pair<std::size_t, std::size_t>> chains{{0, n - 1}};
    while (!chains.empty()) {
      const auto [first, last] = chains.back();
      chains.pop_back();
      if (last - first < 2) continue;
      const std::size_t k = apex[first * n + last];
      triangles_.push_back({polygon[first], polygon[k], polygon[last]});
      chains.emplace_back(k, last);
      chains.emplace_back(first, k);
    }
  }

  // Cuts the polygon along the diagonal between opposite corners whose narrower side is widest.
  void halve(const Ids& polygon) {
    const std::size_t n = polygon.size();
    const std::size_t half = n / 2;
    std::size_t best = 0;
    double best_width = -1;
    for (std::size_t i = 0; i < n - half; ++i) {
      double widths[2] = {0, 0};
      for (std::size_t k = 0; k < n; ++k) {
        const double width = std::fabs(thickness(polygon[i], polygon[i + half], polygon[k]));
        double& side = widths[k > i && k < i + half ? 0 : 1];
        side = std::max(side, width);
      }
      if (std::min(widths[0], widths[1]) > best_width) {
        best_width = std::min(widths[0], widths[1]);
        best = i;
      }
    }
    const auto at = [&](std::size_t i) { return polygon.begin() + static_cast<std::ptrdiff_t>(i); };
    Ids rest(polygon.begin(), at(best + 1));
    rest.insert(rest.end(), at(best + half), polygon.end());
    add({at(best), at(best + half + 1)});
    add(rest);
  }

  std::span<const Vec3d> corners_;
  Vec3d normal_;
  std::vector<std::array<std::uint32_t, 3>>& triangles_;
};

// Appends the triangles of a convex polygon, as indices into `corners`. Corners may be collinear. The result
// is a triangulation whose thinnest triangle is as thick as possible, so that no triangle has zero area if
// this can be avoided. Takes O(n^3) for at most 32 corners and O(n^2) above.
void triangulate_convex(std::span<const Vec3d> corners, const Vec3d& normal,
                        std::vector<std::array<std::uint32_t, 3>>& triangles) {
  Ids polygon(corners.size());
  for (std::uint32_t i = 0; i < polygon.size(); ++i) polygon[i] = i;
  Triangulation(corners, normal, triangles).add(polygon);
}

constexpr std::uint32_t kNoSlot = std::numeric_limits<std::uint32_t>::max();

}  // namespace

bool crosses(std::span<const double> heights, double thickness) {
  const auto [lowest, highest] = std::minmax_element(heights.begin(), heights.end());
  return *lowest<-thickness&& * highest> thickness;
}

void cut_convex(std::span<const std::uint32_t> corners, std::span<const double> heights, double thickness,
                const CutEdge& cut_edge, std::vector<std::uint32_t>& front,
                std::vector<std::uint32_t>& back) {
  std::vector<Side> sides;
  sides.reserve(corners.size());
  for (const double height : heights) sides.push_back(side_of(height, thickness));
  settle_corners_in_plane(heights, sides);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::size_t next = (i + 1) % corners.size();
    if (sides[i] != Side::back) front.push_back(corners[i]);
    if (sides[i] != Side::front) back.push_back(corners[i]);
    if (sides[i] == sides[next] || sides[i] == Side::in_plane || sides[next] == Side::in_plane) continue;
    const std::uint32_t cut = cut_edge(corners[i], corners[next], heights[i], heights[next]);
    front.push_back(cut);
    back.push_back(cut);
  }
}

// -------------------------------------------------------------------------------------------------- the mesh

UnitGeometry::UnitGeometry(const Mesh& mesh)
    : sphere(bounding_sphere(mesh)), scale(sphere.radius > 0 ? 1 / sphere.radius : 1) {
  positions.reserve(mesh.positions.size());
  for (const Vec3f& p : mesh.positions) positions.push_back(unit(p));
}

CutPlane UnitGeometry::plane_of(const Triangle& t) const {
  const Vec3d& a = positions[t[0]];
  const Vec3d normal = normalized(cross(positions[t[1]] - a, positions[t[2]] - a));
  return {normal, dot(normal, a + positions[t[1]] + positions[t[2]]) / 3};
}

void VertexMix::add(const SplitVertex& part, double factor) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (part.weights[i] == 0) continue;
    const auto end = sum_.sources.begin() + static_cast<std::ptrdiff_t>(count_);
    const auto found = std::find(sum_.sources.begin(), end, part.sources[i]);
    if (found == end) sum_.sources[count_++] = part.sources[i];
    sum_.weights[static_cast<std::size_t>(found - sum_.sources.begin())] += factor * part.weights[i];
  }
}

SplitVertex VertexMix::result() const {
  SplitVertex full = sum_;
  for (std::size_t i = count_; i < 3; ++i) full.sources[i] = full.sources[0];
  return full;
}

SplitVertex provenance(std::uint32_t vertex, std::size_t inputs, std::span<const SplitVertex> new_vertices) {
  if (vertex >= inputs) return new_vertices[vertex - inputs];
  return {{vertex, vertex, vertex}, {1, 0, 0}};
}

PolygonMesh::PolygonMesh(const Mesh& mesh, std::span<const std::uint32_t> may_be_cut, double thickness,
                         std::uint64_t max_new_triangles)
    : mesh_(mesh),
      geometry_(mesh),
      thickness_(thickness),
      triangles_left_(max_new_triangles),
      point_of_(weld_by_position(mesh.positions)),
      slot_of_(mesh.triangles.size(), kNoSlot) {
  result_.mesh.positions = mesh.positions;

  // A neighbour shares an edge, and therefore two points.
  std::vector<char> touched(mesh.positions.size(), 0);
  for (const std::uint32_t triangle : may_be_cut) {
    for (const std::uint32_t v : mesh.triangles[triangle]) touched[point_of_[v]] = 1;
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    if (touched[point_of_[corners[0]]] + touched[point_of_[corners[1]]] + touched[point_of_[corners[2]]] <
        2) {
      continue;
    }
    slot_of_[t] = static_cast<std::uint32_t>(pieces_.size());
    pieces_.push_back({static_cast<std::uint32_t>(polygons_.size())});
    polygons_.push_back({{corners.begin(), corners.end()}, t});
    register_edges(static_cast<std::uint32_t>(polygons_.size() - 1));
  }
}

void PolygonMesh::heights_over(const CutPlane& plane, std::uint32_t polygon,
                               std::vector<double>& heights) const {
  heights.clear();
  for (const std::uint32_t corner : polygons_[polygon].corners)
    heights.push_back(plane.height(unit_position(corner)));
}

PolygonMesh::EdgeKey PolygonMesh::key_of(std::uint32_t a, std::uint32_t b) const {
  const auto [low, high] = std::minmax(point_of_[a], point_of_[b]);
  return std::uint64_t{low} << 32U | high;
}

std::size_t PolygonMesh::polygons_at(std::uint32_t a, std::uint32_t b) const {
  const auto found = edges_.find(key_of(a, b));
  return found == edges_.end() ? 0 : found->second.size();
}

void PolygonMesh::register_edges(std::uint32_t polygon) {
  const std::vector<std::uint32_t>& corners = polygons_[polygon].corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    edges_[key_of(corners[i], corners[(i + 1) % corners.size()])].push_back(polygon);
  }
}

void PolygonMesh::unregister_edges(std::uint32_t polygon) {
  const std::vector<std::uint32_t>& corners = polygons_[polygon].corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    std::erase(edges_[key_of(corners[i], corners[(i + 1) % corners.size()])], polygon);
  }
}

bool PolygonMesh::cut(std::uint32_t polygon, const CutPlane& plane) {
  std::vector<double> heights;
  heights_over(plane, polygon, heights);
  const std::vector<std::uint32_t> corners = polygons_[polygon].corners;

  // Every polygon at an edge that is cut gets one more corner, and therefore one more triangle.
  std::uint64_t added = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::size_t next = (i + 1) % corners.size();
    const auto [low, high] = std::minmax(heights[i], heights[next]);
    if (low < -thickness_ && high > thickness_) added += polygons_at(corners[i], corners[next]);
  }
  if (added > triangles_left_) {
    complete_ = false;
    return false;
  }
  triangles_left_ -= added;

  unregister_edges(polygon);
  Polygon front{{}, polygons_[polygon].source};
  Polygon back{{}, polygons_[polygon].source};
  cut_convex(
      corners, heights, thickness_,
      [&](std::uint32_t a, std::uint32_t b, double height_a, double height_b) {
        return cut_edge(a, b, height_a, height_b);
      },
      front.corners, back.corners);
  const auto fresh = static_cast<std::uint32_t>(polygons_.size());
  pieces_[slot_of_[back.source]].push_back(fresh);
  polygons_[polygon] = std::move(front);
  polygons_.push_back(std::move(back));
  register_edges(polygon);
  register_edges(fresh);
  return true;
}

// Adds the new vertex on the edge a - b to the polygon that is being cut and to all other polygons at this
// edge. Returns the vertex.
std::uint32_t PolygonMesh::cut_edge(std::uint32_t a, std::uint32_t b, double height_a, double height_b) {
  // Always go from the lower point to the higher one, so that the position does not depend on the polygon.
  if (point_of_[a] > point_of_[b]) {
    std::swap(a, b);
    std::swap(height_a, height_b);
  }
  const double share = height_a / (height_a - height_b);
  const std::uint32_t vertex = add_vertex(a, b, share);
  const auto at = edges_.find(key_of(a, b));
  if (at == edges_.end()) return vertex;
  const std::vector<std::uint32_t> others = std::move(at->second);
  edges_.erase(at);
  for (const std::uint32_t other : others) insert_corner(other, a, b, vertex, share);
  return vertex;
}

// Inserts `vertex`, which was made for the edge a - b, between the corners of a polygon at the same two
// points. On the other side of a seam the corners are different vertices, and so the inserted vertex is a new
// one, too.
void PolygonMesh::insert_corner(std::uint32_t polygon, std::uint32_t a, std::uint32_t b, std::uint32_t vertex,
                                double share) {
  std::vector<std::uint32_t>& corners = polygons_[polygon].corners;
  const std::uint32_t low = point_of_[a];
  const std::uint32_t high = point_of_[b];
  for (std::size_t i = 0; i < corners.size(); ++i) {
    std::uint32_t c = corners[i];
    std::uint32_t d = corners[(i + 1) % corners.size()];
    if (point_of_[c] > point_of_[d]) std::swap(c, d);
    if (point_of_[c] != low || point_of_[d] != high) continue;
    std::uint32_t inserted = vertex;
    if (c != a || d != b) {
      inserted = add_vertex(c, d, share);
      point_of_[inserted] = vertex;
      geometry_.positions[inserted] = geometry_.positions[vertex];
      result_.mesh.positions[inserted] = result_.mesh.positions[vertex];
    }
    corners.insert(corners.begin() + static_cast<std::ptrdiff_t>(i) + 1, inserted);
    edges_[key_of(a, vertex)].push_back(polygon);
    edges_[key_of(vertex, b)].push_back(polygon);
    return;
  }
}

std::uint32_t PolygonMesh::add_vertex(std::uint32_t a, std::uint32_t b, double share) {
  const auto vertex = static_cast<std::uint32_t>(geometry_.positions.size());
  VertexMix mix;
  mix.add(provenance(a, mesh_.positions.size(), result_.new_vertices), 1 - share);
  mix.add(provenance(b, mesh_.positions.size(), result_.new_vertices), share);
  const SplitVertex from = mix.result();
  Vec3d position{};
  for (std::size_t i = 0; i < 3; ++i)
    position += to_double(mesh_.positions[from.sources[i]]) * from.weights[i];
  result_.new_vertices.push_back(from);
  result_.mesh.positions.push_back(to_float(position));
  geometry_.positions.push_back(geometry_.unit(result_.mesh.positions.back()));
  point_of_.push_back(vertex);
  return vertex;
}

void PolygonMesh::emit(const Polygon& polygon) {
  std::vector<Vec3d> corners;
  for (const std::uint32_t v : polygon.corners) corners.push_back(unit_position(v));
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangulate_convex(corners, plane_of(polygon.source).normal, triangles);
  for (const auto& t : triangles) {
    const Triangle triangle{polygon.corners[t[0]], polygon.corners[t[1]], polygon.corners[t[2]]};
    // Omit triangles with collinear corners, from slivers thinner than float32 resolves: they draw nothing.
    if (cross(corners[t[1]] - corners[t[0]], corners[t[2]] - corners[t[0]]) == Vec3d{}) continue;
    result_.mesh.triangles.push_back(triangle);
    result_.source.push_back(polygon.source);
  }
}

MeshSplit PolygonMesh::finish() {
  result_.complete = complete_;
  for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (slot_of_[t] == kNoSlot || (pieces(t).size() == 1 && polygons_[pieces(t)[0]].corners.size() == 3)) {
      result_.mesh.triangles.push_back(mesh_.triangles[t]);
      result_.source.push_back(t);
      continue;
    }
    for (const std::uint32_t piece : pieces(t)) emit(polygons_[piece]);
  }
  if (!mesh_.normals.empty()) {
    result_.mesh.normals = mesh_.normals;
    for (const SplitVertex& vertex : result_.new_vertices) {
      Vec3d normal{};
      for (std::size_t i = 0; i < 3; ++i)
        normal += to_double(mesh_.normals[vertex.sources[i]]) * vertex.weights[i];
      result_.mesh.normals.push_back(to_float(normalized(normal)));
    }
  }
  return std::move(result_);
}

}  // namespace pellucid
