// Triangles in compact sets of about equal size: few vertices for their triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "overdraw/mesh_links.h"
#include "pellucid/base.h"

namespace pellucid {

// By triangle its set. Sets are connected over edges at first, and of one part; they are numbered by their
// first triangles. Grown from seeds (Lloyd's iteration), then triangles go to the set of a neighbour where
// that does not raise the sum of the sets' vertices. Deterministic.
std::vector<std::uint32_t> compact_sets(const MeshLinks& links, double size, Random& random);

// Vertices that a triangle has for itself in its set, less those that it would bring to another: what it
// saves to move it there.
int vertices_saved(const MeshLinks& links, const std::vector<std::uint32_t>& set_of, std::uint32_t triangle,
                   std::uint32_t to);

}  // namespace pellucid
