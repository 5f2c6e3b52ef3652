// Triangles that share vertices and edges: see mesh_links.h.
#include "overdraw/mesh_links.h"

#include <algorithm>
#include <numeric>

#include "overdraw/patches.h"

namespace pellucid {

MeshLinks::MeshLinks(const OverdrawSubject& subject)
    : corners_(subject.triangles),
      offsets_(subject.frames.front().size() + 1, 0),
      across_(subject.triangles.size(), {kNone, kNone, kNone}) {
  for (Triangle& corners : corners_) {
    std::sort(corners.begin(), corners.end());
    corner_counts_.push_back(
        static_cast<std::uint8_t>(std::unique(corners.begin(), corners.end()) - corners.begin()));
  }
  for (std::uint32_t t = 0; t < triangle_count(); ++t) {
    for (const std::uint32_t vertex : corners(t)) ++offsets_[vertex + 1];
  }
  std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
  around_.resize(offsets_.back());
  std::vector<std::uint32_t> next(offsets_.begin(), offsets_.end() - 1);
  for (std::uint32_t t = 0; t < triangle_count(); ++t) {
    for (const std::uint32_t vertex : corners(t)) around_[next[vertex]++] = t;
  }

  // Equal edges stand side by side.
  struct Edge {
    std::uint32_t part, first, second, triangle;
    [[nodiscard]] auto key() const { return std::tuple(part, first, second); }
  };
  const std::vector<std::uint32_t> parts = part_of_triangles(subject);
  std::vector<Edge> edges;
  edges.reserve(3 * corners_.size());
  for (std::uint32_t t = 0; t < triangle_count(); ++t) {
    const auto own = corners(t);
    for (std::size_t i = 0; i < own.size(); ++i) {
      for (std::size_t j = i + 1; j < own.size(); ++j) edges.push_back({parts[t], own[i], own[j], t});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return a.key() != b.key() ? a.key() < b.key() : a.triangle < b.triangle;
  });
  const auto link = [&](std::uint32_t from, std::uint32_t to) {
    *std::find(across_[from].begin(), across_[from].end(), kNone) = to;
  };
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin + 1;
    while (end < edges.size() && edges[end].key() == edges[begin].key()) ++end;
    if (end - begin == 2) {
      link(edges[begin].triangle, edges[begin + 1].triangle);
      link(edges[begin + 1].triangle, edges[begin].triangle);
    }
    begin = end;
  }
}

}  // namespace pellucid
