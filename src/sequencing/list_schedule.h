// List scheduling for the vertex cache: of all nodes that may be drawn next, the one that the cache likes
// best.
//
// After: list scheduling of instructions under register pressure; the score of a triangle as in T. Forsyth,
// "Linear-Speed Vertex Cache Optimisation", 2006. Differs in: a simulated FIFO cache, a ready set, and the
// height of a node (the longest chain of followers that waits for it).
#pragma once

#include <cstdint>
#include <span>

#include "sequencing/sequence.h"

namespace pellucid {

// All nodes with drawn[node] != 0, in an order that violates no constraint. `ranks`, which agree with all
// constraints, break ties and dead ends. A node whose vertices are all in the cache (often the twin of the
// one just drawn) is drawn at once: it costs nothing and may release others. O(nodes * cache_size * valence +
// edges).
NodeSequence list_schedule(const Mesh& mesh, const SequenceConstraints& constraints,
                           std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn,
                           std::uint32_t cache_size);

}  // namespace pellucid
