// The error of orders as pixels see it, over viewpoints that no cell sampled.
#pragma once

#include <cstdint>
#include <vector>

#include "pellucid/mesh.h"
#include "pellucid/transparency.h"
#include "pellucid/view.h"
#include "transparency/error_target.h"
#include "transparency/order_problem.h"

namespace pellucid {

struct ValidationOptions {
  std::uint32_t viewpoints = 96;
  std::uint32_t size = 512;
  double min_distance = 2, max_distance = 5;
  bool front_only = false;
  std::uint64_t seed = 1;
  // Blend the pixels that are in a wrong order, with faces of this opacity, and give the PSNR, too. 0: no.
  double picture_alpha = 0;
  const Progress* progress = nullptr;
};

// The paper's 2 to 5 radii, held to the range that the orders are made for; other views than any sample.
ValidationOptions held_out_viewpoints(const ValidRange& range, bool front_only, std::uint64_t seed,
                                      const Progress* progress);

// Mean share of incorrect foreground pixels (IPR), and mean PSNR if asked for, when every view is drawn in
// the order of its cell's cluster.
OrderError measure_order_error(const Mesh& mesh, const BoundingSphere& sphere, const ViewPartition& partition,
                               const std::vector<std::uint32_t>& cluster_of,
                               const std::vector<std::vector<std::uint32_t>>& ranks,
                               const ValidationOptions& options);
inline double measure_incorrect_pixels(const Mesh& mesh, const BoundingSphere& sphere,
                                       const ViewPartition& partition,
                                       const std::vector<std::uint32_t>& cluster_of,
                                       const std::vector<std::vector<std::uint32_t>>& ranks,
                                       const ValidationOptions& options) {
  return measure_order_error(mesh, sphere, partition, cluster_of, ranks, options).ipr;
}

}  // namespace pellucid
