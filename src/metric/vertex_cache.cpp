// vertex_cache.cpp - misses of a post-transform vertex cache.
//
// ACMR and ATVR as in Sander, Nehab, Barczak, "Fast Triangle Reordering for Vertex Locality and Reduced
// Overdraw", SIGGRAPH 2007.
#include <algorithm>

#include "pellucid/metric.h"

namespace pellucid {
namespace {

// First in, first out: a vertex is in the cache while fewer than `size` misses followed its own.
std::uint64_t count_fifo_misses(std::span<const std::uint32_t> indices, std::uint32_t vertex_count,
                                std::uint32_t size) {
  std::vector<std::uint64_t> leaves_at(vertex_count, 0);  // the miss count at which the vertex is gone
  std::uint64_t misses = 0;
  for (const std::uint32_t vertex : indices) {
    if (misses < leaves_at[vertex]) continue;
    ++misses;
    leaves_at[vertex] = misses + size;
  }
  return misses;
}

// The least recently used vertex makes room.
std::uint64_t count_lru_misses(std::span<const std::uint32_t> indices, std::uint32_t size) {
  std::vector<std::uint32_t> cache;  // most recent first
  cache.reserve(std::size_t{size} + 1);
  std::uint64_t misses = 0;
  for (const std::uint32_t vertex : indices) {
    const auto found = std::find(cache.begin(), cache.end(), vertex);
    if (found != cache.end()) {
      std::rotate(cache.begin(), found, found + 1);
      continue;
    }
    ++misses;
    cache.insert(cache.begin(), vertex);
    if (cache.size() > size) cache.pop_back();
  }
  return misses;
}

void check_arguments(std::span<const std::uint32_t> indices, std::uint32_t vertex_count,
                     std::uint32_t cache_size) {
  if (cache_size < 3) {
    throw Error(ErrorKind::bad_argument,
                "cache size " + std::to_string(cache_size) + ": at least 3 is needed");
  }
  if (indices.size() % 3 != 0) {
    throw Error(ErrorKind::bad_argument, std::to_string(indices.size()) + " indices are not whole triangles");
  }
  for (const std::uint32_t vertex : indices) {
    if (vertex < vertex_count) continue;
    throw Error(ErrorKind::bad_argument,
                "index " + std::to_string(vertex) + " of " + std::to_string(vertex_count) + " vertices");
  }
}

}  // namespace

CacheStatistics simulate_vertex_cache(std::span<const std::uint32_t> indices, std::uint32_t vertex_count,
                                      CacheModel model, std::uint32_t cache_size) {
  check_arguments(indices, vertex_count, cache_size);
  CacheStatistics statistics;
  if (indices.empty()) return statistics;
  statistics.misses = model == CacheModel::fifo ? count_fifo_misses(indices, vertex_count, cache_size)
                                                : count_lru_misses(indices, cache_size);
  std::vector<bool> used(vertex_count, false);
  std::uint64_t distinct = 0;
  for (const std::uint32_t vertex : indices) {
    distinct += used[vertex] ? 0U : 1U;
    used[vertex] = true;
  }
  const auto misses = static_cast<double>(statistics.misses);
  statistics.acmr = 3 * misses / static_cast<double>(indices.size());
  statistics.atvr = misses / static_cast<double>(distinct);
  return statistics;
}

}  // namespace pellucid
