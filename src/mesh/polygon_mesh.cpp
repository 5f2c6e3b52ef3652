// A mesh while its triangles are being cut: see polygon_mesh.h.
#include "mesh/polygon_mesh.h"

#include <algorithm>
#include <limits>

#include "mesh/triangulate.h"

namespace pellucid {
namespace {

constexpr std::uint32_t kNoSlot = std::numeric_limits<std::uint32_t>::max();

}  // namespace

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

  // A neighbour shares an edge, that is two points.
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

  // Every polygon at an edge that is cut gets one corner, that is one triangle, more.
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

// The new vertex on the edge a - b of the polygon that is being cut, and its likes on the other polygons
// there.
std::uint32_t PolygonMesh::cut_edge(std::uint32_t a, std::uint32_t b, double height_a, double height_b) {
  // From the lower point to the higher one, whoever asks.
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

// Put `vertex`, made for the edge a - b, between the corners of a polygon that stand at the same points. On
// the other side of a seam these are other vertices, and so is the one between them.
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
    // Corners on one line, of a sliver thinner than float32 resolves: nothing is drawn there.
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
