// What is wrong with a mesh, and the same mesh without it: see pellucid/mesh.h.
#include <algorithm>
#include <array>
#include <utility>

#include "base/parallel.h"
#include "mesh/mesh_predicates.h"
#include "pellucid/mesh.h"

namespace pellucid {
namespace {

enum class Defect : std::uint8_t { none, out_of_range, non_finite, degenerate, duplicate };

// Corners as welded vertices, smallest first, winding kept: equal for triangles that cover each other
// exactly.
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
  // The triangle's number breaks ties: the first of equal triangles is the original.
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

// Triangles with three distinct corners make edges even where they have no area: a needle closes the surface.
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

// "2 triangles with an index out of range, 1 degenerate triangle"; empty when nothing would be dropped.
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
  if (duplicates == DuplicatePolicy::drop) add(report.duplicate, "doubled");
  return text;
}

}  // namespace

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
