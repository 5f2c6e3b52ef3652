// Contiguous regions: among orders that suit a cell about equally well, the one of its neighbours.
//
// A camera that crosses a border between cells of different orders switches buffers. Fewer and shorter
// borders mean fewer switches while orbiting, and at nearly equal error they cost nothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/view.h"

namespace pellucid {

struct ContiguityOptions {
  // A cell may violate this share more than before; 0: every cell keeps its order.
  double share = 0;
  // And so much in any case, square radii: what no pixel shows.
  double floor = 0;
};

// `costs`: violated weight of every cell under every order, cells x orders, row by row. Changes `cluster_of`
// cell by cell and region by region while fewer neighbours differ; splits no region, leaves no order
// without cells. Returns the violated
// weight.
double join_neighbors(const ViewPartition& partition, std::span<const double> costs,
                      std::uint32_t order_count, const ContiguityOptions& options,
                      std::vector<std::uint32_t>& cluster_of);

// The region of every cell: connected cells of the same order, numbered by their first cells.
struct Regions {
  std::vector<std::uint32_t> region_of;
  std::uint32_t count = 0;
};
Regions find_regions(const ViewPartition& partition, std::span<const std::uint32_t> cluster_of);

// How often the order changes while the camera goes once around: mean over great circles.
double switches_per_turn(const ViewPartition& partition, std::span<const std::uint32_t> cluster_of);

}  // namespace pellucid
