// Cuts the triangles of a mesh into compact sets with few vertices, and finds a short run for the vertex
// cache through each set. compact_patches() builds on these.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "pellucid/base.h"
#include "pellucid/metric.h"
#include "pellucid/overdraw.h"

namespace pellucid {

// ----------------------------------------------------------------------------------- links between triangles

// The neighbours of every triangle: which triangles of the same part share vertices and edges.

class MeshLinks {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  explicit MeshLinks(const OverdrawSubject& subject);

  [[nodiscard]] std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(corners_.size()); }
  [[nodiscard]] std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(offsets_.size() - 1); }
  // Returns the distinct vertices of a triangle.
  [[nodiscard]] std::span<const std::uint32_t> corners(std::uint32_t triangle) const {
    return std::span(corners_[triangle]).first(corner_counts_[triangle]);
  }
  // Returns the triangles at a vertex, ascending.
  [[nodiscard]] std::span<const std::uint32_t> around(std::uint32_t vertex) const {
    return std::span(around_).subspan(offsets_[vertex], offsets_[vertex + 1] - offsets_[vertex]);
  }
  // Returns the triangles of the same part across the edges that exactly two triangles share. Unused entries
  // are kNone.
  [[nodiscard]] const std::array<std::uint32_t, 3>& across(std::uint32_t triangle) const {
    return across_[triangle];
  }

 private:
  std::vector<Triangle> corners_;
  std::vector<std::uint8_t> corner_counts_;
  std::vector<std::uint32_t> offsets_, around_;
  std::vector<std::array<std::uint32_t, 3>> across_;
};

// ---------------------------------------------------------------------------------------------- compact sets

// Returns the set of every triangle. The sets are compact, that is, they have few vertices for their
// triangles. They have about `size` triangles each, belong to one part, and are numbered by their first
// triangles. They are grown from seeds (Lloyd's iteration). Then triangles move to the set of a neighbour
// where that does not increase the sum of the vertices of all sets. Deterministic.
std::vector<std::uint32_t> compact_sets(const MeshLinks& links, double size, Random& random);

// Returns the number of vertices that are saved by moving a triangle to the set `to`: the vertices that it
// alone uses in its own set, minus those that it would add to the other.
int vertices_saved(const MeshLinks& links, const std::vector<std::uint32_t>& set_of, std::uint32_t triangle,
                   std::uint32_t to);

// ------------------------------------------------------------------------------------------------ short runs

// Orders a few dozen triangles so that hardly any vertex is missed twice. It walks greedily from several
// starts. The next triangle is one with few misses whose vertices are about to leave the FIFO cache. Use one
// object per thread; results do not depend on earlier calls.
class RunFinder {
 public:
  RunFinder(const MeshLinks& links, std::uint32_t cache_size);

  // Returns these triangles in an order with few misses, starting with an empty cache.
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
