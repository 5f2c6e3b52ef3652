// Tests the vertex-cache simulation: literal cases, naive lists, and the analyser of meshoptimizer.
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <list>

#include "metric/metric_helpers.h"

namespace pellucid {
namespace {

std::uint64_t naive_misses(std::span<const std::uint32_t> indices, CacheModel model, std::size_t size) {
  std::list<std::uint32_t> cache;
  std::uint64_t misses = 0;
  for (const std::uint32_t v : indices) {
    const auto found = std::find(cache.begin(), cache.end(), v);
    if (found == cache.end()) {
      ++misses;
      cache.push_back(v);
      if (cache.size() > size) cache.pop_front();
    } else if (model == CacheModel::lru) {
      cache.erase(found);
      cache.push_back(v);
    }
  }
  return misses;
}

// Returns indices that often repeat recent ones, like those of a mesh.
std::vector<std::uint32_t> local_indices(std::size_t triangles, std::uint32_t vertices, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < triangles; ++i) {
    const std::size_t middle = i * vertices / triangles;
    for (int k = 0; k < 3; ++k) {
      indices.push_back(static_cast<std::uint32_t>((middle + random.below(40)) % vertices));
    }
  }
  return indices;
}

TEST(VertexCache, CountsTheMissesOfAStrip) {
  const std::vector<std::uint32_t> strip{0, 1, 2, 2, 1, 3, 2, 3, 4};
  const CacheStatistics s = simulate_vertex_cache(strip, 5, CacheModel::fifo, 16);
  EXPECT_EQ(s.misses, 5U);
  EXPECT_DOUBLE_EQ(s.acmr, 5.0 / 3);
  EXPECT_DOUBLE_EQ(s.atvr, 1.0);
}

TEST(VertexCache, FifoEvictsWhatLruKeeps) {
  // Vertex 0 is used repeatedly, but it entered the cache of three first.
  const std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3, 0, 3, 4};
  EXPECT_EQ(simulate_vertex_cache(indices, 5, CacheModel::lru, 3).misses, 5U);
  EXPECT_EQ(simulate_vertex_cache(indices, 5, CacheModel::fifo, 3).misses, 6U);
}

TEST(VertexCache, EqualsNaiveListsAndMeshoptimizer) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const std::vector<std::uint32_t> indices = local_indices(500, 300, seed);
    for (const std::uint32_t size : {3U, 14U, 16U, 20U, 32U, 1000U}) {
      const CacheStatistics fifo = simulate_vertex_cache(indices, 300, CacheModel::fifo, size);
      const CacheStatistics lru = simulate_vertex_cache(indices, 300, CacheModel::lru, size);
      EXPECT_EQ(fifo.misses, naive_misses(indices, CacheModel::fifo, size));
      EXPECT_EQ(lru.misses, naive_misses(indices, CacheModel::lru, size));
      const meshopt_VertexCacheStatistics peer =
          meshopt_analyzeVertexCache(indices.data(), indices.size(), 300, size, 0, 0);
      EXPECT_EQ(fifo.misses, peer.vertices_transformed);
      EXPECT_FLOAT_EQ(static_cast<float>(fifo.acmr), peer.acmr);
    }
  }
}

TEST(VertexCache, AtvrCountsOnlyUsedVertices) {
  EXPECT_DOUBLE_EQ(simulate_vertex_cache(std::vector<std::uint32_t>{7, 8, 9}, 100, CacheModel::fifo, 16).atvr,
                   1.0);
}

TEST(VertexCache, AcceptsEmptyListsAndRejectsInvalidOnes) {
  EXPECT_EQ(simulate_vertex_cache({}, 0, CacheModel::fifo, 16).misses, 0U);
  EXPECT_THROW(simulate_vertex_cache({}, 0, CacheModel::fifo, 2), Error);
  EXPECT_THROW(simulate_vertex_cache(std::vector<std::uint32_t>{0, 1}, 2, CacheModel::fifo, 16), Error);
  EXPECT_THROW(simulate_vertex_cache(std::vector<std::uint32_t>{0, 1, 2}, 2, CacheModel::lru, 16), Error);
}

}  // namespace
}  // namespace pellucid
