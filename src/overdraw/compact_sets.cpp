// Implements compact_sets.h: grows compact sets of triangles from seeds, and finds short runs through them.
#include "overdraw/compact_sets.h"

#include <algorithm>
#include <limits>
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

  // Equal edges are adjacent.
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

// ---------------------------------------------------------------------------------------------- compact sets

namespace {

constexpr int kGrowths = 6;
constexpr std::uint64_t kTrials = 100;  // how often the move of a triangle is tried, per triangle
// Sizes stay within these multiples of the requested size.
constexpr double kLeast = 0.5, kMost = 1.5;

class SetGrower {
 public:
  SetGrower(const MeshLinks& links, double size, Random& random) : links_(links), size_(size) {
    const auto count = std::max(1.0, static_cast<double>(links.triangle_count()) / size);
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i)
      seeds_.push_back(static_cast<std::uint32_t>(random.below(links.triangle_count())));
    for (int i = 0; i < kGrowths; ++i) {
      if (i > 0) recentre();
      grow();
    }
    relax(random);
  }

  [[nodiscard]] std::vector<std::uint32_t> numbered() const {
    std::vector<std::uint32_t> numbers(seeds_.size(), MeshLinks::kNone), result;
    std::uint32_t count = 0;
    for (const std::uint32_t set : set_of_) {
      if (numbers[set] == MeshLinks::kNone) numbers[set] = count++;
      result.push_back(numbers[set]);
    }
    return result;
  }

 private:
  // Grows all sets at once. Triangles that no seed reaches get seeds of their own.
  void grow() {
    set_of_.assign(links_.triangle_count(), MeshLinks::kNone);
    std::vector<std::uint32_t> queue;
    const auto put = [&](std::uint32_t triangle, std::uint32_t set) {
      if (set_of_[triangle] != MeshLinks::kNone) return;
      set_of_[triangle] = set;
      queue.push_back(triangle);
    };
    for (std::uint32_t set = 0; set < seeds_.size(); ++set) put(seeds_[set], set);
    std::size_t head = 0;
    for (std::uint32_t left = 0; left < links_.triangle_count(); ++left) {
      for (; head < queue.size(); ++head) {
        for (const std::uint32_t next : links_.across(queue[head])) {
          if (next != MeshLinks::kNone) put(next, set_of_[queue[head]]);
        }
      }
      if (set_of_[left] != MeshLinks::kNone) continue;
      put(left, static_cast<std::uint32_t>(seeds_.size()));
      seeds_.push_back(left);
    }
  }

  // Moves each seed to the triangle that is farthest from other sets.
  void recentre() {
    std::vector<std::uint8_t> met(set_of_.size(), 0);
    std::vector<std::uint32_t> queue;
    for (std::uint32_t t = 0; t < set_of_.size(); ++t) {
      for (const std::uint32_t next : links_.across(t)) {
        if (next == MeshLinks::kNone || set_of_[next] == set_of_[t] || met[t] != 0) continue;
        met[t] = 1;
        queue.push_back(t);
      }
    }
    for (std::size_t head = 0; head < queue.size(); ++head) {
      for (const std::uint32_t next : links_.across(queue[head])) {
        if (next == MeshLinks::kNone || met[next] != 0) continue;
        met[next] = 1;
        queue.push_back(next);
      }
    }
    for (const std::uint32_t triangle : queue) seeds_[set_of_[triangle]] = triangle;
  }

  void relax(Random& random) {
    std::vector<std::uint32_t> sizes(seeds_.size(), 0);
    for (const std::uint32_t set : set_of_) ++sizes[set];
    for (std::uint64_t i = 0; i < kTrials * set_of_.size(); ++i) {
      const auto triangle = static_cast<std::uint32_t>(random.below(set_of_.size()));
      const std::uint32_t beside = links_.across(triangle)[random.below(3)];
      if (beside == MeshLinks::kNone || set_of_[beside] == set_of_[triangle]) continue;
      std::uint32_t& from = sizes[set_of_[triangle]];
      std::uint32_t& to = sizes[set_of_[beside]];
      if (from <= kLeast * size_ || to >= kMost * size_) continue;
      if (vertices_saved(links_, set_of_, triangle, set_of_[beside]) < 0) continue;
      set_of_[triangle] = set_of_[beside];
      --from;
      ++to;
    }
  }

  const MeshLinks& links_;
  double size_;
  std::vector<std::uint32_t> seeds_, set_of_;
};

}  // namespace

int vertices_saved(const MeshLinks& links, const std::vector<std::uint32_t>& set_of, std::uint32_t triangle,
                   std::uint32_t to) {
  int saved = 0;
  for (const std::uint32_t vertex : links.corners(triangle)) {
    int own = 0;
    bool there = false;
    for (const std::uint32_t other : links.around(vertex)) {
      if (set_of[other] == set_of[triangle]) ++own;
      there = there || set_of[other] == to;
    }
    saved += (own == 1 ? 1 : 0) - (there ? 0 : 1);
  }
  return saved;
}

std::vector<std::uint32_t> compact_sets(const MeshLinks& links, double size, Random& random) {
  return SetGrower(links, size, random).numbered();
}

// ------------------------------------------------------------------------------------------------ short runs

namespace {

constexpr std::size_t kRunStarts = 16;
// The gain of a triangle, in misses, for a vertex that it is the last to use, and for a vertex that is about
// to leave the cache.
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

// Returns the misses of a walk. Gives up and returns `least` or more if the walk cannot be better.
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

// Returns the best triangle that has a vertex in the cache. `late`: vertices hardly count before they are
// about to leave.
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
