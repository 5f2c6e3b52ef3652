// Walking for the vertex cache: see cache_walk.h.
#include "cache_walk.h"

#include <algorithm>
#include <numeric>

namespace pellucid {
namespace {

constexpr std::uint32_t kNowhere = 0xFFFFFFFFU;
// What it costs that a vertex leaves the cache before its fan ends.
constexpr double kLostCost = 2;

class Walker {
 public:
  Walker(std::span<const Triangle> triangles, std::uint32_t begin, std::uint32_t end,
         std::uint32_t vertex_count, std::uint32_t cache_size, const WalkWeights& weights)
      : triangles_(triangles),
        weights_(weights),
        cache_size_(cache_size),
        offsets_(vertex_count + 1, 0),
        left_(vertex_count, 0),
        leaves_at_(vertex_count, 0),
        asked_at_(vertex_count, 0),
        done_(end - begin, 0),
        first_(begin) {
    for (std::uint32_t t = begin; t < end; ++t) {
      for (const std::uint32_t v : triangles[t]) ++offsets_[v + 1];
    }
    std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
    around_.resize(offsets_.back());
    for (std::uint32_t t = begin; t < end; ++t) {
      for (const std::uint32_t v : triangles[t]) around_[offsets_[v] + left_[v]++] = t;
    }
    sequence_.reserve(end - begin);
  }

  std::vector<std::uint32_t> run() {
    for (std::uint32_t vertex = after_dead_end(); vertex != kNowhere; vertex = next_vertex()) fan(vertex);
    return std::move(sequence_);
  }

 private:
  [[nodiscard]] std::span<const std::uint32_t> around(std::uint32_t vertex) const {
    return std::span(around_).subspan(offsets_[vertex], offsets_[vertex + 1] - offsets_[vertex]);
  }
  [[nodiscard]] bool cached(std::uint32_t vertex) const { return clock_ < leaves_at_[vertex]; }

  void fan(std::uint32_t vertex) {
    while (left_[vertex] > 0) {
      std::uint32_t best = kNowhere;
      int most = -1;
      for (const std::uint32_t t : around(vertex)) {
        if (done_[t - first_] != 0) continue;
        int hits = 0;
        for (const std::uint32_t v : triangles_[t]) hits += cached(v) ? 1 : 0;
        if (hits > most) {
          most = hits;
          best = t;
        }
      }
      draw(best);
    }
  }

  void draw(std::uint32_t triangle) {
    done_[triangle - first_] = 1;
    sequence_.push_back(triangle);
    for (const std::uint32_t v : triangles_[triangle]) {
      --left_[v];
      if (cached(v)) continue;
      leaves_at_[v] = ++clock_ + cache_size_;
      entered_.push_back(v);
    }
  }

  std::uint32_t next_vertex() {
    std::uint32_t best = kNowhere;
    double least = 0;
    const std::size_t oldest = entered_.size() > cache_size_ ? entered_.size() - cache_size_ : 0;
    for (std::size_t i = oldest; i < entered_.size(); ++i) {
      const std::uint32_t vertex = entered_[i];
      if (left_[vertex] == 0 || !cached(vertex)) continue;
      const double cost = cost_of(vertex);
      if (best != kNowhere && !(cost < least)) continue;
      least = cost;
      best = vertex;
    }
    return best != kNowhere ? best : after_dead_end();
  }

  double cost_of(std::uint32_t vertex) {
    ++question_;
    std::uint32_t misses = 0;
    std::uint32_t fan_size = 0;
    for (const std::uint32_t t : around(vertex)) {
      if (done_[t - first_] != 0) continue;
      ++fan_size;
      for (const std::uint32_t v : triangles_[t]) {
        if (cached(v) || asked_at_[v] == question_) continue;
        asked_at_[v] = question_;
        ++misses;
      }
    }
    const auto stays = static_cast<double>(leaves_at_[vertex] - clock_);
    const double lost = misses > stays ? kLostCost : 0;
    return weights_.misses * misses - weights_.triangles * fan_size +
           weights_.freshness * stays / cache_size_ + lost;
  }

  // The vertex last entered that has triangles left, else the first of all.
  std::uint32_t after_dead_end() {
    for (; trail_ < entered_.size(); ++trail_) recent_.push_back(entered_[trail_]);
    while (!recent_.empty()) {
      const std::uint32_t vertex = recent_.back();
      recent_.pop_back();
      if (left_[vertex] > 0) return vertex;
    }
    for (; untouched_ < left_.size(); ++untouched_) {
      if (left_[untouched_] > 0) return untouched_;
    }
    return kNowhere;
  }

  std::span<const Triangle> triangles_;
  const WalkWeights& weights_;
  std::uint32_t cache_size_;
  std::vector<std::uint32_t> offsets_, around_;  // triangles by vertex
  std::vector<std::uint32_t> left_;              // not yet drawn, by vertex
  std::vector<std::uint64_t> leaves_at_;         // clock at which the vertex is gone
  std::vector<std::uint64_t> asked_at_;
  std::vector<std::uint8_t> done_;
  std::uint32_t first_;
  std::uint64_t clock_ = 0, question_ = 0;
  std::vector<std::uint32_t> entered_, recent_;  // vertices as they missed
  std::size_t trail_ = 0;
  std::uint32_t untouched_ = 0;
  std::vector<std::uint32_t> sequence_;
};

}  // namespace

std::vector<std::uint32_t> cache_walk(std::span<const Triangle> triangles, std::uint32_t begin,
                                      std::uint32_t end, std::uint32_t vertex_count, std::uint32_t cache_size,
                                      const WalkWeights& weights) {
  return Walker(triangles, begin, end, vertex_count, cache_size, weights).run();
}

}  // namespace pellucid
