// Tipsify under constraints: the paper's vertex-cache optimisation.
//
// Based on: Han, Chen, Nehab, Sander, "In-Depth Buffers", PACMCGIT 2018, section 4, after Sander, Nehab,
// Barczak, "Fast Triangle Reordering for Vertex Locality and Reduced Overdraw", SIGGRAPH 2007: only nodes all
// of whose predecessors are drawn may be drawn.
#pragma once

#include <cstdint>
#include <span>

#include "sequencing/sequence.h"

namespace pellucid {

// All nodes with drawn[node] != 0, in an order that violates no constraint. `ranks` breaks dead ends. O(nodes
// + edges) and a heap. cache_size: FIFO entries.
NodeSequence tipsify(const Mesh& mesh, const SequenceConstraints& constraints,
                     std::span<const std::uint32_t> ranks, std::span<const std::uint8_t> drawn,
                     std::uint32_t cache_size);

}  // namespace pellucid
