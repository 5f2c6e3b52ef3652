// The vertex cache that every order is optimised for: first in, first out.
#pragma once

#include <cstdint>
#include <vector>

#include "pellucid/sequencing.h"

namespace pellucid {

// A FIFO of `size` vertices. A vertex stays in it until `size` misses have followed its own, so that the
// number of misses is the only clock that is needed. Every use takes O(1).
class FifoCache {
 public:
  FifoCache(std::size_t vertex_count, std::uint32_t size) : leaves_at_(vertex_count, 0), size_(size) {}

  // Returns 1 for a miss, and 0 for a vertex that was in the cache.
  std::uint32_t use(std::uint32_t vertex) {
    if (clock_ < leaves_at_[vertex]) return 0;
    leaves_at_[vertex] = ++clock_ + size_;
    ++misses_;
    return 1;
  }
  // Returns the misses of a triangle.
  std::uint32_t draw(const Triangle& triangle) {
    return use(triangle[0]) + use(triangle[1]) + use(triangle[2]);
  }
  // Empties the cache.
  void flush() { clock_ += size_; }
  // All misses so far.
  [[nodiscard]] std::uint64_t misses() const { return misses_; }

 private:
  std::vector<std::uint64_t> leaves_at_;  // by vertex: the clock at which it has left the cache
  std::uint64_t clock_ = 0;               // misses, and `size_` more for every flush
  std::uint64_t misses_ = 0;
  std::uint32_t size_;
};

// Returns the misses of a sequence of nodes.
std::uint64_t fifo_misses(const Mesh& mesh, const NodeSequence& sequence, std::uint32_t cache_size);

}  // namespace pellucid
