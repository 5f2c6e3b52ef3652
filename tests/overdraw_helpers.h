// Makes subjects and random lists, and has naive oracles, for the tests of overdraw orders.
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <string>
#include <vector>

#include "metric/pose_raster.h"
#include "order_helpers.h"
#include "overdraw/layer_lists.h"
#include "pellucid/metric.h"
#include "pellucid/overdraw.h"

namespace pellucid::testing {

inline OverdrawSubject subject_of(const Mesh& mesh) {
  OverdrawSubject subject;
  subject.triangles = mesh.triangles;
  subject.frames = {mesh.positions};
  return subject;
}

inline OverdrawSubject subject_of(const std::vector<Mesh>& parts) {
  Mesh all;
  std::vector<std::uint32_t> begins;
  for (const Mesh& part : parts) {
    begins.push_back(static_cast<std::uint32_t>(all.triangles.size()));
    append(all, part);
  }
  OverdrawSubject subject = subject_of(all);
  subject.parts = begins;
  return subject;
}

inline OverdrawSubject sample_subject(const std::string& name, double detail, std::uint32_t triangles) {
  return subject_of(sample_mesh(name, detail, triangles));
}

// Two spheres, a part each, that move past each other along x, one before and one behind.
inline OverdrawSubject passing_spheres(std::uint32_t level, std::uint32_t frames) {
  OverdrawSubject subject = subject_of({icosphere_mesh(level), icosphere_mesh(level)});
  const std::vector<Vec3f> start = subject.frames.front();
  subject.frames.assign(frames, start);
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    const float x =
        frames > 1 ? -1.5F + 3.0F * static_cast<float>(frame) / static_cast<float>(frames - 1) : 0;
    for (std::size_t i = 0; i < start.size(); ++i) {
      const float side = i < start.size() / 2 ? 1.0F : -1.0F;
      subject.frames[frame][i] += Vec3f{side * x, 0, side * 1.1F};
    }
  }
  return subject;
}

// Poses that a twist about y makes.
inline OverdrawSubject twisted(OverdrawSubject subject, std::uint32_t frames) {
  const std::vector<Vec3f> start = subject.frames.front();
  subject.frames.assign(frames, start);
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    for (Vec3f& p : subject.frames[frame]) {
      const float turn = 0.6F * static_cast<float>(frame) * p.y;
      p = {p.x * std::cos(turn) - p.z * std::sin(turn), p.y, p.x * std::sin(turn) + p.z * std::cos(turn)};
    }
  }
  return subject;
}

// A vertex cache as a queue.
class QueueCache {
 public:
  explicit QueueCache(std::size_t size) : size_(size) {}
  std::uint32_t draw(const Triangle& triangle) {
    std::uint32_t misses = 0;
    for (const std::uint32_t vertex : triangle) {
      if (std::find(queue_.begin(), queue_.end(), vertex) != queue_.end()) continue;
      ++misses;
      queue_.push_back(vertex);
      if (queue_.size() > size_) queue_.pop_front();
    }
    return misses;
  }
  void clear() { queue_.clear(); }

 private:
  std::size_t size_;
  std::deque<std::uint32_t> queue_;
};

inline std::uint64_t queue_misses(const std::vector<Triangle>& triangles,
                                  const std::vector<std::uint32_t>& sequence, std::size_t cache_size) {
  QueueCache cache(cache_size);
  std::uint64_t misses = 0;
  for (const std::uint32_t t : sequence) misses += cache.draw(triangles[t]);
  return misses;
}

// Are the triangles (or patches) of every part drawn one after the other?
inline bool parts_stay_together(const std::vector<std::uint32_t>& sequence,
                                const std::vector<std::uint32_t>& parts) {
  std::vector<std::uint32_t> met;
  for (const std::uint32_t item : sequence) {
    if (!met.empty() && met.back() == parts[item]) continue;
    if (std::find(met.begin(), met.end(), parts[item]) != met.end()) return false;
    met.push_back(parts[item]);
  }
  return true;
}

// Fragments drawn one after the other by rank, with a depth buffer.
struct Drawn {
  std::uint64_t shaded = 0, covered = 0;
  [[nodiscard]] double excess() const {
    return covered > 0 ? static_cast<double>(shaded) / static_cast<double>(covered) - 1 : 0;
  }
};
inline std::uint32_t draw_fragments(std::span<const Fragment> fragments,
                                    const std::vector<std::uint32_t>& triangle_ranks) {
  std::vector<Fragment> drawn(fragments.begin(), fragments.end());
  std::sort(drawn.begin(), drawn.end(), [&](const Fragment& a, const Fragment& b) {
    return triangle_ranks[a.node / 2] < triangle_ranks[b.node / 2];
  });
  float depth = std::numeric_limits<float>::infinity();
  std::uint32_t shaded = 0;
  for (const Fragment& fragment : drawn) {
    if (!(fragment.depth < depth)) continue;
    depth = fragment.depth;
    ++shaded;
  }
  return shaded;
}
inline Drawn draw_view(const OverdrawSubject& subject, const OverdrawView& view, std::uint32_t size,
                       const std::vector<std::uint32_t>& ranks) {
  const std::vector<BoundingSphere> spheres = pose_spheres(subject);
  Drawn drawn;
  PoseRaster(subject, spheres, size)
      .draw(view, [&](std::uint64_t /*pixel*/, std::span<const Fragment> fragments) {
        ++drawn.covered;
        drawn.shaded += draw_fragments(fragments, ranks);
      });
  return drawn;
}

// Views of all frames from random viewpoints.
inline std::vector<OverdrawView> random_views(const OverdrawSubject& subject, std::uint32_t each,
                                              std::uint64_t seed) {
  std::vector<OverdrawView> views;
  for (std::uint32_t frame = 0; frame < subject.frames.size(); ++frame) {
    for (const Viewpoint& viewpoint : random_viewpoints(each, 1.5, 3, seed + frame))
      views.push_back({frame, 0, viewpoint});
  }
  return views;
}

// A list of at most `fragments` fragments of `patches` patches, some as near as the one before, as if the
// patches drew them in a random order.
inline std::vector<Layer> random_list(std::uint32_t patches, std::uint32_t fragments, Random& random) {
  std::vector<Layer> layers;
  const auto count = 2 + random.below(fragments - 1);
  for (std::uint64_t i = 0; i < count; ++i) {
    const bool tied = i > 0 && random.below(4) == 0;
    layers.push_back(static_cast<Layer>(random.below(patches)) | (tied ? kTieBit : 0));
  }
  std::vector<std::uint32_t> places = random_ranks(static_cast<std::uint32_t>(count), random);
  drop_hidden(layers, places);
  return layers;
}

// Random lists in random views, with more pixels than those with lists.
inline LayerLists random_lists(std::uint32_t patches, std::uint32_t fragments, std::uint32_t views,
                               std::uint32_t lists_a_view, Random& random) {
  LayerLists lists;
  for (std::uint32_t view = 0; view < views; ++view) {
    std::uint64_t covered = 1 + random.below(20);
    std::vector<std::uint32_t> pixels;
    for (std::uint32_t i = 0; i < lists_a_view; ++i) {
      const std::vector<Layer> list = random_list(patches, fragments, random);
      if (list.size() < 2) continue;
      const std::uint32_t number = lists.pool.number_of(list);
      pixels.resize(std::max<std::size_t>(pixels.size(), number + 1), 0);
      pixels[number] += 1 + static_cast<std::uint32_t>(random.below(9));
    }
    for (std::uint32_t number = 0; number < pixels.size(); ++number) {
      if (pixels[number] == 0) continue;
      lists.uses.push_back({number, pixels[number]});
      covered += pixels[number];
    }
    lists.offsets.push_back(lists.uses.size());
    lists.covered.push_back(covered);
  }
  return lists;
}

// Random ranks that keep parts together (`parts` ascending).
inline std::vector<std::uint32_t> random_part_ranks(const std::vector<std::uint32_t>& parts, Random& random) {
  const std::uint32_t count = parts.empty() ? 0 : parts.back() + 1;
  const std::vector<std::uint32_t> part_ranks = random_ranks(count, random);
  const std::vector<std::uint32_t> keys = random_ranks(static_cast<std::uint32_t>(parts.size()), random);
  std::vector<double> both;
  for (std::size_t i = 0; i < parts.size(); ++i)
    both.push_back(static_cast<double>(part_ranks[parts[i]]) * static_cast<double>(parts.size()) + keys[i]);
  std::vector<std::uint32_t> sequence(parts.size());
  std::iota(sequence.begin(), sequence.end(), 0U);
  std::sort(sequence.begin(), sequence.end(), [&](auto a, auto b) { return both[a] < both[b]; });
  return triangle_ranks(sequence);
}

}  // namespace pellucid::testing
