// Short cache-friendly sequences: see run_finder.h.
#include "overdraw/run_finder.h"

#include <algorithm>
#include <limits>

namespace pellucid {
namespace {

constexpr std::size_t kRunStarts = 16;
// What speaks for a triangle, in misses: a vertex that it is the last to use; one that is about to leave.
constexpr double kLastUse = 0.25, kUrgency = 0.5;

}  // namespace

RunFinder::RunFinder(const MeshLinks& links, std::uint32_t cache_size)
    : links_(links),
      cache_size_(cache_size),
      leaves_at_(links.vertex_count(), 0),
      left_(links.vertex_count(), 0),
      to_draw_(links.triangle_count(), 0),
      looked_at_(links.triangle_count(), 0) {}

std::vector<std::uint32_t> RunFinder::find(std::span<const std::uint32_t> triangles) {
  // No run has fewer misses than vertices.
  std::uint32_t vertices = 0;
  for (const std::uint32_t triangle : triangles) {
    for (const std::uint32_t vertex : links_.corners(triangle)) left_[vertex] = 0;
  }
  for (const std::uint32_t triangle : triangles) {
    for (const std::uint32_t vertex : links_.corners(triangle)) vertices += left_[vertex]++ == 0 ? 1U : 0U;
  }
  std::vector<std::uint32_t> best;
  std::uint32_t least = MeshLinks::kNone;
  const std::size_t step = (triangles.size() + kRunStarts - 1) / kRunStarts;
  for (const bool late : {false, true}) {
    for (std::size_t i = 0; i < triangles.size() && least > vertices; i += step) {
      const std::uint32_t misses = walk(triangles, triangles[i], late, least);
      if (misses >= least) continue;
      least = misses;
      best = run_;
    }
  }
  return best;
}

// Misses; `least` or more where it was given up.
std::uint32_t RunFinder::walk(std::span<const std::uint32_t> triangles, std::uint32_t start, bool late,
                              std::uint32_t least) {
  ++walk_;
  clock_ += cache_size_;  // empties the cache
  for (const std::uint32_t triangle : triangles) {
    to_draw_[triangle] = walk_;
    for (const std::uint32_t vertex : links_.corners(triangle)) left_[vertex] = 0;
  }
  for (const std::uint32_t triangle : triangles) {
    for (const std::uint32_t vertex : links_.corners(triangle)) ++left_[vertex];
  }
  run_.clear();
  entered_.clear();
  draw(start);
  std::size_t first_left = 0;
  while (run_.size() < triangles.size() && entered_.size() < least) {
    std::uint32_t next = best_next(late);
    for (; next == MeshLinks::kNone; ++first_left) {
      if (to_draw_[triangles[first_left]] == walk_) next = triangles[first_left];
    }
    draw(next);
  }
  return run_.size() < triangles.size() ? least : static_cast<std::uint32_t>(entered_.size());
}

void RunFinder::draw(std::uint32_t triangle) {
  to_draw_[triangle] = 0;
  run_.push_back(triangle);
  for (const std::uint32_t vertex : links_.corners(triangle)) {
    --left_[vertex];
    if (is_cached(vertex)) continue;
    leaves_at_[vertex] = ++clock_ + cache_size_;
    entered_.push_back(vertex);
  }
}

// Of what has a vertex in the cache; `late`: vertices hardly count before they are about to leave.
std::uint32_t RunFinder::best_next(bool late) {
  ++step_;
  std::uint32_t best = MeshLinks::kNone;
  double least = std::numeric_limits<double>::max();
  const std::size_t cached = std::min<std::size_t>(entered_.size(), cache_size_);
  for (std::size_t i = entered_.size() - cached; i < entered_.size(); ++i) {
    if (left_[entered_[i]] == 0) continue;
    for (const std::uint32_t triangle : links_.around(entered_[i])) {
      if (to_draw_[triangle] != walk_ || looked_at_[triangle] == step_) continue;
      looked_at_[triangle] = step_;
      double cost = 0;
      for (const std::uint32_t vertex : links_.corners(triangle)) {
        if (!is_cached(vertex)) {
          cost += 1;
          continue;
        }
        const double age =
            1 - static_cast<double>(leaves_at_[vertex] - clock_) / static_cast<double>(cache_size_);
        cost -= kUrgency * (late ? age * age : age) + (left_[vertex] == 1 ? kLastUse : 0);
      }
      if (cost >= least) continue;
      least = cost;
      best = triangle;
    }
  }
  return best;
}

}  // namespace pellucid
