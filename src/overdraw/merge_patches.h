// Joins many small patches where the orders hardly need them apart. In: small patches with their orders. Out:
// larger patches with fewer cache misses.
//
// The paper ends a patch as soon as it has used the cache well enough. Here the cache-friendly order is cut
// into far smaller patches. Their orders show which of them must stay apart. The others are joined with their
// successors, the least overdraw per saved cache miss first, until the cache misses are down to the limit.
// (Joins of any two patches that share vertices were tried, with and without a new order of the joined
// triangles, and were worse. Cutting again and joining again gained 2 %. See docs/overdraw.md.)
#pragma once

#include <vector>

#include "overdraw/layer_lists.h"
#include "overdraw/overdraw_costs.h"
#include "overdraw/patches.h"
#include "sequencing/k_orders.h"

namespace pellucid {

struct MergeOptions {
  double acmr = 0;  // the target: misses per triangle, mean over the orders
  std::uint32_t cache_size = 16;
  KOrdersOptions rounds{1, 0};  // of the optimiser, after each batch of joins
  SiftLayersOptions sift;
};

// Patches with orders for the views of the lists.
struct OrderedPatches {
  Patches patches;
  LayerLists lists;
  Clustering clustering;
};
// Joins patches in place. Returns for every patch of the input the patch that it became part of. Stops above
// the target if no patches are left to join.
std::vector<std::uint32_t> merge_patches(const OverdrawSubject& subject, const MergeOptions& options,
                                         OrderedPatches& ordered);

// Returns the misses per triangle, mean over the orders.
double mean_acmr(const OverdrawSubject& subject, const Patches& patches,
                 const std::vector<std::vector<std::uint32_t>>& ranks, std::uint32_t cache_size);

// Returns the cost of moving a patch next to `target`: to the near side, or past it with `pass_target`.
// `row`: the pairwise preferences of the patch.
double cost_of_moving(const PreferenceRow& row, std::span<const std::uint32_t> ranks, NodeId item,
                      NodeId target, bool pass_target);

// Returns the patches by rank.
std::vector<std::uint32_t> sequence_of(std::span<const std::uint32_t> ranks);

}  // namespace pellucid
