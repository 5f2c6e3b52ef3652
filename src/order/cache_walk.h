// A cache-friendly triangle order by walking from vertex to vertex, each time the cheapest in the cache.
//
// After Lin, Yu, "An Improved Vertex Caching Scheme for 3D Mesh Rendering", TVCG 12(4), 2006: of all vertices
// in the cache, the one goes next whose fan costs few misses, finishes many triangles and would soon be lost.
// Differs in: the fan's own triangles go by how many of their corners are cached, and a vertex that its own
// fan would push out of the cache is put off.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/mesh.h"

namespace pellucid {

struct WalkWeights {
  double misses, triangles, freshness;  // cost of a miss, worth of a triangle, cost of a vertex just entered
};
// Triangles `begin` .. `end` - 1. O(triangles * cache_size * valence).
std::vector<std::uint32_t> cache_walk(std::span<const Triangle> triangles, std::uint32_t begin,
                                      std::uint32_t end, std::uint32_t vertex_count, std::uint32_t cache_size,
                                      const WalkWeights& weights);

}  // namespace pellucid
