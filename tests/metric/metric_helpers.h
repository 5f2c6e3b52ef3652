// Makes scenes with known answers for the tests of the module `metric`.
#pragma once

#include <algorithm>
#include <numeric>

#include "pellucid/metric.h"
#include "raster/raster_helpers.h"

namespace pellucid::testing {

// Two squares that face +z: a small one in front of the middle of a large one.
// Triangles 0, 1: the large one, [-0.5, 0.5]^2 at z = 0; 2, 3: the small one, [-0.25, 0.25]^2 at z = 0.25.
inline Mesh two_quads() {
  Mesh mesh;
  const auto add = [&](float half, float z) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(),
                          {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  };
  add(0.5F, 0.0F);
  add(0.25F, 0.25F);
  return mesh;
}

// Sees [-1, 1]^2 from z = 1 along -z; depth = (1 - z) / 2.
inline Camera front_camera(std::uint32_t size) {
  return front_camera(size, size);
}

// Both facings of every triangle, in file order.
inline NodeSequence file_order(const Mesh& mesh) {
  NodeSequence nodes(2 * mesh.triangles.size());
  std::iota(nodes.begin(), nodes.end(), 0U);
  return nodes;
}

}  // namespace pellucid::testing
