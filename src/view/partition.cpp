// Implements view partitions: the icosphere, the cells of P[n], S[n,m], T[n] and R[n], their names, and the
// cell that contains a direction.
//
// Based on: Han, Chen, Nehab, Sander, "In-Depth Buffers", PACMCGIT 1(1), 2018, section 2.1. The icosphere has
// the numbering and exactly the vertices of pellucid/runtime/select.h.
#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "pellucid/runtime/select.h"
#include "pellucid/view.h"

namespace pellucid {
namespace {

// ------------------------------------------------------------------------------------------------- icosphere

constexpr std::uint32_t kMaxIcosphereLevel = 9;  // S[5,4] needs its 2.6 million vertices

using Corners = std::array<std::uint32_t, 3>;

Icosphere make_icosahedron() {
  Icosphere sphere;
  for (const auto& v : pellucid_base_vertices) sphere.vertices.push_back({v[0], v[1], v[2]});
  for (const auto& f : pellucid_base_faces) sphere.triangles.push_back({f[0], f[1], f[2]});
  return sphere;
}

Vec3d midpoint(const Vec3d& a, const Vec3d& b) {
  const std::array<double, 3> first{a.x, a.y, a.z};
  const std::array<double, 3> second{b.x, b.y, b.z};
  std::array<double, 3> middle{};
  pellucid_midpoint(first.data(), second.data(), middle.data());
  return {middle[0], middle[1], middle[2]};
}

// Splits edges at their midpoints, each edge once.
class EdgeSplitter {
 public:
  explicit EdgeSplitter(Icosphere& sphere) : sphere_(sphere) {
    middles_.reserve(sphere.triangles.size() * 2);
  }

  std::uint32_t split(std::uint32_t a, std::uint32_t b) {
    const std::uint64_t edge = (std::uint64_t{std::min(a, b)} << 32U) | std::max(a, b);
    const auto [entry, is_new] =
        middles_.try_emplace(edge, static_cast<std::uint32_t>(sphere_.vertices.size()));
    if (is_new) sphere_.vertices.push_back(midpoint(sphere_.vertices[a], sphere_.vertices[b]));
    return entry->second;
  }

 private:
  Icosphere& sphere_;
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;
};

void subdivide(Icosphere& sphere) {
  EdgeSplitter splitter(sphere);
  std::vector<Corners> children;
  children.reserve(sphere.triangles.size() * 4);
  for (const auto& [c0, c1, c2] : sphere.triangles) {
    const std::uint32_t m12 = splitter.split(c1, c2);
    const std::uint32_t m20 = splitter.split(c2, c0);
    const std::uint32_t m01 = splitter.split(c0, c1);
    children.push_back({c0, m01, m20});
    children.push_back({m01, c1, m12});
    children.push_back({m20, m12, c2});
    children.push_back({m12, m20, m01});
  }
  sphere.triangles = std::move(children);
}

// ----------------------------------------------------------------------------------------------------- cells

constexpr std::uint32_t kMaxSampleLevel = 4;

[[noreturn]] void refuse(const std::string& text) {
  throw Error(ErrorKind::bad_argument,
              "'" + text + "' is not a view partition: use S<n>,<m> with n in 0.." +
                  std::to_string(kMaxPartitionLevel) + " and m in 0.." + std::to_string(kMaxSampleLevel) +
                  " (sampled view triangles), or with n in 0.." + std::to_string(kMaxPartitionLevel) +
                  " P<n> (discrete viewpoints), T<n> (all viewpoints of view "
                  "triangles) or R<n> (of view regions)");
}

void check_spec(const PartitionSpec& spec) {
  const bool sampled = has_triangle_cells(spec);
  if (spec.level > kMaxPartitionLevel || (sampled && spec.sample_level > kMaxSampleLevel)) {
    refuse(to_string(spec));
  }
  if (is_continuous(spec) && spec.sample_level != kSolidSampleLevel) refuse(to_string(spec));
}

// Converts (row, value) pairs to compressed rows. Each row is sorted and has no repetitions.
void fill_rows(std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs, std::size_t row_count,
               std::vector<std::uint32_t>& offsets, std::vector<std::uint32_t>& values) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  offsets.assign(row_count + 1, 0);
  values.clear();
  values.reserve(pairs.size());
  for (const auto& [row, value] : pairs) {
    ++offsets[row + 1];
    values.push_back(value);
  }
  for (std::size_t row = 0; row < row_count; ++row) offsets[row + 1] += offsets[row];
}

// Returns the cosine of the cap around each vertex. The smallest cosine between a vertex and the
// circumcentres of its triangles bounds its Voronoi region.
std::vector<double> vertex_cap_cosines(const Icosphere& sphere) {
  constexpr double kRounding = 1e-14;
  std::vector<double> cosines(sphere.vertices.size(), 1.0);
  for (const auto& triangle : sphere.triangles) {
    const Vec3d& a = sphere.vertices[triangle[0]];
    const Vec3d& b = sphere.vertices[triangle[1]];
    const Vec3d& c = sphere.vertices[triangle[2]];
    const double cosine = dot(normalized(cross(b - a, c - a)), a) - kRounding;
    for (const std::uint32_t v : triangle) cosines[v] = std::min(cosines[v], cosine);
  }
  return cosines;
}

void make_viewpoint_cells(ViewPartition& partition) {
  Icosphere sphere = make_icosphere(partition.spec.level);
  const std::size_t cells = sphere.vertices.size();

  // Each cell is a vertex, which is also its only sample.
  partition.cell_offsets.resize(cells + 1);
  partition.cell_samples.resize(cells);
  std::iota(partition.cell_offsets.begin(), partition.cell_offsets.end(), 0U);
  std::iota(partition.cell_samples.begin(), partition.cell_samples.end(), 0U);

  std::vector<std::pair<std::uint32_t, std::uint32_t>> joined;
  for (const auto& triangle : sphere.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      partition.corner_cells.push_back(triangle[k]);
      joined.emplace_back(triangle[k], triangle[(k + 1) % 3]);
      joined.emplace_back(triangle[(k + 1) % 3], triangle[k]);
    }
  }
  fill_rows(joined, cells, partition.neighbor_offsets, partition.neighbors);
  partition.cap_cosines = vertex_cap_cosines(sphere);
  partition.samples = std::move(sphere.vertices);
}

// Finds the neighbours of triangular cells, which share an edge.
void find_triangle_neighbors(const Icosphere& sphere, ViewPartition& partition) {
  struct EdgeSide {
    std::uint32_t low, high, triangle;
    bool operator<(const EdgeSide& other) const {
      return std::tie(low, high, triangle) < std::tie(other.low, other.high, other.triangle);
    }
  };
  std::vector<EdgeSide> sides;
  sides.reserve(sphere.triangles.size() * 3);
  for (std::uint32_t t = 0; t < sphere.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(sphere.triangles[t][k], sphere.triangles[t][(k + 1) % 3]);
      sides.push_back({low, high, t});
    }
  }
  // The surface is closed, so each edge has two sides, which are adjacent after sorting.
  std::sort(sides.begin(), sides.end());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> joined;
  joined.reserve(sides.size());
  for (std::size_t i = 0; i + 1 < sides.size(); i += 2) {
    joined.emplace_back(sides[i].triangle, sides[i + 1].triangle);
    joined.emplace_back(sides[i + 1].triangle, sides[i].triangle);
  }
  fill_rows(joined, sphere.triangles.size(), partition.neighbor_offsets, partition.neighbors);
}

void make_triangle_cells(ViewPartition& partition) {
  const Icosphere cells = make_icosphere(partition.spec.level);
  Icosphere fine = make_icosphere(partition.spec.level + partition.spec.sample_level);

  // The samples of cell c are the corners of its descendants, which are numbered from c * 4^m on.
  const std::size_t descendants = fine.triangles.size() / cells.triangles.size();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sampled;
  sampled.reserve(fine.triangles.size() * 3);
  for (std::size_t t = 0; t < fine.triangles.size(); ++t) {
    for (const std::uint32_t v : fine.triangles[t]) {
      sampled.emplace_back(static_cast<std::uint32_t>(t / descendants), v);
    }
  }
  fill_rows(sampled, cells.triangles.size(), partition.cell_offsets, partition.cell_samples);

  for (const auto& triangle : cells.triangles) {
    partition.corners.push_back(
        {cells.vertices[triangle[0]], cells.vertices[triangle[1]], cells.vertices[triangle[2]]});
  }
  find_triangle_neighbors(cells, partition);
  partition.samples = std::move(fine.vertices);
}

// ---------------------------------------------------------------------------------------------------- lookup

bool triangle_contains(const std::array<Vec3d, 3>& corners, const Vec3d& direction) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d inward = normalized(cross(corners[k], corners[(k + 1) % 3]));
    if (dot(inward, direction) < -PELLUCID_BORDER) return false;
  }
  return true;
}

std::uint32_t nearest_sample(const ViewPartition& partition, const Vec3d& direction) {
  std::uint32_t best = 0;
  for (std::uint32_t c = 1; c < partition.samples.size(); ++c) {
    if (dot(partition.samples[c], direction) > dot(partition.samples[best], direction)) best = c;
  }
  return best;
}

}  // namespace

Icosphere make_icosphere(std::uint32_t level) {
  if (level > kMaxIcosphereLevel) {
    throw Error(ErrorKind::bad_argument, "icosphere level " + std::to_string(level) + " is out of range 0.." +
                                             std::to_string(kMaxIcosphereLevel));
  }
  Icosphere sphere = make_icosahedron();
  for (std::uint32_t i = 0; i < level; ++i) subdivide(sphere);
  return sphere;
}

PartitionSpec parse_partition(const std::string& text) {
  // Brackets are optional: S[2,2] is S2,2.
  std::string bare = text;
  const std::size_t open = bare.find('[');
  if (open != std::string::npos) {
    if (open != 1 || bare.back() != ']') refuse(text);
    bare.pop_back();
    bare.erase(open, 1);
  }
  const auto digit = [&](std::size_t i) {
    if (bare[i] < '0' || bare[i] > '9') refuse(text);
    return static_cast<std::uint32_t>(bare[i] - '0');
  };

  PartitionSpec spec;
  if (bare.size() == 4 && (bare[0] == 'S' || bare[0] == 's') && bare[2] == ',') {
    spec = {PartitionKind::sampled_triangles, digit(1), digit(3)};
  } else if (bare.size() == 2 && (bare[0] == 'P' || bare[0] == 'p')) {
    spec = {PartitionKind::viewpoints, digit(1), 0};
  } else if (bare.size() == 2 && (bare[0] == 'T' || bare[0] == 't')) {
    spec = {PartitionKind::view_triangles, digit(1), kSolidSampleLevel};
  } else if (bare.size() == 2 && (bare[0] == 'R' || bare[0] == 'r')) {
    spec = {PartitionKind::view_regions, digit(1), kSolidSampleLevel};
  } else {
    refuse(text);
  }
  if (spec.level > kMaxPartitionLevel || spec.sample_level > kMaxSampleLevel) refuse(text);
  return spec;
}

std::string to_string(const PartitionSpec& spec) {
  constexpr std::array kLetters{'P', 'S', 'T', 'R'};  // by PartitionKind
  std::string name(1, kLetters[static_cast<std::size_t>(spec.kind)]);
  name += std::to_string(spec.level);
  if (spec.kind == PartitionKind::sampled_triangles) name += ',' + std::to_string(spec.sample_level);
  return name;
}

ViewPartition make_partition(const PartitionSpec& spec) {
  check_spec(spec);
  ViewPartition partition;
  partition.spec = spec;
  if (spec.kind == PartitionKind::viewpoints) {
    make_viewpoint_cells(partition);
  } else {
    make_triangle_cells(partition);
  }
  return partition;
}

Vec3d cell_direction(const ViewPartition& partition, std::uint32_t cell) {
  if (partition.spec.kind == PartitionKind::viewpoints) return partition.samples[cell];
  const auto& [a, b, c] = partition.corners[cell];
  return normalized(a + b + c);
}

std::uint32_t find_cell(const ViewPartition& partition, const Vec3d& direction) {
  const std::array<double, 3> d{direction.x, direction.y, direction.z};
  if (has_triangle_cells(partition.spec)) {
    return pellucid_find_triangle(partition.spec.level, d.data());
  }
  return partition.corner_cells[pellucid_find_corner(partition.spec.level, d.data())];
}

std::uint32_t find_cell_brute_force(const ViewPartition& partition, const Vec3d& direction) {
  const Vec3d unit = normalized(direction);
  if (!has_triangle_cells(partition.spec)) return nearest_sample(partition, unit);
  for (std::uint32_t c = 0; c < partition.corners.size(); ++c) {
    if (triangle_contains(partition.corners[c], unit)) return c;
  }
  return 0;
}

}  // namespace pellucid
