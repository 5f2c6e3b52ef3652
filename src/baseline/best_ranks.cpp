// The best order of a single view: see pellucid/baseline.h.
#include <algorithm>

#include "pellucid/baseline.h"
#include "pellucid/sequencing.h"
#include "sequencing/edge_rows.h"
#include "sequencing/linear_order.h"
#include "transparency/graph/viewpoint_edges.h"

namespace pellucid {
namespace {

// The edges of a viewpoint in rows by node: an even node stands for the facing that the viewpoint sees.
EdgeRows rows_by_node(const ViewpointEdges& edges) {
  EdgeRows rows;
  rows.offsets.push_back(0);
  for (std::size_t t = 0; t + 1 < edges.offsets.size(); ++t) {
    for (std::uint8_t facing = 0; facing < 2; ++facing) {
      if (edges.front_flipped[t] == facing) {
        for (std::uint32_t i = edges.offsets[t]; i < edges.offsets[t + 1]; ++i) {
          rows.backs.push_back(edges.backs[i]);
          rows.weights.push_back(edges.areas[i]);
        }
      }
      rows.offsets.push_back(static_cast<std::uint32_t>(rows.backs.size()));
    }
  }
  return rows;
}

// Edges within the components alone.
EdgeRows inner_edges(const EdgeRows& rows, const std::vector<std::uint32_t>& component) {
  EdgeRows inner;
  inner.offsets.push_back(0);
  for (NodeId front = 0; front < rows.node_count(); ++front) {
    for (std::uint32_t i = rows.offsets[front]; i < rows.offsets[front + 1]; ++i) {
      if (component[front] != component[rows.backs[i]]) continue;
      inner.backs.push_back(rows.backs[i]);
      inner.weights.push_back(rows.weights[i]);
    }
    inner.offsets.push_back(static_cast<std::uint32_t>(inner.backs.size()));
  }
  return inner;
}

}  // namespace

std::vector<std::uint32_t> best_ranks(const Mesh& mesh, const BoundingSphere& sphere,
                                      const Viewpoint& viewpoint, std::uint32_t raster_size, Facing facing) {
  const OcclusionScene scene{mesh, sphere, {}, facing == Facing::single, 0, raster_size};
  OcclusionScratch scratch;
  ViewpointEdges edges;
  find_edges_by_raster(scene, viewpoint, scratch, edges);
  const EdgeRows rows = rows_by_node(edges);
  const std::vector<std::uint32_t> component = strong_components(rows.offsets, rows.backs);

  // Edges between components lead to smaller numbers: the largest number is in front of all.
  std::vector<double> keys(component.size());
  std::transform(component.begin(), component.end(), keys.begin(),
                 [](std::uint32_t number) { return -static_cast<double>(number); });
  std::vector<std::uint32_t> ranks = ranks_by_key(keys);
  const EdgeRows inner = inner_edges(rows, component);
  if (inner.edge_count() == 0) return ranks;

  // Sift every component by itself: what its members wish of each other is all that is at stake.
  SiftOptions sifting;
  sifting.sweeps = 20;
  sifting.least_gain = 0;
  std::vector<std::uint32_t> sifted = ranks;
  sift(net_preferences(inner), sifting, sifted);
  for (NodeId node = 0; node < keys.size(); ++node)
    keys[node] += static_cast<double>(sifted[node]) / (2.0 * static_cast<double>(keys.size()));
  return ranks_by_key(keys);
}

}  // namespace pellucid
