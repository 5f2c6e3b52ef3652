// pellucid/view.h - view partitions: which camera directions share a draw order.
//
// In: the name of a partition, such as S[2,2]. Out: its cells, their sample directions and neighbours, and
// functions that find the cell of a direction and test which triangles can face the cameras of a cell.
//
// Based on: Han, Chen, Nehab, Sander, "In-Depth Buffers", PACMCGIT 1(1), 2018, section 2.1. A view partition
// divides the sphere of view directions into cells and gives every cell sample directions:
//
//   P[n]    Discrete viewpoints. The cells are the 10*4^n + 2 vertices of an icosahedron after n midpoint
//           subdivisions. A cell contains the directions nearest to its vertex, which is its only sample.
//   S[n,m]  Sampled view triangles. The cells are the 20*4^n triangles of level n. The samples of a cell
//           are the vertices of its triangle after m more subdivisions; those on a border belong to all
//           adjacent cells. S[2,2] has 320 cells with 15 samples each and 2562 distinct directions.
//   T[n]    View triangles. The cells are those of S, but an order must be right for ALL viewpoints of a
//           cell, at all distances between the nearest and the farthest that are sampled.
//   R[n]    View regions. An order must be right for all viewpoints of a cell, from the nearest valid
//           distance to infinity.
//
// T and R have the samples of S[n,2], which determine the weights of their occlusion edges.
//
// Directions point from the centre of the bounding sphere to the camera, in object space. Base faces and
// children are numbered as in pellucid/runtime/select.h. The numbering is part of the file format
// (docs/file-format.md).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "pellucid/base.h"

namespace pellucid {

// -------------------------------------------------------------------------------------------- partitions

// P, S, T and R.
enum class PartitionKind { viewpoints, sampled_triangles, view_triangles, view_regions };
// The sample level m of T[n] and R[n].
constexpr std::uint32_t kSolidSampleLevel = 2;
// The largest level n.
constexpr std::uint32_t kMaxPartitionLevel = 5;

// Names a partition.
struct PartitionSpec {
  PartitionKind kind = PartitionKind::sampled_triangles;
  std::uint32_t level = 2;         // n, 0..5
  std::uint32_t sample_level = 2;  // m, 0..4; unused for P, and kSolidSampleLevel for T and R
  bool operator==(const PartitionSpec&) const = default;
};
// Returns true if the cells are triangles of the icosphere (S, T, R), and false if they are its vertices (P).
constexpr bool has_triangle_cells(const PartitionSpec& spec) {
  return spec.kind != PartitionKind::viewpoints;
}
// Returns true if an order must be right for every viewpoint of a cell (T, R), and false if only for its
// samples (P, S).
constexpr bool is_continuous(const PartitionSpec& spec) {
  return spec.kind == PartitionKind::view_triangles || spec.kind == PartitionKind::view_regions;
}
// Parses a name such as "S2,2", "P4", "T3" or "R2". Also accepts "S[2,2]", "T[3]" and lower case. Throws
// Error{bad_argument} whose message lists the accepted forms.
PartitionSpec parse_partition(const std::string& text);
// Returns the name of a partition in the form "S2,2".
std::string to_string(const PartitionSpec& spec);

// A triangle mesh of the unit sphere: an icosahedron after `level` midpoint subdivisions.
struct Icosphere {
  std::vector<Vec3d> vertices;  // 10*4^level + 2 unit vectors
  // 20*4^level triangles, counter-clockwise seen from outside. The children of triangle f in the next level
  // are 4f+0, 4f+1 and 4f+2 at its corners and 4f+3 in the middle.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
// Makes an icosphere. Vertices of a level keep their ids in finer levels. New vertices are numbered in the
// order in which the triangles of the coarser level contain them, opposite to corners 0, 1 and 2. Throws
// Error{bad_argument} above level 9.
Icosphere make_icosphere(std::uint32_t level);

// The cells of a partition. Lists per cell are stored in compressed rows.
struct ViewPartition {
  PartitionSpec spec;
  std::vector<Vec3d> samples;  // distinct unit directions from the centre of the mesh to the camera

  // The samples of cell c are samples[cell_samples[i]] for i in cell_offsets[c] .. cell_offsets[c + 1] - 1.
  std::vector<std::uint32_t> cell_offsets;
  std::vector<std::uint32_t> cell_samples;

  // The neighbours of every cell, in rows like the samples and sorted. Neighbours share an edge of the
  // icosphere (S, T, R) or are joined by one (P).
  std::vector<std::uint32_t> neighbor_offsets;
  std::vector<std::uint32_t> neighbors;

  // Three unit directions per triangular cell, counter-clockwise seen from outside. Empty for P.
  std::vector<std::array<Vec3d, 3>> corners;
  // P only: the cosine of an angle around the direction of each cell that contains the whole cell.
  std::vector<double> cap_cosines;
  // P only: the cell of every corner of the icosphere's triangles, at index 3 * triangle + corner. This is
  // the index that pellucid_find_corner() of select.h returns.
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
// Makes a partition. Cells are numbered as the vertices (P) or the triangles (S, T, R) of
// make_icosphere(level). Takes O(cells + samples) up to logarithmic factors. Throws Error{bad_argument} if a
// level is out of range.
ViewPartition make_partition(const PartitionSpec& spec);

// Returns the unit direction at the middle of a cell.
Vec3d cell_direction(const ViewPartition& partition, std::uint32_t cell);

// Returns the largest dot(normal, d) over all directions d of a cell. The result is exact for triangular
// cells and an upper bound for P.
double max_cosine(const ViewPartition& partition, std::uint32_t cell, const Vec3d& normal);

// -------------------------------------------------------------------------------------------- viewpoints

// The distance of orthographic cameras.
constexpr double kInfiniteDistance = std::numeric_limits<double>::infinity();

// A camera position relative to a bounding sphere. A camera at infinity is orthographic and looks along
// -direction.
struct Viewpoint {
  Vec3d direction;      // unit vector from the centre to the camera
  double distance = 3;  // in bounding radii
};

// Returns whether the front of a plane can be seen from a viewpoint of the cell at a distance of min_distance
// .. max_distance bounding radii. The plane has a unit normal and contains the points with dot(normal, point
// - centre) = offset. `offset` and `radius` are in object units. The test is conservative: it never returns
// false if the front can be seen.
bool front_visible(const ViewPartition& partition, std::uint32_t cell, const Vec3d& normal, double offset,
                   double radius, double min_distance, double max_distance);

// Returns the cell that contains a direction of any length, by the descent of select.h. Takes O(level).
std::uint32_t find_cell(const ViewPartition& partition, const Vec3d& direction);

// Returns the cell that contains a direction by testing every cell. A direction on a border belongs to the
// cell with the lowest id. Takes O(cells). This is the reference in the tests of select.h.
std::uint32_t find_cell_brute_force(const ViewPartition& partition, const Vec3d& direction);

// Returns `count` random viewpoints with directions uniform on the sphere and distances uniform in
// [min_distance, max_distance]. Throws Error{bad_argument} unless 0 < min_distance <= max_distance. Either
// both distances are infinite or none.
std::vector<Viewpoint> random_viewpoints(std::uint32_t count, double min_distance, double max_distance,
                                         std::uint64_t seed);

}  // namespace pellucid
