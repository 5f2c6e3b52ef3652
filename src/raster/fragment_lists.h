// fragment_lists.h - from spans to per-pixel lists in depth order.
//
// A band at a time: count the fragments of every pixel, sum the counts up, fill, sort each list. Everything
// about a band happens while it is in the cache. Keys (depth, node) are unique, so the result does not depend
// on the sequence of spans.
#pragma once

#include <span>
#include <vector>

#include "raster/spans.h"

namespace pellucid::raster {

// Sort by (depth, node); lists are mostly of two to four fragments. Depths are not negative.
void sort_fragments(std::span<Fragment> list);

// Fragments of one band in all parts.
std::uint64_t count_fragments(std::span<const BandedSpans> parts, std::uint32_t band);

// Write the offsets and fragments of one band, whose first fragment is number `first`. `counters` is working
// memory.
void fill_band(const Bands& bands, std::uint32_t band, std::span<const BandedSpans> parts,
               std::uint64_t first, std::vector<std::int32_t>& counters, FragmentBuffer& out);

}  // namespace pellucid::raster
