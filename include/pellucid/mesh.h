// pellucid/mesh.h - module `mesh`: indexed triangle meshes; check, clean, weld, simplify, sample.
//
// In: positions and triangles from a reader or a program. Out: a Mesh that the other modules may trust
// (indices in range, positions finite). Simplification is by meshoptimizer.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pellucid/base.h"

namespace pellucid {

// Three vertex indices, counter-clockwise seen from the front.
using Triangle = std::array<std::uint32_t, 3>;

// Vertices are render vertices: two of them may share a position (seams). Triangle order is drawing order.
struct Mesh {
  std::vector<Vec3f> positions;     // one per vertex
  std::vector<Vec3f> normals;       // one per vertex, unit length; or empty
  std::vector<Triangle> triangles;  // indices < positions.size()
};

// Ball round the centre of the axis-aligned bounding box, just large enough for all positions that a
// triangle uses (indices out of range and NaN or infinite positions are ignored). Every distance in pellucid
// is in units of this radius, R.
struct BoundingSphere {
  Vec3d center;
  double radius = 0;  // 0 for a mesh without extent
};
BoundingSphere bounding_sphere(const Mesh& mesh);

// What is wrong with a mesh; counts are of triangles. A triangle counts once, under the first that fits.
struct MeshReport {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  std::uint64_t out_of_range = 0;  // an index >= vertices
  std::uint64_t non_finite = 0;    // a corner is NaN or infinite
  std::uint64_t degenerate = 0;    // two equal corners (by position), or no area in double precision
  std::uint64_t duplicate = 0;     // same three positions, same winding, as an earlier triangle
  std::uint64_t unreferenced_vertices = 0;
  // Edges with positions welded, over the triangles with three distinct finite corners (duplicates included):
  std::uint64_t boundary_edges = 0;      // with one triangle
  std::uint64_t non_manifold_edges = 0;  // with more than two triangles
  [[nodiscard]] bool closed() const { return boundary_edges == 0 && triangles > 0; }
};
MeshReport check(const Mesh& mesh);

enum class DuplicatePolicy { keep, drop };

struct CleanOptions {
  // Exact duplicates are kept by default: drawing a translucent face twice is what the file shows.
  DuplicatePolicy duplicates = DuplicatePolicy::keep;
  // Throw Error{bad_input} instead of dropping anything.
  bool strict = false;
};

struct CleanMesh {
  Mesh mesh;  // same vertices (non-finite ones unreferenced), triangles in input order
  std::vector<std::uint32_t> source;  // mesh.triangles[i] was triangle source[i] of the input
  MeshReport report;                  // of the input
};
// Drop triangles that draw nothing: out of range, non-finite, degenerate. The vertices stay as they are,
// so indices remain valid for the caller's vertex buffers. `name` begins the message of a strict refusal.
CleanMesh clean(const Mesh& mesh, const CleanOptions& options, const std::string& name);

// Vertex -> first vertex with bit-equal position (-0 equals +0). O(V).
std::vector<std::uint32_t> weld_by_position(std::span<const Vec3f> positions);

// Area-weighted unit normals, one per vertex index: vertices that share a position (seams) keep their own, so
// that creases stay. Zero where no triangle with area touches the vertex.
std::vector<Vec3f> vertex_normals(const Mesh& mesh);

// Unit normal of a triangle in double precision; zero vector when it has no area.
Vec3d triangle_normal(const Mesh& mesh, std::uint32_t triangle);

// Quadric edge-collapse simplification to at most `target_triangles` (meshoptimizer; cleaned and welded by
// position first; where topology forbids the last collapses, as in a cloud of small parts, it is given up).
// Deterministic. The result is compacted: every vertex is used; it has normals (recomputed) if the input has.
Mesh simplify(const Mesh& mesh, std::uint32_t target_triangles);

// ---------------------------------------------------------------------------------- procedural samples

struct SampleInfo {
  std::string name;         // "goblet", "torus-knot", "nested-shells", "coplanar-stack", "bottles", ...
  std::string description;  // one line
};
std::span<const SampleInfo> sample_list();

// One object of a procedural scene: a mesh and how it looks.
struct SamplePart {
  std::string name;
  Mesh mesh;                                    // with normals
  std::array<float, 4> base_color{1, 1, 1, 1};  // linear RGB and alpha
};
// `detail` scales the triangle count (1: the default size, 2: about twice as many triangles), 0.01 to 1000.
// Throws Error{bad_argument} for an unknown name, listing the known ones, and for a detail outside that
// range.
std::vector<SamplePart> make_sample(const std::string& name, double detail = 1.0);

}  // namespace pellucid
