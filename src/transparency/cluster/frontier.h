// Error against number of buffers: which points a user is shown, and which of them stand out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pellucid/transparency.h"
#include "transparency/error_target.h"

namespace pellucid {

// From one solution per number of buffers (limit = request = 1, 2, ...) to the best of at most so many: a
// point that came out worse than an earlier one becomes that one.
void keep_best(std::vector<FrontierPoint>& points, const ErrorTarget& target);

// Limits, see OrderFrontier. Of points that keep_best() has been over, at least one.
std::uint32_t chosen_limit(std::span<const FrontierPoint> points, const ErrorTarget& target);
std::uint32_t knee_limit(std::span<const FrontierPoint> points, const ErrorTarget& target);

}  // namespace pellucid
