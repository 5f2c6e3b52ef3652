// Measures the errors of an order set in images, over held-out viewpoints. In: a mesh, the order of every
// view cell, and the valid range of the orders. Out: the mean errors.
#pragma once

#include <cstdint>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/view.h"

namespace pellucid {

// The camera distances for which orders are declared valid, in bounding radii.
struct ValidRange {
  double from, to;
};

// Mean errors over the held-out viewpoints.
struct OrderError {
  double ipr = 0;       // share of the covered pixels that are in a wrong order
  double psnr = -1;     // dB; -1: not measured
  double repaired = 0;  // share of the covered pixels that verified blending repairs
};

struct ValidationOptions {
  std::uint32_t viewpoints = 96;
  std::uint32_t size = 512;                   // pixels per side
  double min_distance = 2, max_distance = 5;  // bounding radii
  bool front_only = false;                    // the mesh is single-sided: cull back faces
  std::uint64_t seed = 1;
  // The opacity of the faces in the images that the PSNR is measured on. 0: do not measure the PSNR.
  double image_alpha = 0;
  const Progress* progress = nullptr;  // asked only whether to stop
};

// Returns the options for viewpoints within the paper's 2 to 5 radii, limited to `range`. They are seeded
// differently from everything that makes orders.
ValidationOptions held_out_viewpoints(const ValidRange& range, bool front_only, std::uint64_t seed,
                                      const Progress* progress);

// Measures the errors when every view is drawn in the order of its cell. `cluster_of` has the order of every
// cell, and `ranks` has for each order the ranks of all nodes. Takes O(viewpoints * raster).
OrderError measure_order_error(const Mesh& mesh, const BoundingSphere& sphere, const ViewPartition& partition,
                               const std::vector<std::uint32_t>& cluster_of,
                               const std::vector<std::vector<std::uint32_t>>& ranks,
                               const ValidationOptions& options);

}  // namespace pellucid
