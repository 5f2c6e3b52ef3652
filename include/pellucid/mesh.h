// pellucid/mesh.h - indexed triangle meshes: checking, cleaning, welding, simplification and procedural
// samples.
//
// In: positions and triangles from a file or a program. Out: a Mesh that the other modules can rely on, which
// means that its indices are in range and the positions of its triangles are finite.
//
// Functions that take a Mesh accept an empty one. They do not modify it and may be called from several
// threads.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pellucid/base.h"

namespace pellucid {

// ------------------------------------------------------------------------------------------------ meshes

// Three vertex indices. The corners run counter-clockwise when seen from the front.
using Triangle = std::array<std::uint32_t, 3>;

// A triangle mesh in object space. The order of the triangles is the order in which they are drawn. Two
// vertices may have the same position, for example at a seam where normals differ.
struct Mesh {
  std::vector<Vec3f> positions;     // one per vertex
  std::vector<Vec3f> normals;       // one unit vector per vertex, or empty
  std::vector<Triangle> triangles;  // indices < positions.size()
};

// A sphere around the centre of the axis-aligned bounding box that just contains all positions used by
// triangles. Its radius is R, the unit of all distances of viewpoints.
struct BoundingSphere {
  Vec3d center;
  double radius = 0;  // 0 for a mesh without extent
};
// Returns the bounding sphere. Ignores indices out of range and positions that are NaN or infinite. Takes O(V
// + T).
BoundingSphere bounding_sphere(const Mesh& mesh);

// Returns the unit normal of a triangle in double precision, or the zero vector if the triangle has no area.
Vec3d triangle_normal(const Mesh& mesh, std::uint32_t triangle);

// Returns one unit normal per vertex: the sum of the normals of its triangles, weighted by area. Vertices
// with the same position keep separate normals, so that creases are preserved. The normal is zero for a
// vertex that no triangle with area uses.
std::vector<Vec3f> vertex_normals(const Mesh& mesh);

// Returns for every vertex the first vertex whose position has the same bits (-0 equals +0). Takes O(V).
std::vector<std::uint32_t> weld_by_position(std::span<const Vec3f> positions);

// --------------------------------------------------------------------------------- checking and cleaning

// The defects of a mesh, as numbers of triangles. A triangle with several defects counts only for the first
// one in the order of the members.
struct MeshReport {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  std::uint64_t out_of_range = 0;  // with an index >= vertices
  std::uint64_t non_finite = 0;    // with a corner that is NaN or infinite
  std::uint64_t degenerate = 0;    // with two corners at one position, or with no area in double precision
  std::uint64_t duplicate = 0;     // with the positions and the winding of an earlier triangle
  std::uint64_t unreferenced_vertices = 0;
  // Edges between welded positions, of all triangles with three distinct finite corners, including
  // duplicates.
  std::uint64_t boundary_edges = 0;      // with one triangle
  std::uint64_t non_manifold_edges = 0;  // with more than two triangles
  [[nodiscard]] bool closed() const { return boundary_edges == 0 && triangles > 0; }
};
// Counts the defects of a mesh. Takes O(V + T log T).
MeshReport check(const Mesh& mesh);

enum class DuplicatePolicy { keep, drop };

struct CleanOptions {
  // Duplicates are kept by default, because a translucent face that is drawn twice looks different.
  DuplicatePolicy duplicates = DuplicatePolicy::keep;
  // Throw Error{bad_input} instead of removing triangles.
  bool strict = false;
};

struct CleanMesh {
  Mesh mesh;                          // all vertices of the input; the remaining triangles in their order
  std::vector<std::uint32_t> source;  // mesh.triangles[i] is triangle source[i] of the input
  MeshReport report;                  // of the input
};
// Removes triangles that draw nothing: with an index out of range, not finite, or degenerate. Keeps all
// vertices, so that indices remain valid for the caller's vertex buffers. With `strict`, throws
// Error{bad_input} whose message begins with `name` and lists the defects. Takes O(V + T log T).
CleanMesh clean(const Mesh& mesh, const CleanOptions& options, const std::string& name);

// -------------------------------------------------------------------------------------- simplification

// Simplifies a mesh to at most `target_triangles` by quadric edge collapse (Garland, Heckbert, SIGGRAPH 1997;
// meshoptimizer). Cleans the mesh and welds it by position first. Gives up the topology if it prevents the
// last collapses, as in a cloud of small parts. Deterministic. Every vertex of the result is used. The result
// has new normals if the input has normals.
Mesh simplify(const Mesh& mesh, std::uint32_t target_triangles);

// ---------------------------------------------------------------------------------- procedural samples

struct SampleInfo {
  std::string name;         // "goblet", "torus-knot", "nested-shells", "coplanar-stack", "bottles", ...
  std::string description;  // one line
};
// Returns the names of all samples.
std::span<const SampleInfo> sample_list();

// One object of a procedural scene: a mesh and its colour.
struct SamplePart {
  std::string name;
  Mesh mesh;                                    // with normals
  std::array<float, 4> base_color{1, 1, 1, 1};  // linear RGB and opacity
};
// Returns the objects of a sample. `detail` (0.01 to 1000) scales the number of triangles: 1 is the default
// size, 2 gives about twice as many triangles. Deterministic. Throws Error{bad_argument} for an unknown name,
// with a list of the known names, and for a `detail` out of range.
std::vector<SamplePart> make_sample(const std::string& name, double detail = 1.0);

// ------------------------------------------------------------------------------------- texture sampling

// How a texture continues outside of 0..1 in one direction (glTF 2.0, section 3.8.4).
enum class TextureWrap { repeat, mirror, clamp };
enum class TextureFilter { linear, nearest };

// How mip levels are used where several texels fall into one pixel: two levels are blended, the nearest level
// is used, or only the full-size level is used.
enum class TextureLevelsUse { mixed, nearest, none };

// How a texture is sampled.
struct TextureSampling {
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
  TextureFilter magnify = TextureFilter::linear;  // where a texel covers a pixel or more
  TextureFilter minify = TextureFilter::linear;   // elsewhere, within one mip level
  TextureLevelsUse levels = TextureLevelsUse::mixed;

  bool operator==(const TextureSampling&) const = default;
};

}  // namespace pellucid
