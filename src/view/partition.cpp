// View partitions P[n], S[n,m], T[n] and R[n]: their names, cells, samples and neighbours.
// Based on: Han, Chen, Nehab, Sander, "In-Depth Buffers", PACMCGIT 1(1), 2018, section 2.1.
#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>
#include <utility>

#include "pellucid/view.h"

namespace pellucid {
namespace {

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

// Compressed rows from (row, value) pairs: each row sorted, without repetitions.
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

// The smallest cosine between a vertex and the circumcentres of its triangles bounds its Voronoi region.
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

  // Each cell is a vertex and its own only sample.
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

// Triangles are neighbours where they share an edge.
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
  // The surface is closed: each edge has two sides, next to each other after sorting.
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

  // The samples of cell c are the corners of its descendants, which are numbered c * 4^m and up.
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

}  // namespace

PartitionSpec parse_partition(const std::string& text) {
  // Brackets are decoration: S[2,2] is S2,2.
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

}  // namespace pellucid
