// Implements patches.h: cuts and joins patches, and makes orders for the vertex cache.
#include "overdraw/patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "sequencing/cache_order.h"
#include "sequencing/fifo_cache.h"

namespace pellucid {
namespace {

std::uint32_t end_of_part(const OverdrawSubject& subject, std::size_t part) {
  return part + 1 < subject.parts.size() ? subject.parts[part + 1]
                                         : static_cast<std::uint32_t>(subject.triangles.size());
}

}  // namespace

PatchPlaces places_of(const Patches& patches) {
  PatchPlaces places;
  places.patch_of.resize(patches.sequence.size());
  places.place_of.resize(patches.sequence.size());
  for (std::uint32_t patch = 0; patch < patches.count(); ++patch) {
    for (std::uint32_t i = patches.offsets[patch]; i < patches.offsets[patch + 1]; ++i) {
      places.patch_of[patches.sequence[i]] = patch;
      places.place_of[patches.sequence[i]] = i;
    }
  }
  return places;
}

Patches cut_patches(const OverdrawSubject& subject, std::span<const std::uint32_t> sequence, double lambda,
                    std::uint32_t cache_size) {
  const std::vector<std::uint32_t> parts = part_of_triangles(subject);
  Patches patches;
  patches.sequence.assign(sequence.begin(), sequence.end());
  patches.offsets.push_back(0);
  FifoCache cache(subject.frames.front().size(), cache_size);
  std::uint32_t misses = 0;
  const auto end_patch = [&](std::uint32_t end) {
    patches.parts.push_back(parts[sequence[end - 1]]);
    patches.offsets.push_back(end);
    cache.flush();
    misses = 0;
  };
  for (std::uint32_t i = 0; i < sequence.size(); ++i) {
    const std::uint32_t begin = patches.offsets.back();
    std::uint32_t own = cache.draw(subject.triangles[sequence[i]]);
    const bool part_begins = i > begin && parts[sequence[i]] != parts[sequence[i - 1]];
    if (part_begins || (i > begin && own == 3)) {
      end_patch(i);
      own = cache.draw(subject.triangles[sequence[i]]);
    }
    misses += own;
    if (lambda >= 3 || misses < lambda * (i + 1 - patches.offsets.back())) end_patch(i + 1);
  }
  if (patches.offsets.back() < sequence.size()) end_patch(static_cast<std::uint32_t>(sequence.size()));
  return patches;
}

JoinedPatches join_patches(const Patches& patches, std::span<const std::uint8_t> join) {
  JoinedPatches joined;
  joined.patches.sequence = patches.sequence;
  joined.patches.offsets.push_back(0);
  for (std::uint32_t patch = 0; patch < patches.count(); ++patch) {
    joined.patch_of.push_back(joined.patches.count());
    if (join[patch] != 0) continue;
    joined.patches.offsets.push_back(patches.offsets[patch + 1]);
    joined.patches.parts.push_back(patches.parts[patch]);
  }
  return joined;
}

std::vector<std::uint32_t> expand(const Patches& patches, std::span<const std::uint32_t> drawn) {
  std::vector<std::uint32_t> triangles;
  triangles.reserve(patches.sequence.size());
  for (const std::uint32_t patch : drawn) {
    const auto own = patches.triangles_of(patch);
    triangles.insert(triangles.end(), own.begin(), own.end());
  }
  return triangles;
}

std::vector<std::uint32_t> part_of_triangles(const OverdrawSubject& subject) {
  std::vector<std::uint32_t> parts(subject.triangles.size(), 0);
  for (std::size_t part = 0; part < subject.parts.size(); ++part) {
    std::fill(parts.begin() + subject.parts[part], parts.begin() + end_of_part(subject, part),
              static_cast<std::uint32_t>(part));
  }
  return parts;
}

namespace {

// One part as a mesh of its own.
struct PartMesh {
  Mesh mesh;  // only as many positions as there are vertices
  std::uint32_t first_triangle = 0;
  OrderConstraints none;            // nothing must come before anything
  std::vector<std::uint8_t> drawn;  // by node: every triangle once

  // Returns the part of a list by node of the whole mesh.
  [[nodiscard]] std::span<const std::uint32_t> own(const std::vector<std::uint32_t>& of_nodes) const {
    return std::span(of_nodes).subspan(2 * std::size_t{first_triangle}, 2 * mesh.triangles.size());
  }
};

// Calls order_part(PartMesh) for every part. Time and memory depend only on the size of the part.
template <class OrderPart>
std::vector<std::uint32_t> order_parts(const OverdrawSubject& subject, const OrderPart& order_part) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> numbers(subject.frames.front().size(), kNone);
  std::vector<std::uint32_t> sequence;
  for (std::size_t part = 0; part < subject.parts.size(); ++part) {
    PartMesh own;
    own.first_triangle = subject.parts[part];
    std::vector<std::uint32_t> used;
    for (std::uint32_t t = own.first_triangle; t < end_of_part(subject, part); ++t) {
      Triangle corners = subject.triangles[t];
      for (std::uint32_t& vertex : corners) {
        if (numbers[vertex] == kNone) {
          numbers[vertex] = static_cast<std::uint32_t>(used.size());
          used.push_back(vertex);
        }
        vertex = numbers[vertex];
      }
      own.mesh.triangles.push_back(corners);
    }
    own.mesh.positions.resize(used.size());
    for (const std::uint32_t vertex : used) numbers[vertex] = kNone;
    const std::size_t nodes = 2 * own.mesh.triangles.size();
    own.none.offsets.assign(nodes + 1, 0);
    own.drawn.assign(nodes, 0);
    for (std::uint32_t t = 0; 2 * t < nodes; ++t) own.drawn[node_of(t, false)] = 1;
    for (const NodeId node : order_part(own)) sequence.push_back(own.first_triangle + triangle_of(node));
  }
  return sequence;
}

}  // namespace

std::vector<std::uint32_t> cache_order(const OverdrawSubject& subject, std::uint32_t cache_size) {
  std::vector<std::uint32_t> ranks(2 * subject.triangles.size());
  std::iota(ranks.begin(), ranks.end(), 0U);
  return order_parts(subject, [&](const PartMesh& part) {
    return tipsify(part.mesh, part.none, part.own(ranks), part.drawn, cache_size);
  });
}

std::vector<std::uint32_t> best_cache_order(const OverdrawSubject& subject, std::uint32_t cache_size,
                                            std::uint64_t seed, const Progress* progress) {
  // These ranks decide where tipsify continues after a dead end: by number in the first start, else at
  // random.
  constexpr std::size_t kStarts = 4;
  Random random(seed);
  std::array<std::vector<std::uint32_t>, kStarts> ranks;
  for (std::vector<std::uint32_t>& start : ranks) {
    start.resize(2 * subject.triangles.size());
    std::iota(start.begin(), start.end(), 0U);
    if (&start == &ranks.front()) continue;
    for (std::size_t i = start.size(); i-- > 1;) std::swap(start[i], start[random.below(i + 1)]);
  }
  return order_parts(subject, [&](const PartMesh& part) {
    std::array<NodeSequence, kStarts> trials;
    parallel_loop(std::size_t{0}, kStarts, [&](std::size_t i) {
      trials[i] = gather_visits(part.mesh, part.none,
                                tipsify(part.mesh, part.none, part.own(ranks[i]), part.drawn, cache_size),
                                cache_size, progress);
    });
    return *std::min_element(trials.begin(), trials.end(), [&](const auto& a, const auto& b) {
      return fifo_misses(part.mesh, a, cache_size) < fifo_misses(part.mesh, b, cache_size);
    });
  });
}

std::vector<std::uint32_t> static_overdraw_order(const OverdrawSubject& subject, std::uint32_t frame,
                                                 std::span<const std::uint32_t> cached, double lambda,
                                                 std::uint32_t cache_size) {
  const Patches patches = cut_patches(subject, cached, lambda, cache_size);
  const std::vector<Vec3f>& positions = subject.frames[frame];
  struct Surface {
    Vec3d centroid, normal;  // times area
    double area = 0;
  };
  std::vector<Surface> surfaces(patches.count());
  std::vector<Surface> of_parts(subject.parts.size());
  for (std::uint32_t patch = 0; patch < patches.count(); ++patch) {
    for (const std::uint32_t triangle : patches.triangles_of(patch)) {
      const Triangle& t = subject.triangles[triangle];
      const Vec3d a = to_double(positions[t[0]]), b = to_double(positions[t[1]]),
                  c = to_double(positions[t[2]]);
      const Vec3d normal = cross(b - a, c - a) * 0.5;
      const double area = length(normal);
      if (!std::isfinite(area)) continue;
      for (Surface* surface : {&surfaces[patch], &of_parts[patches.parts[patch]]}) {
        surface->centroid += (a + b + c) * (area / 3);
        surface->normal += normal;
        surface->area += area;
      }
    }
  }
  // Outer patches that face outwards come first.
  std::vector<double> keys(patches.count(), 0.0);
  for (std::uint32_t patch = 0; patch < patches.count(); ++patch) {
    const Surface& whole = of_parts[patches.parts[patch]];
    const Surface& own = surfaces[patch];
    if (own.area > 0)
      keys[patch] = -dot(own.centroid / own.area - whole.centroid / whole.area, normalized(own.normal));
  }
  std::vector<std::uint32_t> drawn(patches.count());
  std::iota(drawn.begin(), drawn.end(), 0U);
  std::stable_sort(drawn.begin(), drawn.end(), [&](std::uint32_t a, std::uint32_t b) {
    return patches.parts[a] != patches.parts[b] ? patches.parts[a] < patches.parts[b] : keys[a] < keys[b];
  });
  return expand(patches, drawn);
}

}  // namespace pellucid
