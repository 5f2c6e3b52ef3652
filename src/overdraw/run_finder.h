// Sequences of a few dozen triangles that miss hardly any vertex twice.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "overdraw/mesh_links.h"

namespace pellucid {

// Greedy walks from several starts: the next triangle is one that misses little and whose vertices are about
// to leave the first-in first-out cache. One per thread; what it finds does not depend on what it found.
class RunFinder {
 public:
  RunFinder(const MeshLinks& links, std::uint32_t cache_size);

  // These triangles in a sequence with few misses from an empty cache.
  std::vector<std::uint32_t> find(std::span<const std::uint32_t> triangles);

 private:
  std::uint32_t walk(std::span<const std::uint32_t> triangles, std::uint32_t start, bool late,
                     std::uint32_t least);
  void draw(std::uint32_t triangle);
  [[nodiscard]] std::uint32_t best_next(bool late);
  [[nodiscard]] bool is_cached(std::uint32_t vertex) const { return clock_ < leaves_at_[vertex]; }

  const MeshLinks& links_;
  std::uint32_t cache_size_;
  std::uint64_t clock_ = 0;               // misses so far, of all walks
  std::vector<std::uint64_t> leaves_at_;  // by vertex: the clock at which it is gone
  std::vector<std::uint32_t> left_;       // by vertex: triangles of the set that are not yet drawn
  std::vector<std::uint32_t> to_draw_;    // by triangle: the walk in which it is yet to be drawn
  std::vector<std::uint64_t> looked_at_;  // by triangle: the step in which it was looked at
  std::uint32_t walk_ = 0;
  std::uint64_t step_ = 0;
  std::vector<std::uint32_t> entered_;  // vertices as they were missed
  std::vector<std::uint32_t> run_;
};

}  // namespace pellucid
