// Compact patches for one order: sets of triangles with few vertices, shaped by what they cost.
//
// A compact patch of n triangles, drawn from an empty cache, misses about n / 2 vertices and half of those on
// its outline, so that a few dozen triangles are cheap wherever they are drawn. From small patches on, a
// price per miss rises step by step: neighbours whose joining costs less overdraw than the misses that it
// saves are worth become one, single triangles go to the patch beside theirs where overdraw and misses
// together fall, and the patches are sifted anew, until the misses are down to what they may be.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "overdraw/merge_patches.h"

namespace pellucid {

struct CompactOptions {
  double acmr = 0;  // to get down to
  std::uint32_t cache_size = 16;
  std::uint64_t seed = 1;
  SiftLayersOptions sift;
  // The order to start from, ranks by patch: for patches that hardly any pixel shows.
  std::function<std::vector<std::uint32_t>(const Patches& patches)> first_ranks;
};

// `lists`: every triangle a patch of its own, numbered as the triangles are. Nothing where so few misses
// cannot be had. Deterministic for any number of threads.
std::optional<OrderedPatches> compact_patches(const OverdrawSubject& subject, const LayerLists& lists,
                                              const CompactOptions& options);

// Every triangle a patch.
Patches single_triangles(const OverdrawSubject& subject);

}  // namespace pellucid
