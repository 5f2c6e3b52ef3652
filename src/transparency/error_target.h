// What orders are steered by: the share of wrong pixels (IPR), or how far pictures are off (PSNR).
#pragma once

#include <optional>

#include "pellucid/transparency.h"

namespace pellucid {

// One more buffer is worth its memory when it lowers the error to this share.
constexpr double kWorthwhile = 0.9;

// Means over held-out viewpoints.
struct OrderError {
  double ipr = 0;
  double psnr = -1;     // dB; -1: not measured
  double repaired = 0;  // share of pixels that verified blending repairs
};

// Frames may take this much longer than with any other number of buffers, to save memory.
constexpr double kLongerFrame = 1.05;

// All measures as one number, for which less is better and which grows in proportion to the violated weight:
// the IPR, the mean squared error that the PSNR stands for, or the share of repaired pixels.
struct ErrorTarget {
  double max_ipr = 0.001;
  std::optional<double> min_psnr;  // in the place of max_ipr
  bool least_frame_time = false;   // in the place of both

  [[nodiscard]] double error_of(const OrderError& measured) const;
  // Error that meets the target; of frame times only all numbers of buffers together know: 0.
  [[nodiscard]] double largest() const;
};

ErrorTarget error_target(const OrderOptions& options);

}  // namespace pellucid
