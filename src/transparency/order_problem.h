// One mesh, its view partition and its occlusion graph: what the clustering methods work on.
#pragma once

#include <cstdint>
#include <vector>

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

OrderProblem make_problem(const Mesh& mesh, const PartitionSpec& partition, const OrderOptions& options,
                          double tolerance, const RunRecords& records = {});

// Camera distances for which orders sampled at `distances` are declared valid, in bounding radii.
struct ValidRange {
  double from, to;
};
ValidRange valid_range(PartitionKind kind, const std::vector<double>& distances);
// The distances of the viewpoints that T[n] and R[n] know all occlusions of.
ValidRange solid_range(PartitionKind kind, const std::vector<double>& distances);

}  // namespace pellucid
