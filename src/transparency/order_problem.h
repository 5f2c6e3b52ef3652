// Builds the problem that the clustering methods work on: one mesh, its view partition and its occlusion
// graph. Also computes the valid range of orders, the nodes that a set of cells can see, and the base order.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "metric/validation.h"
#include "pellucid/mesh.h"
#include "pellucid/transparency.h"
#include "pellucid/view.h"
#include "transparency/graph/occlusion_graph.h"
#include "transparency/run_records.h"

namespace pellucid {

struct OrderProblem {
  const Mesh* mesh = nullptr;
  BoundingSphere sphere;
  ViewPartition partition;
  OcclusionGraph graph;
};

// Builds the occlusion graph of `mesh` over `partition`. `tolerance` replaces options.tolerance.
OrderProblem make_problem(const Mesh& mesh, const PartitionSpec& partition, const OrderOptions& options,
                          double tolerance, const RunRecords& records = {});

// Returns the camera distances for which orders sampled at `distances` are declared valid.
ValidRange valid_range(PartitionKind kind, const std::vector<double>& distances);
// Returns the distances of the viewpoints of which T[n] and R[n] know all occlusions.
ValidRange solid_range(PartitionKind kind, const std::vector<double>& distances);

// Returns one flag per node that says whether some of the cells can see it from a distance within `range`.
// Conservative: a node that can be seen is never left out.
std::vector<std::uint8_t> visible_nodes(const OrderProblem& problem, const std::vector<std::uint32_t>& cells,
                                        const ValidRange& range, Facing facing);

// Returns the position of every triangle in the order of an unconstrained vertex-cache optimisation.
std::vector<std::uint32_t> cache_positions(const Mesh& mesh);

// Returns one order of all triangles for every view, back to front, for viewers that know of no other orders:
// every triangle of `mesh` once, as stored. Runs of cache-friendly triangles are sorted by the best single
// order of `coarse`, which is the same mesh or a simpler one.
std::vector<std::uint32_t> base_order(const Mesh& mesh, const OrderProblem& coarse);

}  // namespace pellucid
