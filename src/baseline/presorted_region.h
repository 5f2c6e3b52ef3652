// One depth-presorted list: a sequence of nodes that is right for every sampled viewpoint of a view region.
//
// A single order is sifted first. Where it contradicts an occlusion, one of the two nodes is split: two
// copies of it at different places of the list, told apart by a plane test of the viewpoint. Splitting goes
// on until nothing is contradicted, or no plane helps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/baseline.h"
#include "pellucid/mesh.h"
#include "pellucid/sequencing.h"
#include "transparency/graph/viewpoint_edges.h"

namespace pellucid {

// Who hides whom from which of the region's viewpoints. Rows by front node, sorted by back node.
struct RegionOcclusions {
  std::vector<std::uint64_t> offsets;  // nodes + 1, into backs
  std::vector<NodeId> backs;
  std::vector<std::uint64_t> view_offsets;  // edges + 1, into views
  std::vector<std::uint16_t> views;         // indices of viewpoints, ascending
};
// Overlaps smaller than `least_area` (square radii) do not count. Of faces that cross, the one that hides
// more counts as the one in front.
RegionOcclusions collect_edges(std::span<const ViewpointEdges* const> views, std::size_t triangle_count,
                               float least_area);

struct RegionProblem {
  const Mesh* mesh = nullptr;
  std::vector<Eye> eyes;  // one per viewpoint
  RegionOcclusions edges;
  std::vector<std::uint8_t> drawn;   // per node: can the region see it?
  std::vector<std::uint32_t> ranks;  // per node: an order to begin with
  std::uint32_t cache_size = 20;
  std::uint64_t max_copies = 0;
  const Progress* progress = nullptr;
};

struct RegionList {
  PresortedList list;  // tests refer to `planes`
  std::vector<Plane> planes;
  std::uint64_t violated = 0;  // edges between copies that the list contradicts
  bool complete = true;        // false: more than max_copies would be needed
};
RegionList presort_region(const RegionProblem& problem);

}  // namespace pellucid
