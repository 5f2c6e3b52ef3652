// A mesh whose triangles are being cut by planes. In: a mesh and the cuts. Out: a MeshSplit with the pieces
// as triangles. The pieces of a triangle are convex polygons. A new corner on an edge goes into all polygons
// that have this edge, so that no gap opens.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "pellucid/split.h"

namespace pellucid {

// The plane of a triangle of the input, in units of the bounding sphere.
struct CutPlane {
  Vec3d normal;
  double offset = 0;
  [[nodiscard]] double height(const Vec3d& p) const { return dot(normal, p) - offset; }
};

// The positions of a mesh in units of its bounding sphere: centre 0, radius 1.
struct UnitGeometry {
  explicit UnitGeometry(const Mesh& mesh);
  [[nodiscard]] Vec3d unit(const Vec3f& p) const { return (to_double(p) - sphere.center) * scale; }
  [[nodiscard]] CutPlane plane_of(const Triangle& triangle) const;

  BoundingSphere sphere;
  double scale;
  std::vector<Vec3d> positions;  // one per vertex
};

// Sums vertices with weights, and expresses the sum by at most three vertices of the input, which are corners
// of one triangle.
class VertexMix {
 public:
  void add(const SplitVertex& part, double factor);
  [[nodiscard]] SplitVertex result() const;

 private:
  SplitVertex sum_;
  std::size_t count_ = 0;
};
// Returns how a vertex, which may be new, follows from vertices of the input. The first `inputs` vertices are
// those of the input.
SplitVertex provenance(std::uint32_t vertex, std::size_t inputs, std::span<const SplitVertex> new_vertices);

// A piece of a triangle.
struct Polygon {
  std::vector<std::uint32_t> corners;  // vertices, in the winding of the triangle
  std::uint32_t source = 0;            // triangle of the input
};

// Does the cutting. The mesh must outlive this object.
class PolygonMesh {
 public:
  // `may_be_cut` names the triangles for whose pieces cut() will be called. They and their neighbours become
  // polygons. The rest of the mesh stays as it is. `thickness` is kPlaneThickness or larger, in bounding
  // radii.
  PolygonMesh(const Mesh& mesh, std::span<const std::uint32_t> may_be_cut, double thickness,
              std::uint64_t max_new_triangles);

  [[nodiscard]] CutPlane plane_of(std::uint32_t triangle) const {
    return geometry_.plane_of(mesh_.triangles[triangle]);
  }
  [[nodiscard]] const Polygon& polygon(std::uint32_t id) const { return polygons_[id]; }
  // Returns the ids of the polygons of a triangle. The reference is valid until the next cut.
  [[nodiscard]] const std::vector<std::uint32_t>& pieces(std::uint32_t triangle) const {
    return pieces_[slot_of_[triangle]];
  }
  [[nodiscard]] const Vec3d& unit_position(std::uint32_t vertex) const { return geometry_.positions[vertex]; }
  // Writes the signed distances of a polygon's corners from a plane to `heights`.
  void heights_over(const CutPlane& plane, std::uint32_t polygon, std::vector<double>& heights) const;
  // Cuts a polygon that the plane crosses. The front part keeps the id. Returns false and does nothing if
  // there would be too many triangles.
  bool cut(std::uint32_t polygon, const CutPlane& plane);

  [[nodiscard]] bool complete() const { return complete_; }
  // Returns the pieces as triangles. The object must not be used afterwards.
  MeshSplit finish();

 private:
  using EdgeKey = std::uint64_t;
  [[nodiscard]] EdgeKey key_of(std::uint32_t a, std::uint32_t b) const;
  // Returns the number of polygons that have the edge between two vertices.
  [[nodiscard]] std::size_t polygons_at(std::uint32_t a, std::uint32_t b) const;
  void register_edges(std::uint32_t polygon);
  void unregister_edges(std::uint32_t polygon);
  std::uint32_t cut_edge(std::uint32_t a, std::uint32_t b, double height_a, double height_b);
  void insert_corner(std::uint32_t polygon, std::uint32_t a, std::uint32_t b, std::uint32_t vertex,
                     double share);
  std::uint32_t add_vertex(std::uint32_t a, std::uint32_t b, double share);
  void emit(const Polygon& polygon);

  const Mesh& mesh_;
  UnitGeometry geometry_;  // includes the new vertices
  double thickness_;
  std::uint64_t triangles_left_;  // how many more may be added
  bool complete_ = true;
  std::vector<std::uint32_t> point_of_;  // per vertex: the first vertex at its position
  std::vector<std::uint32_t> slot_of_;   // per triangle: into pieces_
  std::vector<std::vector<std::uint32_t>> pieces_;
  std::vector<Polygon> polygons_;
  std::unordered_map<EdgeKey, std::vector<std::uint32_t>> edges_;  // by points -> polygons
  MeshSplit result_;
};

}  // namespace pellucid
