// Fewer cache misses for an order, with no more overdraw.
//
// A fragment stays unshaded as long as one that hides it is drawn before it. So one constraint for every
// hidden fragment, "the first drawn of all that hide it comes before it", keeps all that an order has
// achieved, and leaves triangles free to move to where their vertices are in the cache.
#pragma once

#include <span>
#include <vector>

#include "layer_lists.h"
#include "overdraw_costs.h"
#include "pellucid/overdraw.h"

namespace pellucid {

// `weighted` are lists of single triangles (patch t is triangle t). Rearranges the triangles `begin` .. `end`
// - 1 of `sequence`, all of one part: misses and overdraw never rise.
void save_misses(const OverdrawSubject& subject, const ListPool& pool, std::span<const WeightedList> weighted,
                 std::uint32_t cache_size, std::vector<std::uint32_t>& sequence, const Progress* progress);

}  // namespace pellucid
