// The simulator of a first-in first-out vertex cache, for which all orders are optimised. In: vertices or
// triangles in draw order. Out: the number of cache misses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pellucid/sequencing.h"

namespace pellucid {

// A cache of `size` vertices. A vertex stays in it until `size` misses have followed its own miss, so the
// number of misses is the only clock that is needed. Every use takes O(1).
class FifoCache {
 public:
  FifoCache(std::size_t vertex_count, std::uint32_t size) : leaves_at_(vertex_count, 0), size_(size) {}

  // Uses a vertex. Returns 1 for a miss and 0 for a hit.
  std::uint32_t use(std::uint32_t vertex) {
    if (clock_ < leaves_at_[vertex]) return 0;
    leaves_at_[vertex] = ++clock_ + size_;
    ++misses_;
    return 1;
  }
  // Uses the vertices of a triangle. Returns the number of misses.
  std::uint32_t draw(const Triangle& triangle) {
    std::uint32_t misses = 0;
    for (const std::uint32_t vertex : triangle) misses += use(vertex);  // in this order
    return misses;
  }
  // Empties the cache.
  void flush() { clock_ += size_; }
  // Returns the number of misses so far.
  [[nodiscard]] std::uint64_t misses() const { return misses_; }

 private:
  std::vector<std::uint64_t> leaves_at_;  // per vertex: the clock at which it has left the cache
  std::uint64_t clock_ = 0;               // misses, plus `size_` for every flush
  std::uint64_t misses_ = 0;
  std::uint32_t size_;
};

// Returns the number of misses of an order.
std::uint64_t fifo_misses(const Mesh& mesh, const NodeSequence& order, std::uint32_t cache_size);

}  // namespace pellucid
