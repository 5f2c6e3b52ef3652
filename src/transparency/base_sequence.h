// One sequence of all triangles for every view, for viewers that know of no others.
#pragma once

#include <cstdint>
#include <vector>

#include "transparency/order_problem.h"

namespace pellucid {

// Triangles in the order of an unconstrained vertex-cache optimisation: position by triangle.
std::vector<std::uint32_t> cache_positions(const Mesh& mesh);

// Every triangle of `mesh` once, as stored, back to front: runs of cache-friendly triangles sorted by the
// best single order of `coarse`, which is the same mesh or a simpler one.
std::vector<std::uint32_t> base_sequence(const Mesh& mesh, const OrderProblem& coarse);

}  // namespace pellucid
