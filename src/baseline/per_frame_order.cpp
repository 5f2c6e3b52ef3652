// Implements the orders of pellucid/baseline.h for one viewpoint: the sort by centroids, which a viewer
// repeats in every frame, and the best order of a single view.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "pellucid/baseline.h"
#include "pellucid/sequencing.h"
#include "sequencing/edge_rows.h"
#include "sequencing/linear_order.h"
#include "transparency/graph/viewpoint_edges.h"

namespace pellucid {

// --------------------------------------------------------------------------------------------- centroid sort

namespace {

constexpr unsigned kDigitBits = 11;  // three passes over 32 bits, counters that fit the first-level cache
constexpr unsigned kDigitPasses = 3;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
constexpr unsigned kKeyShift = 32;  // the key is the upper half

// Returns an unsigned number for a float. The numbers have the same order as the floats.
std::uint32_t ordered_bits(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

std::size_t digit_of(std::uint64_t keyed, unsigned pass) {
  return (keyed >> (kKeyShift + pass * kDigitBits)) & (kDigits - 1);
}

void radix_sort(std::vector<std::uint64_t>& keyed, std::vector<std::uint64_t>& swapped) {
  std::array<std::array<std::uint32_t, kDigits>, kDigitPasses> counts{};
  for (const std::uint64_t k : keyed) {
    for (unsigned pass = 0; pass < kDigitPasses; ++pass) ++counts[pass][digit_of(k, pass)];
  }
  swapped.resize(keyed.size());
  for (unsigned pass = 0; pass < kDigitPasses; ++pass) {
    std::uint32_t place = 0;
    for (std::uint32_t& count : counts[pass]) {
      const std::uint32_t here = count;
      count = place;
      place += here;
    }
    for (const std::uint64_t k : keyed) swapped[counts[pass][digit_of(k, pass)]++] = k;
    std::swap(keyed, swapped);
  }
}

}  // namespace

CentroidSort::CentroidSort(const Mesh& mesh, const BoundingSphere& sphere) : center_(sphere.center) {
  centroids_.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    Vec3d sum{};
    for (const std::uint32_t v : t) sum += to_double(mesh.positions[v]) - center_;
    centroids_.push_back(to_float(sum / 3.0));
  }
}

void CentroidSort::sort(const Eye& eye, Scratch& scratch, std::vector<std::uint32_t>& triangles) const {
  const bool orthographic = eye.w == 0;
  const Vec3f at = to_float(orthographic ? eye.at : eye.at - center_);
  scratch.keyed.resize(centroids_.size());
  for (std::size_t t = 0; t < centroids_.size(); ++t) {
    const Vec3f to_eye = at - centroids_[t];
    const float distance = orthographic ? -dot(centroids_[t], at) : dot(to_eye, to_eye);
    scratch.keyed[t] = std::uint64_t{ordered_bits(distance)} << kKeyShift | t;
  }
  radix_sort(scratch.keyed, scratch.swapped);
  triangles.resize(scratch.keyed.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    triangles[i] = static_cast<std::uint32_t>(scratch.keyed[i]);
}

NodeSequence centroid_sorted(const Mesh& mesh, const BoundingSphere& sphere, const Viewpoint& viewpoint) {
  const Eye eye = eye_of(sphere, viewpoint);
  CentroidSort::Scratch scratch;
  NodeSequence sequence;
  CentroidSort(mesh, sphere).sort(eye, scratch, sequence);
  for (NodeId& entry : sequence) {
    const Triangle& t = mesh.triangles[entry];
    const Vec3d a = to_double(mesh.positions[t[0]]);
    const Vec3d b = to_double(mesh.positions[t[1]]);
    const Vec3d c = to_double(mesh.positions[t[2]]);
    entry = node_of(entry, dot(cross(b - a, c - a), eye.at - a * eye.w) < 0);
  }
  return sequence;
}

// -------------------------------------------------------------------------------- the best order of one view

namespace {

// Returns the edges of a viewpoint in rows by node.
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

// Returns the edges inside components.
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

  // Sift every component by itself. Only edges between its members can still be violated.
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
