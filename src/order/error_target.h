// What orders are steered by: the share of wrong pixels (IPR), or how far pictures are off (PSNR).
#pragma once

#include <optional>

#include "pellucid/order.h"

namespace pellucid {

// One more buffer is worth its memory when it lowers the error to this share.
constexpr double kWorthwhile = 0.9;

// Means over held-out viewpoints.
struct PictureError {
  double ipr = 0;
  double psnr = -1;  // dB; -1: not measured
};

// Both measures as one number, for which less is better and which grows in proportion to the violated weight:
// the IPR, or the mean squared error that the PSNR stands for.
struct ErrorTarget {
  double max_ipr = 0.001;
  std::optional<double> min_psnr;  // in the place of max_ipr

  [[nodiscard]] double error_of(const PictureError& measured) const;
  [[nodiscard]] double largest() const;  // error that meets the target
};

ErrorTarget error_target(const OrderOptions& options);

}  // namespace pellucid
