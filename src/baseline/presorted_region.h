// Makes one depth-presorted list: a list of nodes that is right for every sampled viewpoint of a view region.
// In: the viewpoints of the region and the occlusions that they see. Out: the list, and the planes of its
// tests.
//
// A single order is sifted first. Where it contradicts an occlusion, one of the two nodes gets a second copy
// at another place of the list, and a plane test of the viewpoint decides which of the copies is drawn. This
// goes on until nothing is contradicted, or no plane helps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/baseline.h"
#include "pellucid/mesh.h"
#include "pellucid/sequencing.h"
#include "transparency/graph/viewpoint_edges.h"

namespace pellucid {

// Which node hides which other node from which viewpoints of the region. Rows by front node, sorted by back
// node.
struct RegionOcclusions {
  std::vector<std::uint64_t> offsets;  // nodes + 1, into backs
  std::vector<NodeId> backs;
  std::vector<std::uint64_t> view_offsets;  // edges + 1, into views
  std::vector<std::uint16_t> views;         // indices of viewpoints, ascending
};
// Collects the occlusions of several viewpoints. Overlaps smaller than `least_area` (square radii) do not
// count. Of two faces that intersect, the one that hides more counts as the front one.
RegionOcclusions collect_edges(std::span<const ViewpointEdges* const> views, std::size_t triangle_count,
                               float least_area);

struct RegionProblem {
  const Mesh* mesh = nullptr;
  std::vector<Eye> eyes;  // one per viewpoint
  RegionOcclusions edges;
  std::vector<std::uint8_t> drawn;   // per node: 1 if the region can see it
  std::vector<std::uint32_t> ranks;  // per node: the order to start with
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
