// Makes compact patches for a single order: sets of triangles with few vertices, shaped by their cost. In:
// the layer lists of single triangles. Out: patches and their order.
//
// A compact patch of n triangles that starts with an empty cache misses about n / 2 vertices and half of the
// vertices on its outline. So a few dozen triangles are cheap wherever they are drawn. The method starts with
// small patches and raises a price per cache miss step by step. At each step, neighbouring patches are joined
// if that costs less overdraw than the saved misses are worth. Single triangles move to a neighbouring patch
// if that lowers the sum of overdraw and misses. Then the patches are sifted again. It ends when the cache
// misses are down to the limit.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "overdraw/merge_patches.h"

namespace pellucid {

struct CompactOptions {
  double acmr = 0;  // the target: misses per triangle
  std::uint32_t cache_size = 16;
  std::uint64_t seed = 1;
  SiftLayersOptions sift;
  // Returns the order to start from, as ranks by patch. It decides about patches that hardly any pixel shows.
  std::function<std::vector<std::uint32_t>(const Patches& patches)> first_ranks;
};

// Makes compact patches from the `lists` of single_triangles(), in which patch t is triangle t. Returns
// nothing if the target cannot be reached. Deterministic for any number of threads.
std::optional<OrderedPatches> compact_patches(const OverdrawSubject& subject, const LayerLists& lists,
                                              const CompactOptions& options);

// Returns patches of one triangle each.
Patches single_triangles(const OverdrawSubject& subject);

}  // namespace pellucid
