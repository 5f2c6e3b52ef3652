// Implements the vertex-cache statistics of pellucid/sequencing.h: simulates a post-transform cache and
// computes ACMR and ATVR.
//
// Definitions: Sander, Nehab, Barczak, "Fast Triangle Reordering for Vertex Locality and Reduced Overdraw",
// SIGGRAPH 2007.
#include <algorithm>
#include <string>

#include "pellucid/sequencing.h"
#include "sequencing/fifo_cache.h"

namespace pellucid {
namespace {

std::uint64_t count_fifo_misses(std::span<const std::uint32_t> indices, std::uint32_t vertex_count,
                                std::uint32_t size) {
  FifoCache cache(vertex_count, size);
  for (const std::uint32_t vertex : indices) cache.use(vertex);
  return cache.misses();
}

// Replaces the least recently used vertex.
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
                "vertex cache of " + std::to_string(cache_size) + " vertices: use at least 3");
  }
  if (indices.size() % 3 != 0) {
    throw Error(ErrorKind::bad_argument,
                std::to_string(indices.size()) + " indices: a triangle list needs a multiple of 3");
  }
  for (const std::uint32_t vertex : indices) {
    if (vertex < vertex_count) continue;
    throw Error(ErrorKind::bad_argument, "index " + std::to_string(vertex) + " is out of range: there are " +
                                             std::to_string(vertex_count) + " vertices");
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

BufferStatistics sequence_statistics(const Mesh& mesh, std::span<const NodeId> order, CacheModel model,
                                     std::uint32_t cache_size) {
  BufferStatistics statistics;
  if (order.empty()) return statistics;
  const std::vector<std::uint32_t> indices = index_buffer(mesh, order);
  const CacheStatistics cache =
      simulate_vertex_cache(indices, static_cast<std::uint32_t>(mesh.positions.size()), model, cache_size);
  std::vector<bool> seen(mesh.triangles.size(), false);
  std::uint64_t distinct = 0;
  for (const NodeId node : order) {
    if (!seen[triangle_of(node)]) ++distinct;
    seen[triangle_of(node)] = true;
  }
  statistics.triangles = order.size();
  statistics.misses = cache.misses;
  statistics.acmr = cache.acmr;
  statistics.acmr_drawn = static_cast<double>(cache.misses) / static_cast<double>(distinct);
  return statistics;
}

std::vector<BufferStatistics> buffer_statistics(const Mesh& mesh, const OrderSet& orders, CacheModel model,
                                                std::uint32_t cache_size) {
  std::vector<BufferStatistics> statistics;
  statistics.reserve(orders.orders.size());
  for (const NodeSequence& order : orders.orders) {
    statistics.push_back(sequence_statistics(mesh, order, model, cache_size));
  }
  return statistics;
}

BufferStatistics pooled(std::span<const BufferStatistics> buffers) {
  BufferStatistics sum;
  double drawn = 0;
  for (const BufferStatistics& buffer : buffers) {
    sum.triangles += buffer.triangles;
    sum.misses += buffer.misses;
    if (buffer.acmr_drawn > 0) drawn += static_cast<double>(buffer.misses) / buffer.acmr_drawn;
  }
  if (sum.triangles > 0) sum.acmr = static_cast<double>(sum.misses) / static_cast<double>(sum.triangles);
  if (drawn > 0) sum.acmr_drawn = static_cast<double>(sum.misses) / drawn;
  return sum;
}

std::uint64_t fifo_misses(const Mesh& mesh, const NodeSequence& order, std::uint32_t cache_size) {
  FifoCache cache(mesh.positions.size(), cache_size);
  for (const NodeId node : order) cache.draw(corners_of(mesh, node));
  return cache.misses();
}

std::uint64_t cache_misses(std::span<const Triangle> triangles, std::span<const std::uint32_t> order,
                           std::uint32_t vertex_count, std::uint32_t cache_size) {
  FifoCache cache(vertex_count, cache_size);
  for (const std::uint32_t triangle : order) cache.draw(triangles[triangle]);
  return cache.misses();
}

}  // namespace pellucid
