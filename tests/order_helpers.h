// Makes small meshes and random graphs for the tests of the modules `sequencing`, `transparency` and
// `baseline`.
#pragma once

#include <algorithm>
#include <fstream>
#include <map>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "meshes.h"
#include "pellucid/mesh.h"
#include "pellucid/metric.h"
#include "pellucid/raster.h"
#include "pellucid/sequencing.h"
#include "pellucid/transparency.h"
#include "transparency/graph/occlusion_graph.h"

namespace pellucid::testing {

// Two shells, one inside the other: every view sees four layers.
inline Mesh nested_spheres(std::uint32_t level) {
  Mesh mesh = icosphere_mesh(level);
  append(mesh, icosphere_mesh(level, 0.6));
  return mesh;
}

// All parts of a sample as one mesh, simplified.
inline Mesh sample_mesh(const std::string& name, double detail, std::uint32_t triangles) {
  Mesh mesh;
  for (const SamplePart& part : make_sample(name, detail)) append(mesh, part.mesh);
  return mesh.triangles.size() > triangles ? simplify(mesh, triangles) : mesh;
}

inline Mesh one_triangle() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {{0, 1, 2}}};
}

// "v" and triangular "f" lines alone; empty where the file is missing.
inline Mesh read_plain_obj(const std::string& path) {
  Mesh mesh;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vec3f p;
      words >> p.x >> p.y >> p.z;
      mesh.positions.push_back(p);
    } else if (kind == "f") {
      Triangle t;
      for (std::uint32_t& corner : t) {
        std::string word;
        words >> word;
        corner = static_cast<std::uint32_t>(std::stoul(word)) - 1;
      }
      mesh.triangles.push_back(t);
    }
  }
  return clean(mesh, {}, path).mesh;
}

// Three flat sticks in the plane z = 0, tilted so that each lies over the next: a cycle seen from +z and -z.
inline Mesh three_sticks() {
  Mesh mesh;
  for (int k = 0; k < 3; ++k) {
    const double turn = 2.0943951023931953 * k;
    const auto put = [&](double x, double y, double z) {
      mesh.positions.push_back(to_float(
          Vec3d{x * std::cos(turn) - y * std::sin(turn), x * std::sin(turn) + y * std::cos(turn), z}));
    };
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    put(-1.0, 0.35, -0.2);
    put(1.0, 0.25, 0.2);
    put(1.0, 0.45, 0.2);
    mesh.triangles.push_back({base, base + 1, base + 2});
  }
  return mesh;
}

using EdgeMap = std::map<std::pair<NodeId, NodeId>, double>;

inline EdgeRows rows_of(std::uint32_t nodes, const EdgeMap& edges) {
  EdgeRows rows;
  rows.offsets.assign(nodes + 1, 0);
  for (const auto& [pair, weight] : edges) {
    ++rows.offsets[pair.first + 1];
    rows.backs.push_back(pair.second);
    rows.weights.push_back(static_cast<float>(weight));
  }
  std::partial_sum(rows.offsets.begin(), rows.offsets.end(), rows.offsets.begin());
  return rows;
}

// The weight that an order violates, as floats hold it.
inline double violated(const EdgeMap& edges, const std::vector<std::uint32_t>& ranks) {
  double sum = 0;
  for (const auto& [pair, weight] : edges) {
    if (ranks[pair.first] > ranks[pair.second]) sum += static_cast<double>(static_cast<float>(weight));
  }
  return sum;
}

inline EdgeMap map_of(const EdgeRows& rows) {
  EdgeMap edges;
  for (NodeId front = 0; front < rows.node_count(); ++front) {
    for (std::uint32_t i = rows.offsets[front]; i < rows.offsets[front + 1]; ++i) {
      edges[{front, rows.backs[i]}] = static_cast<double>(rows.weights[i]);
    }
  }
  return edges;
}

inline EdgeMap map_of(const CompactRows& rows) {
  return map_of(rows.expanded());
}

// A random permutation of 0 .. count - 1.
inline std::vector<std::uint32_t> random_ranks(std::uint32_t count, Random& random) {
  std::vector<std::uint32_t> ranks(count);
  std::iota(ranks.begin(), ranks.end(), 0U);
  for (std::size_t i = count; i > 1; --i) std::swap(ranks[i - 1], ranks[random.below(i)]);
  return ranks;
}

inline bool is_permutation_of_all(std::vector<std::uint32_t> values) {
  std::sort(values.begin(), values.end());
  for (std::uint32_t i = 0; i < values.size(); ++i) {
    if (values[i] != i) return false;
  }
  return true;
}

}  // namespace pellucid::testing
