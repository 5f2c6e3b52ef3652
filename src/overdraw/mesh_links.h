// Which triangles share vertices and edges, within their parts.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "pellucid/metric.h"
#include "pellucid/overdraw.h"

namespace pellucid {

class MeshLinks {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  explicit MeshLinks(const OverdrawSubject& subject);

  [[nodiscard]] std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(corners_.size()); }
  [[nodiscard]] std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(offsets_.size() - 1); }
  // Distinct vertices of a triangle.
  [[nodiscard]] std::span<const std::uint32_t> corners(std::uint32_t triangle) const {
    return std::span(corners_[triangle]).first(corner_counts_[triangle]);
  }
  // Triangles at a vertex, ascending.
  [[nodiscard]] std::span<const std::uint32_t> around(std::uint32_t vertex) const {
    return std::span(around_).subspan(offsets_[vertex], offsets_[vertex + 1] - offsets_[vertex]);
  }
  // Triangles of the same part beyond the edges that two triangles share; kNone fills up.
  [[nodiscard]] const std::array<std::uint32_t, 3>& across(std::uint32_t triangle) const {
    return across_[triangle];
  }

 private:
  std::vector<Triangle> corners_;
  std::vector<std::uint8_t> corner_counts_;
  std::vector<std::uint32_t> offsets_, around_;
  std::vector<std::array<std::uint32_t, 3>> across_;
};

}  // namespace pellucid
