// Implements pellucid/mesh.h, except for simplification and the procedural samples: bounds and normals,
// welding, checking and cleaning.
//
// Sums and products are in double precision, in which the squares of the largest float32 numbers (1e38) and
// of the smallest (1e-45) are finite and not zero.
#include "pellucid/mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"

namespace pellucid {
namespace {

// --------------------------------------------------------------------------------- questions about triangles

bool is_finite(const Vec3f& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

bool in_range(const Mesh& mesh, const Triangle& t) {
  return std::max({t[0], t[1], t[2]}) < mesh.positions.size();
}

bool has_finite_corners(const Mesh& mesh, const Triangle& t) {
  return is_finite(mesh.positions[t[0]]) && is_finite(mesh.positions[t[1]]) &&
         is_finite(mesh.positions[t[2]]);
}

// Returns a vector along the normal whose length is twice the area.
Vec3d twice_area_vector(const Mesh& mesh, const Triangle& t) {
  const Vec3d a = to_double(mesh.positions[t[0]]);
  return cross(to_double(mesh.positions[t[1]]) - a, to_double(mesh.positions[t[2]]) - a);
}

// ---------------------------------------------------------------------------------------------------- bounds

// Returns a flag per vertex: whether its position is finite and a triangle uses it.
std::vector<char> used_finite_vertices(const Mesh& mesh) {
  std::vector<char> used(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      if (v < used.size() && is_finite(mesh.positions[v])) used[v] = 1;
    }
  }
  return used;
}

// --------------------------------------------------------------------------------------------------- welding

constexpr std::uint32_t kEmpty = std::numeric_limits<std::uint32_t>::max();

// Returns the bits of a coordinate, the same for -0 and +0.
std::uint64_t coordinate_bits(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return bits == 0x80000000U ? 0U : bits;
}

// Hashes the three coordinates with the mixing step of SplitMix64.
std::uint64_t position_hash(const Vec3f& p) {
  std::uint64_t z = coordinate_bits(p.x) | (coordinate_bits(p.y) << 32U);
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL + coordinate_bits(p.z);
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}

bool same_position(const Vec3f& a, const Vec3f& b) {
  return coordinate_bits(a.x) == coordinate_bits(b.x) && coordinate_bits(a.y) == coordinate_bits(b.y) &&
         coordinate_bits(a.z) == coordinate_bits(b.z);
}

// -------------------------------------------------------------------------------------------------- checking

enum class Defect : std::uint8_t { none, out_of_range, non_finite, degenerate, duplicate };

// Returns the welded corners, rotated so that the smallest is first. The result is equal for triangles that
// have the same positions and winding.
Triangle canonical(const Triangle& t, const std::vector<std::uint32_t>& weld) {
  Triangle corners{weld[t[0]], weld[t[1]], weld[t[2]]};
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

bool has_distinct_corners(const Triangle& t, const std::vector<std::uint32_t>& weld) {
  return weld[t[0]] != weld[t[1]] && weld[t[1]] != weld[t[2]] && weld[t[2]] != weld[t[0]];
}

Defect own_defect(const Mesh& mesh, const Triangle& t, const std::vector<std::uint32_t>& weld) {
  if (!in_range(mesh, t)) return Defect::out_of_range;
  if (!has_finite_corners(mesh, t)) return Defect::non_finite;
  if (!has_distinct_corners(t, weld) || twice_area_vector(mesh, t) == Vec3d{}) return Defect::degenerate;
  return Defect::none;
}

void mark_duplicates(const Mesh& mesh, const std::vector<std::uint32_t>& weld, std::vector<Defect>& defects) {
  std::vector<std::pair<Triangle, std::uint32_t>> keys;
  keys.reserve(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (defects[i] == Defect::none) keys.emplace_back(canonical(mesh.triangles[i], weld), i);
  }
  // The index breaks ties, so that the first of several equal triangles is the original.
  parallel_sort(keys.begin(), keys.end());
  for (std::size_t k = 1; k < keys.size(); ++k) {
    if (keys[k].first == keys[k - 1].first) defects[keys[k].second] = Defect::duplicate;
  }
}

std::vector<Defect> find_defects(const Mesh& mesh, const std::vector<std::uint32_t>& weld) {
  std::vector<Defect> defects(mesh.triangles.size());
  std::transform(mesh.triangles.begin(), mesh.triangles.end(), defects.begin(),
                 [&](const Triangle& t) { return own_defect(mesh, t, weld); });
  mark_duplicates(mesh, weld, defects);
  return defects;
}

// Counts edges. Triangles with three distinct corners count even if they have no area, because a needle
// closes the surface.
void count_edges(const Mesh& mesh, const std::vector<std::uint32_t>& weld, MeshReport& report) {
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    if (!in_range(mesh, t) || !has_finite_corners(mesh, t) || !has_distinct_corners(t, weld)) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(weld[t[i]], weld[t[(i + 1) % 3]]);
      edges.push_back((std::uint64_t{low} << 32U) | high);
    }
  }
  parallel_sort(edges.begin(), edges.end());
  for (auto begin = edges.begin(); begin != edges.end();) {
    const auto end = std::find_if(begin, edges.end(), [&](std::uint64_t edge) { return edge != *begin; });
    if (end - begin == 1) ++report.boundary_edges;
    if (end - begin > 2) ++report.non_manifold_edges;
    begin = end;
  }
}

std::uint64_t count_unreferenced_vertices(const Mesh& mesh) {
  std::vector<char> used(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      if (v < used.size()) used[v] = 1;
    }
  }
  return static_cast<std::uint64_t>(std::count(used.begin(), used.end(), 0));
}

MeshReport make_report(const Mesh& mesh, const std::vector<std::uint32_t>& weld,
                       const std::vector<Defect>& defects) {
  const auto count = [&](Defect defect) {
    return static_cast<std::uint64_t>(std::count(defects.begin(), defects.end(), defect));
  };
  MeshReport report;
  report.vertices = mesh.positions.size();
  report.triangles = mesh.triangles.size();
  report.out_of_range = count(Defect::out_of_range);
  report.non_finite = count(Defect::non_finite);
  report.degenerate = count(Defect::degenerate);
  report.duplicate = count(Defect::duplicate);
  report.unreferenced_vertices = count_unreferenced_vertices(mesh);
  count_edges(mesh, weld, report);
  return report;
}

// Returns what clean() would drop, as in "2 with an index out of range, 1 without area", or an empty string.
std::string describe_defects(const MeshReport& report, DuplicatePolicy duplicates) {
  std::string text;
  const auto add = [&](std::uint64_t count, const std::string& what) {
    if (count == 0) return;
    if (!text.empty()) text += ", ";
    text += std::to_string(count) + " " + what;
  };
  add(report.out_of_range, "with an index out of range");
  add(report.non_finite, "with a NaN or infinite corner");
  add(report.degenerate, "without area");
  if (duplicates == DuplicatePolicy::drop) add(report.duplicate, "duplicate");
  return text;
}

}  // namespace

BoundingSphere bounding_sphere(const Mesh& mesh) {
  const std::vector<char> used = used_finite_vertices(mesh);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3d low{kInfinity, kInfinity, kInfinity};
  Vec3d high = -low;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] == 0) continue;
    const Vec3d p = to_double(mesh.positions[v]);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  if (low.x > high.x) return {};

  BoundingSphere sphere;
  sphere.center = (low + high) * 0.5;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] != 0) {
      sphere.radius = std::max(sphere.radius, length(to_double(mesh.positions[v]) - sphere.center));
    }
  }
  return sphere;
}

Vec3d triangle_normal(const Mesh& mesh, std::uint32_t triangle) {
  const Vec3d area = twice_area_vector(mesh, mesh.triangles[triangle]);
  const double size = length(area);
  return size > 0 && std::isfinite(size) ? area / size : Vec3d{};
}

std::vector<Vec3f> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3d> sums(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    if (!in_range(mesh, t) || !has_finite_corners(mesh, t)) continue;
    const Vec3d area = twice_area_vector(mesh, t);
    for (const std::uint32_t v : t) sums[v] += area;
  }
  std::vector<Vec3f> normals(sums.size());
  std::transform(sums.begin(), sums.end(), normals.begin(),
                 [](const Vec3d& sum) { return to_float(normalized(sum)); });
  return normals;
}

std::vector<std::uint32_t> weld_by_position(std::span<const Vec3f> positions) {
  // Open addressing with linear probing, at most half full.
  const std::size_t slots = std::bit_ceil(std::max<std::size_t>(2 * positions.size(), 2));
  std::vector<std::uint32_t> table(slots, kEmpty);
  std::vector<std::uint32_t> first(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    std::size_t slot = position_hash(positions[v]) & (slots - 1);
    while (table[slot] != kEmpty && !same_position(positions[table[slot]], positions[v])) {
      slot = (slot + 1) & (slots - 1);
    }
    if (table[slot] == kEmpty) table[slot] = v;
    first[v] = table[slot];
  }
  return first;
}

MeshReport check(const Mesh& mesh) {
  const std::vector<std::uint32_t> weld = weld_by_position(mesh.positions);
  return make_report(mesh, weld, find_defects(mesh, weld));
}

CleanMesh clean(const Mesh& mesh, const CleanOptions& options, const std::string& name) {
  const std::vector<std::uint32_t> weld = weld_by_position(mesh.positions);
  const std::vector<Defect> defects = find_defects(mesh, weld);

  CleanMesh result;
  result.report = make_report(mesh, weld, defects);
  if (options.strict) {
    const std::string reasons = describe_defects(result.report, options.duplicates);
    if (!reasons.empty()) {
      throw Error(ErrorKind::bad_input, name + ": strict checking refuses these of " +
                                            std::to_string(mesh.triangles.size()) + " triangles: " + reasons);
    }
  }

  result.mesh.positions = mesh.positions;
  result.mesh.normals = mesh.normals;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const bool kept_duplicate =
        defects[i] == Defect::duplicate && options.duplicates == DuplicatePolicy::keep;
    if (defects[i] != Defect::none && !kept_duplicate) continue;
    result.mesh.triangles.push_back(mesh.triangles[i]);
    result.source.push_back(i);
  }
  return result;
}

}  // namespace pellucid
