// Implements the depth-presorted triangle lists of pellucid/baseline.h: builds a list for every view region,
// and selects and walks a list in a frame.
//
// Based on: Chen, Sander, Nehab, Yang, Hu, "Depth-Presorted Triangle Lists", ACM TOG 31(6), 2012, as far as
// Han et al., "In-Depth Buffers", 2018, sections 1 and 7, describe it: view regions, one list for each region
// that merges all orders, copies of triangles with plane tests, copies for both facings, one stored plane per
// entry of a list, vertex cache optimisation under the partial order. That text leaves some points open. The
// assumptions are:
//   - regions: view cells by the nearest of k directions spread evenly over the sphere;
//   - occlusions: found exactly at the samples of the view partition, as for in-depth buffers, where the
//     original reasons about whole regions of space;
//   - copies: nodes are split where a sifted order contradicts an occlusion, by the plane that bounds the
//     occlusion and leaves least contradicted; a copy may need several planes.
#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/parallel.h"
#include "baseline/presorted_region.h"
#include "pellucid/baseline.h"
#include "pellucid/runtime/select.h"
#include "pellucid/sequencing.h"
#include "pellucid/transparency.h"
#include "transparency/cluster/clustering.h"
#include "transparency/order_problem.h"

namespace pellucid {
namespace {

// Smaller overlaps (square radii, about a fifteenth of a pixel of a 512 x 512 image) are no occlusions.
constexpr float kLeastOcclusion = 1e-6F;
// Viewpoints of a region are numbered in 16 bits.
constexpr std::size_t kMostViews = 65535;

// Returns directions that are spread evenly over the sphere, on a Fibonacci spiral.
std::vector<Vec3d> spiral_directions(std::uint32_t count) {
  std::vector<Vec3d> directions;
  for (std::uint32_t k = 0; k < count; ++k) {
    const double z = 1 - (2 * k + 1.0) / count;
    const double turn = 2.399963229728653 * k;  // the golden angle
    const double r = std::sqrt(1 - z * z);
    directions.push_back({r * std::cos(turn), r * std::sin(turn), z});
  }
  return directions;
}

std::vector<std::uint32_t> regions_of_cells(const ViewPartition& partition, std::uint32_t regions) {
  const std::vector<Vec3d> directions = spiral_directions(regions);
  std::vector<std::uint32_t> region_of(partition.cell_count());
  for (std::uint32_t cell = 0; cell < partition.cell_count(); ++cell) {
    const Vec3d middle = cell_direction(partition, cell);
    std::uint32_t best = 0;
    for (std::uint32_t k = 1; k < regions; ++k) {
      if (dot(directions[k], middle) > dot(directions[best], middle)) best = k;
    }
    region_of[cell] = best;
  }
  return region_of;
}

class ListBuilder {
 public:
  ListBuilder(const Mesh& mesh, const PresortedOptions& options)
      : mesh_(mesh),
        options_(options),
        sphere_(bounding_sphere(mesh)),
        partition_(make_partition(options.partition)),
        distances_(options.distances.empty() ? default_distances() : options.distances),
        scene_{mesh, sphere_, unit_positions(mesh, sphere_), options.facing == Facing::single, 0, 0} {}

  PresortedLists build() {
    PresortedLists result;
    result.partition = options_.partition;
    result.sphere = sphere_;
    result.cell_lists = regions_of_cells(partition_, std::min(options_.regions, partition_.cell_count()));
    const std::uint32_t regions = *std::max_element(result.cell_lists.begin(), result.cell_lists.end()) + 1;
    begin_stage(options_.progress, "presorted lists", regions);
    for (std::uint32_t region = 0; region < regions && result.complete; ++region) {
      add_region(cells_of_cluster(result.cell_lists, region), result);
      advance_stage(options_.progress, 1);
    }
    if (!result.complete) {
      result.lists.clear();
      result.planes.clear();
    }
    return result;
  }

 private:
  void add_region(const std::vector<std::uint32_t>& cells, PresortedLists& result) {
    RegionProblem problem;
    problem.mesh = &mesh_;
    problem.progress = options_.progress;
    problem.cache_size = options_.cache_size;
    problem.max_copies = options_.max_copies;
    if (!find_occlusions(cells, problem)) {
      result.complete = false;
      return;
    }
    problem.drawn = visible_nodes(cells);
    problem.ranks = ranks_by_key(depth_keys(mesh_, sphere_, partition_, cells));
    RegionList region = presort_region(problem);
    result.complete = region.complete;
    result.violated_edges += region.violated;
    const auto base = static_cast<std::uint32_t>(2 * result.planes.size());
    for (std::uint32_t& test : region.list.tests) test += base;
    result.planes.insert(result.planes.end(), region.planes.begin(), region.planes.end());
    result.lists.push_back(std::move(region.list));
  }

  // Finds the occlusions of a region. Returns false if there are more than max_edges, or too many viewpoints.
  bool find_occlusions(const std::vector<std::uint32_t>& cells, RegionProblem& problem) {
    std::vector<std::uint32_t> samples;
    for (const std::uint32_t cell : cells) {
      const std::span<const std::uint32_t> of_cell = partition_.samples_of(cell);
      samples.insert(samples.end(), of_cell.begin(), of_cell.end());
    }
    std::sort(samples.begin(), samples.end());
    samples.erase(std::unique(samples.begin(), samples.end()), samples.end());
    if (samples.size() > kMostViews) return false;

    // Neighbouring samples alternate between the distances, as for in-depth buffers.
    std::vector<ViewpointEdges> views(samples.size());
    std::vector<const ViewpointEdges*> pointers;
    std::atomic<std::uint64_t> edges{0};
    for (std::size_t i = 0; i < samples.size(); ++i) {
      pointers.push_back(&views[i]);
      problem.eyes.push_back(eye_of(sphere_, viewpoint_of(samples[i])));
    }
    parallel_loop(std::size_t{0}, samples.size(), [&](std::size_t i) {
      stop_if_requested(options_.progress);
      if (edges > options_.max_edges) return;
      find_edges_exactly(scene_, viewpoint_of(samples[i]), scratch_.local(), views[i]);
      edges += views[i].backs.size();
    });
    if (edges > options_.max_edges) return false;
    problem.edges = collect_edges(pointers, mesh_.triangles.size(), kLeastOcclusion);
    return true;
  }

  [[nodiscard]] Viewpoint viewpoint_of(std::uint32_t sample) const {
    return {partition_.samples[sample], distances_[sample % distances_.size()]};
  }

  [[nodiscard]] std::vector<std::uint8_t> visible_nodes(const std::vector<std::uint32_t>& cells) const {
    const ValidRange range = valid_range(options_.partition.kind, distances_);
    std::vector<std::uint8_t> visible(2 * mesh_.triangles.size(), 0);
    parallel_loop(std::uint32_t{0}, static_cast<std::uint32_t>(mesh_.triangles.size()), [&](std::uint32_t t) {
      const Vec3d normal = triangle_normal(mesh_, t);
      const double offset = dot(normal, to_double(mesh_.positions[mesh_.triangles[t][0]]) - sphere_.center);
      for (const std::uint32_t cell : cells) {
        const auto sees = [&](double sign) {
          return front_visible(partition_, cell, normal * sign, sign * offset, sphere_.radius, range.from,
                               range.to);
        };
        if (visible[node_of(t, false)] == 0 && sees(1)) visible[node_of(t, false)] = 1;
        if (options_.facing == Facing::duplicated && visible[node_of(t, true)] == 0 && sees(-1)) {
          visible[node_of(t, true)] = 1;
        }
      }
    });
    return visible;
  }

  const Mesh& mesh_;
  const PresortedOptions& options_;
  BoundingSphere sphere_;
  ViewPartition partition_;
  std::vector<double> distances_;
  OcclusionScene scene_;
  PerThread<OcclusionScratch> scratch_;
};

}  // namespace

PresortedLists build_presorted_lists(const Mesh& mesh, const PresortedOptions& options) {
  if (options.regions == 0) throw Error(ErrorKind::bad_argument, "presorted lists need at least one region");
  if (options.partition.kind != PartitionKind::sampled_triangles)
    throw Error(ErrorKind::bad_argument, "presorted lists need view cells that are triangles: S[n,m]");
  return ListBuilder(mesh, options).build();
}

const PresortedList& select_list(const PresortedLists& lists, const Vec3d& direction) {
  const double d[3] = {direction.x, direction.y, direction.z};
  return lists.lists[lists.cell_lists[pellucid_find_triangle(lists.partition.level, d)]];
}

void walk_list(const PresortedLists& lists, const PresortedList& list, const Eye& eye, NodeSequence& nodes) {
  nodes.clear();
  for (std::size_t copy = 0; copy < list.nodes.size(); ++copy) {
    bool passes = true;
    for (std::uint32_t i = list.test_offsets[copy]; passes && i < list.test_offsets[copy + 1]; ++i) {
      const bool in_front = side_of(lists.planes[list.tests[i] / 2], eye) >= 0;
      passes = in_front == (list.tests[i] % 2 == 0);
    }
    if (passes) nodes.push_back(list.nodes[copy]);
  }
}

}  // namespace pellucid
