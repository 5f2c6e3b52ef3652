// Implements split_unordered() of pellucid/transparency.h: cuts faces that overlap in a cycle, until no cycle
// is left or no cut helps.
//
// A cut cannot make a viewpoint cyclic, because an edge between pieces is an edge between their triangles,
// and pieces of one triangle do not overlap. So a viewpoint without cycles need not be searched again.
#include <algorithm>
#include <map>
#include <optional>

#include "base/parallel.h"
#include "pellucid/sequencing.h"
#include "pellucid/transparency.h"
#include "sequencing/edge_rows.h"
#include "transparency/graph/viewpoint_edges.h"

namespace pellucid {
namespace {

constexpr std::uint32_t kRounds = 8;
// Larger components contain many faces, and a few cuts do not resolve them.
constexpr std::uint32_t kLargestComponent = 24;
// Cuts that are tried for one component.
constexpr std::size_t kMostCuts = 48;
// Overlaps that hide less than this (square radii) make no edge here. It is a hundredth of a pixel of a 1024
// x 1024 image, as in the occlusion graph.
constexpr float kLeastEdgeArea = 3e-7F;

// The occlusions between triangles from one viewpoint, in rows by the front one.
struct TriangleGraph {
  std::vector<std::uint32_t> offsets, backs;
};

TriangleGraph visible_edges(const ViewpointEdges& edges) {
  TriangleGraph graph;
  graph.offsets.push_back(0);
  for (std::size_t t = 0; t + 1 < edges.offsets.size(); ++t) {
    for (std::uint32_t i = edges.offsets[t]; i < edges.offsets[t + 1]; ++i) {
      if (edges.areas[i] >= kLeastEdgeArea) graph.backs.push_back(triangle_of(edges.backs[i]));
    }
    graph.offsets.push_back(static_cast<std::uint32_t>(graph.backs.size()));
  }
  return graph;
}

// Returns the members of every component of two or more triangles.
std::vector<std::vector<std::uint32_t>> cycles_of(const TriangleGraph& graph) {
  if (!has_cycle(graph.offsets, graph.backs)) return {};
  const std::vector<std::uint32_t> component = strong_components(graph.offsets, graph.backs);
  std::map<std::uint32_t, std::vector<std::uint32_t>> members;
  for (std::uint32_t t = 0; t < component.size(); ++t) members[component[t]].push_back(t);
  std::vector<std::vector<std::uint32_t>> cycles;
  for (auto& [number, triangles] : members) {
    if (triangles.size() > 1) cycles.push_back(std::move(triangles));
  }
  return cycles;
}

// Returns some triangles as a mesh of their own; triangle i was triangles[i].
Mesh extract(const Mesh& mesh, const std::vector<std::uint32_t>& triangles) {
  Mesh part;
  for (const std::uint32_t t : triangles) {
    const auto base = static_cast<std::uint32_t>(part.positions.size());
    for (const std::uint32_t v : mesh.triangles[t]) part.positions.push_back(mesh.positions[v]);
    part.triangles.push_back({base, base + 1, base + 2});
  }
  return part;
}

class CycleSplitter {
 public:
  CycleSplitter(const CycleOptions& options, const BoundingSphere& sphere)
      : options_(options), sphere_(sphere) {
    const std::vector<double> distances = options.distances.empty() ? default_distances() : options.distances;
    constexpr std::uint32_t kLevel = 2;
    for (const Vec3d& direction : make_icosphere(kLevel).vertices) {
      viewpoints_.push_back({direction, distances[viewpoints_.size() % distances.size()]});
    }
  }

  // Splits result.split further, and fills the members of `result` about cycles.
  void run(SplitResult& result) {
    result.viewpoints = static_cast<std::uint32_t>(viewpoints_.size());
    std::vector<std::uint32_t> cyclic(viewpoints_.size());
    for (std::uint32_t v = 0; v < cyclic.size(); ++v) cyclic[v] = v;
    for (std::uint32_t round = 0; round <= kRounds; ++round) {
      const std::vector<TriangleCut> cuts = find_cuts(result.split.mesh, cyclic, round == kRounds);
      if (round == 0) result.cyclic_before = static_cast<std::uint32_t>(cyclic.size());
      if (cuts.empty() || !result.split.complete) break;
      const std::size_t before = result.split.mesh.triangles.size();
      SplitOptions options;
      options.max_new_triangles =
          options_.max_new_triangles - result.added_by_intersections - result.added_by_cycles;
      result.split = compose(result.split, cut_triangles(result.split.mesh, cuts, options));
      result.added_by_cycles += result.split.mesh.triangles.size() - before;
    }
    result.cyclic_left = static_cast<std::uint32_t>(cyclic.size());
  }

 private:
  struct Local {
    OcclusionScratch scratch;
    ViewpointEdges edges;
  };

  [[nodiscard]] OcclusionScene scene_of(const Mesh& mesh) const {
    return {mesh, sphere_, unit_positions(mesh, sphere_), options_.facing == Facing::single, 0, 0};
  }

  // Returns one cut for every component that is seen from the `cyclic` viewpoints, at most one per triangle,
  // and no cuts if only the search is requested. Removes viewpoints without a cycle from `cyclic`.
  std::vector<TriangleCut> find_cuts(const Mesh& mesh, std::vector<std::uint32_t>& cyclic, bool only_look) {
    begin_stage(options_.progress, "cycles", cyclic.size());
    const OcclusionScene scene = scene_of(mesh);
    std::vector<std::vector<TriangleCut>> cuts(cyclic.size());
    std::vector<std::uint8_t> has_cycles(cyclic.size(), 0);
    PerThread<Local> locals;
    parallel_loop(std::size_t{0}, cyclic.size(), [&](std::size_t i) {
      stop_if_requested(options_.progress);
      Local& local = locals.local();
      const Viewpoint& viewpoint = viewpoints_[cyclic[i]];
      find_edges_exactly(scene, viewpoint, local.scratch, local.edges);
      for (const std::vector<std::uint32_t>& cycle : cycles_of(visible_edges(local.edges))) {
        has_cycles[i] = 1;
        if (only_look || cycle.size() > kLargestComponent) continue;
        if (const auto cut = best_cut(mesh, cycle, viewpoint, local)) cuts[i].push_back(*cut);
      }
      advance_stage(options_.progress, 1);
    });
    std::map<std::uint32_t, std::uint32_t> chosen;  // triangle -> whose plane cuts it
    std::vector<std::uint32_t> still_cyclic;
    for (std::size_t i = 0; i < cyclic.size(); ++i) {
      for (const TriangleCut& cut : cuts[i]) chosen.try_emplace(cut.triangle, cut.by);
      if (has_cycles[i] != 0) still_cyclic.push_back(cyclic[i]);
    }
    cyclic = std::move(still_cyclic);
    std::vector<TriangleCut> all;
    all.reserve(chosen.size());
    for (const auto& [triangle, by] : chosen) all.push_back({triangle, by});
    return all;
  }

  // Returns the cut of one member by the plane of another that leaves the fewest triangles in cycles, and of
  // these the one with the fewest pieces. Returns nothing if no cut leaves fewer triangles in cycles than
  // before.
  std::optional<TriangleCut> best_cut(const Mesh& mesh, const std::vector<std::uint32_t>& cycle,
                                      const Viewpoint& viewpoint, Local& local) const {
    const Mesh part = extract(mesh, cycle);
    std::optional<TriangleCut> best;
    std::pair<std::size_t, std::size_t> least{cycle.size(), 0};
    std::size_t trials = 0;
    for (std::uint32_t a = 0; a < cycle.size(); ++a) {
      for (std::uint32_t b = 0; b < cycle.size() && trials < kMostCuts; ++b) {
        if (a == b) continue;
        const TriangleCut cut{a, b};
        const MeshSplit split = cut_triangles(part, std::span(&cut, 1));
        if (split.new_vertices.empty()) continue;
        ++trials;
        const OcclusionScene scene = scene_of(split.mesh);
        find_edges_exactly(scene, viewpoint, local.scratch, local.edges);
        std::size_t in_cycles = 0;
        for (const auto& left : cycles_of(visible_edges(local.edges))) in_cycles += left.size();
        const std::pair<std::size_t, std::size_t> cost{in_cycles, split.mesh.triangles.size()};
        if (cost.first < cycle.size() && (!best || cost < least)) {
          best = TriangleCut{cycle[a], cycle[b]};
          least = cost;
        }
      }
    }
    return best;
  }

  const CycleOptions& options_;
  BoundingSphere sphere_;
  std::vector<Viewpoint> viewpoints_;
};

}  // namespace

SplitResult split_unordered(const Mesh& mesh, const CycleOptions& options) {
  SplitOptions intersections;
  intersections.max_new_triangles = options.max_new_triangles;
  intersections.progress = options.progress;
  IntersectionSplit first = split_intersections(mesh, intersections);
  SplitResult result;
  result.split = std::move(first.split);
  result.intersecting_pairs = first.pairs;
  result.pairs_left = first.left;
  result.added_by_intersections = result.split.mesh.triangles.size() - mesh.triangles.size();
  CycleSplitter(options, bounding_sphere(mesh)).run(result);
  return result;
}

}  // namespace pellucid
