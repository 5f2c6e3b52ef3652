// Local search for the vertex cache: nodes move, within their constraints, to where their vertices are
// anyway.
#pragma once

#include <cstdint>

#include "sequencing/sequence.h"

namespace pellucid {

// A *visit* of a vertex is a run of its uses that one miss pays for. The search lowers the number of visits:
// each node in turn goes to the visit of one of its vertices where that saves most, alone or with the few
// nodes that stand in its way. Uses are worth more in long visits than in short ones, so that visits that
// cannot vanish at once wear away: that is how the flipped twins of a patch come to stand beside it.
// `sequence` must agree with the constraints, and so does the result; it never has more misses.
// O(sweeps * nodes * valence^2 + edges); deterministic. `progress` may stop it.
NodeSequence gather_visits(const Mesh& mesh, const SequenceConstraints& constraints, NodeSequence sequence,
                           std::uint32_t cache_size, const Progress* progress = nullptr);

}  // namespace pellucid
