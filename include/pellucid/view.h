// pellucid/view.h - module `view`: where the camera may be.
//
// A view partition cuts the sphere of view directions into cells and gives every cell its sample
// directions (In-Depth Buffers, Han et al. 2018, section 2.1):
//   P[n]    discrete viewpoints: the 10*4^n + 2 vertices of an icosahedron after n midpoint subdivisions;
//           a cell is a vertex, its region the directions nearest to it.
//   S[n,m]  sampled view triangles: the 20*4^n triangles of level n; samples are the vertices of m further
//           subdivisions, those on a border belong to every neighbour. S[2,2]: 320 cells, 15 samples each,
//           2562 distinct directions.
//   T[n]    view triangles: the same cells, but ALL viewpoints of a cell count, at all distances between the
//           least and the greatest that are sampled.
//   R[n]    view regions: all viewpoints of a cell from the least valid distance to infinity.
// T and R are sampled as S[n,2]: the samples give the weights of their edges.
//
// The numbering of base faces and children is that of pellucid/runtime/select.h, and part of the file
// format (docs/file-format.md).
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "pellucid/base.h"

namespace pellucid {

enum class PartitionKind { viewpoints, sampled_triangles, view_triangles, view_regions };
constexpr std::uint32_t kSolidSampleLevel = 2;  // m of T[n] and R[n]

constexpr std::uint32_t kMaxPartitionLevel = 5;  // n
struct PartitionSpec {
  PartitionKind kind = PartitionKind::sampled_triangles;
  std::uint32_t level = 2;         // n, 0..5
  std::uint32_t sample_level = 2;  // m, 0..4; unused by viewpoints, kSolidSampleLevel for T and R
  bool operator==(const PartitionSpec&) const = default;
};
// Are the cells triangles of the icosphere (S, T, R), or its vertices (P)?
constexpr bool has_triangle_cells(const PartitionSpec& spec) {
  return spec.kind != PartitionKind::viewpoints;
}
// Does every viewpoint of a cell count (T, R), or only its samples?
constexpr bool is_continuous(const PartitionSpec& spec) {
  return spec.kind == PartitionKind::view_triangles || spec.kind == PartitionKind::view_regions;
}
// "S2,2", "P4", "T3", "R2" (also "S[2,2]", "T[3]", lower case). Throws Error{bad_argument} saying what is
// allowed.
PartitionSpec parse_partition(const std::string& text);
std::string to_string(const PartitionSpec& spec);  // "S2,2"

// Triangle mesh of the unit sphere: an icosahedron after `level` midpoint subdivisions.
struct Icosphere {
  std::vector<Vec3d> vertices;  // unit vectors, 10*4^level + 2
  std::vector<std::array<std::uint32_t, 3>>
      triangles;  // 20*4^level, counter-clockwise from outside;
                  // children of triangle f: 4f+0..2 at its corners, 4f+3 in the middle
};
// Vertices of a level keep their ids in finer levels; new ones are numbered in the order in which the
// triangles of the coarser level meet them (midpoint opposite to corner 0, 1, 2). Throws Error{bad_argument}
// above level 9.
Icosphere make_icosphere(std::uint32_t level);

struct ViewPartition {
  PartitionSpec spec;
  std::vector<Vec3d> samples;  // distinct unit directions, centre of the mesh -> camera

  // Cell c's samples are samples[cell_samples[i]], i in cell_offsets[c] .. cell_offsets[c + 1] - 1.
  std::vector<std::uint32_t> cell_offsets;
  std::vector<std::uint32_t> cell_samples;

  // Cells that share an edge of the icosphere (S, T, R) or are joined by one (P): CSR like the samples,
  // sorted.
  std::vector<std::uint32_t> neighbor_offsets;
  std::vector<std::uint32_t> neighbors;

  // Corners of triangular cells: three unit directions per cell. Empty for P.
  std::vector<std::array<Vec3d, 3>> corners;
  // P cells: cosine of an angle about the cell's direction that contains its whole region. Else empty.
  std::vector<double> cap_cosines;
  // P cells: the cell of every corner of the icosphere's triangles, index 3 * triangle + corner: what
  // pellucid_find_corner of select.h answers. Else empty: it answers triangular cells directly.
  std::vector<std::uint32_t> corner_cells;

  [[nodiscard]] std::uint32_t cell_count() const {
    return static_cast<std::uint32_t>(cell_offsets.empty() ? 0 : cell_offsets.size() - 1);
  }
  [[nodiscard]] std::span<const std::uint32_t> samples_of(std::uint32_t cell) const {
    return {cell_samples.data() + cell_offsets[cell], cell_offsets[cell + 1] - cell_offsets[cell]};
  }
  [[nodiscard]] std::span<const std::uint32_t> neighbors_of(std::uint32_t cell) const {
    return {neighbors.data() + neighbor_offsets[cell], neighbor_offsets[cell + 1] - neighbor_offsets[cell]};
  }
};
// Cells are numbered as in select.h (vertex ids of make_icosphere(level) for P, else triangle ids).
ViewPartition make_partition(const PartitionSpec& spec);

// Direction at the middle of a cell (unit).
Vec3d cell_direction(const ViewPartition& partition, std::uint32_t cell);

// Largest dot(normal, d) over all directions d of the cell's region: exact for spherical triangles, an
// upper bound for P cells. It makes the facing test of a cell conservative.
double max_cosine(const ViewPartition& partition, std::uint32_t cell, const Vec3d& normal);

// Range of camera distances for which orders are made and declared valid, in bounding radii.
constexpr double kInfiniteDistance = std::numeric_limits<double>::infinity();

// A camera position relative to a bounding sphere. distance = infinity: orthographic along -direction.
struct Viewpoint {
  Vec3d direction;      // unit, centre -> camera
  double distance = 3;  // in bounding radii
};

// Can the front of a plane (unit normal, signed offset = dot(normal, point - centre), object units) be seen
// from the cell at some distance of [min_distance, max_distance] * radius? Conservative: never false when
// it can be seen.
bool front_visible(const ViewPartition& partition, std::uint32_t cell, const Vec3d& normal, double offset,
                   double radius, double min_distance, double max_distance);

// The cell whose region contains `direction`, by the descent of select.h. O(level).
std::uint32_t find_cell(const ViewPartition& partition, const Vec3d& direction);

// The cell whose region contains `direction` (brute-force reference for select.h; ties: lowest id). O(cells).
std::uint32_t find_cell_brute_force(const ViewPartition& partition, const Vec3d& direction);

// `count` viewpoints, directions uniform on the sphere, distances uniform in [min_distance, max_distance].
// Throws Error{bad_argument} unless 0 < min_distance <= max_distance; infinity only where both are.
std::vector<Viewpoint> random_viewpoints(std::uint32_t count, double min_distance, double max_distance,
                                         std::uint64_t seed);

}  // namespace pellucid
