// Compact sets of triangles: see compact_sets.h.
#include "overdraw/compact_sets.h"

#include <algorithm>

namespace pellucid {
namespace {

constexpr int kGrowths = 6;
constexpr std::uint64_t kTrials = 100;  // of moving a triangle, each
// Sizes stay within these multiples of what was asked for.
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
  // All seeds at once; what none of them reaches gets seeds of its own.
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

  // A seed goes to the triangle that is farthest from other sets.
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

}  // namespace pellucid
