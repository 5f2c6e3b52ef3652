// Patches that are cut where it pays: many small ones, joined where orders hardly need them apart.
//
// The paper cuts the cache-friendly order wherever a patch has used the cache well enough. Here the order is
// cut into far smaller patches, whose orders then show which of them want to be apart; the others are joined
// with their successors, the least overdraw per saved cache miss first, until the misses are down to what
// they may be. (Tried and worse: joins of any two patches that share vertices, with or without ordering the
// joined triangles anew; cutting again and joining again gained 2 %. docs/overdraw.md)
#pragma once

#include <vector>

#include "overdraw/layer_lists.h"
#include "overdraw/overdraw_costs.h"
#include "overdraw/patches.h"
#include "sequencing/k_orders.h"

namespace pellucid {

struct MergeOptions {
  double acmr = 0;  // mean over the orders, to get down to
  std::uint32_t cache_size = 16;
  KOrdersOptions rounds{1, 0};  // of the optimiser, after every batch of joins
  SiftLayersOptions sift;
};

// Patches with orders for the views of the lists.
struct OrderedPatches {
  Patches patches;
  LayerLists lists;
  Clustering clustering;
};
// Returns by patch of the input the patch it became. Ends early where nothing is left to join.
std::vector<std::uint32_t> merge_patches(const OverdrawSubject& subject, const MergeOptions& options,
                                         OrderedPatches& ordered);

// Misses per triangle, mean over the orders.
double mean_acmr(const OverdrawSubject& subject, const Patches& patches,
                 const std::vector<std::vector<std::uint32_t>>& ranks, std::uint32_t cache_size);

// What it costs to move a patch, whose wishes these are, to right before or behind the target, and past it
// with `pass_target`.
double cost_of_moving(const PreferenceRow& row, std::span<const std::uint32_t> ranks, NodeId item,
                      NodeId target, bool pass_target);

// Patches by rank.
std::vector<std::uint32_t> sequence_of(std::span<const std::uint32_t> ranks);

}  // namespace pellucid
