// Says which error decides the number of orders: the share of wrong pixels (IPR), the PSNR, or the time of a
// frame. Picks points from the curve of error against number of buffers.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "metric/validation.h"
#include "pellucid/transparency.h"

namespace pellucid {

// One more buffer is worth its memory when it lowers the error at least to this share of what it was.
constexpr double kWorthwhile = 0.9;
// Frames may take this much longer than with any other number of buffers, to save memory.
constexpr double kLongerFrame = 1.05;

// The error target. All measures are turned into one number. Less is better, and the number grows in
// proportion to the violated weight: it is the IPR, the mean squared error that the PSNR stands for, or the
// share of repaired pixels.
struct ErrorTarget {
  double max_ipr = 0.001;
  std::optional<double> min_psnr;  // replaces max_ipr
  bool least_frame_time = false;   // replaces both

  [[nodiscard]] double error_of(const OrderError& measured) const;
  // Returns the largest error that meets the target. For frame times that is known only when all numbers of
  // buffers have been tried; the result is then 0.
  [[nodiscard]] double largest() const;
};

ErrorTarget error_target(const OrderOptions& options);

// --------------------------------------------------------------------------- error against number of buffers

// Takes one solution for each number of buffers (limit = request = 1, 2, ...). Replaces each point by the
// best one with at most its number of buffers, and sets meets_target.
void keep_best(std::vector<FrontierPoint>& points, const ErrorTarget& target);

// Return numbers of buffers, as in OrderFrontier. `points`: one or more points after keep_best().
std::uint32_t chosen_limit(std::span<const FrontierPoint> points, const ErrorTarget& target);
std::uint32_t knee_limit(std::span<const FrontierPoint> points, const ErrorTarget& target);

}  // namespace pellucid
