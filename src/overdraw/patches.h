// Cuts a cache-friendly triangle order into patches: runs of triangles that stay together when the order
// changes. Also makes orders for the vertex cache alone. In: a subject. Out: patches, or an order of its
// triangles.
//
// Based on: Sander, Nehab, Barczak, "Fast Triangle Reordering for Vertex Locality and Reduced Overdraw",
// SIGGRAPH 2007, fast linear clustering; section 3.1 of Han, Sander 2017.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/metric.h"
#include "pellucid/overdraw.h"

namespace pellucid {

struct Patches {
  std::vector<std::uint32_t> sequence;  // all triangles, patch by patch
  std::vector<std::uint32_t> offsets;   // patches + 1
  std::vector<std::uint32_t> parts;     // the part of every patch, ascending

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(parts.size()); }
  [[nodiscard]] std::span<const std::uint32_t> triangles_of(std::uint32_t patch) const {
    return std::span(sequence).subspan(offsets[patch], offsets[patch + 1] - offsets[patch]);
  }
};

// The patch of every triangle and its position.
struct PatchPlaces {
  std::vector<std::uint32_t> patch_of;  // by triangle
  std::vector<std::uint32_t> place_of;  // by triangle: position in the sequence
};
PatchPlaces places_of(const Patches& patches);

// Cuts `sequence` (whole parts, one after another) into patches. A patch starts with an empty cache. It ends
// when its misses per triangle fall below lambda, or when the next triangle has no vertex in the cache.
Patches cut_patches(const OverdrawSubject& subject, std::span<const std::uint32_t> sequence, double lambda,
                    std::uint32_t cache_size);

// Joins the patches with join[patch] != 0 with their successors, which must belong to the same part.
struct JoinedPatches {
  Patches patches;
  std::vector<std::uint32_t> patch_of;  // by old patch
};
JoinedPatches join_patches(const Patches& patches, std::span<const std::uint8_t> join);

// Returns the triangles when patches are drawn in this order.
std::vector<std::uint32_t> expand(const Patches& patches, std::span<const std::uint32_t> drawn);

// Returns the part of every triangle.
std::vector<std::uint32_t> part_of_triangles(const OverdrawSubject& subject);

// Returns an order as cache_order() does, with fewer misses: the best of some starts after a local search. (A
// walk after Lin and Yu, TVCG 2006, has another 3 % fewer misses, but its long strips make patches that hide
// each other.) `progress` (may be null) is only asked whether to stop.
std::vector<std::uint32_t> best_cache_order(const OverdrawSubject& subject, std::uint32_t cache_size,
                                            std::uint64_t seed, const Progress* progress = nullptr);

}  // namespace pellucid
