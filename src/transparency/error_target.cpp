// What orders are steered by: see error_target.h.
#include "transparency/error_target.h"

#include <cmath>

namespace pellucid {
namespace {

double mean_squared_error(double psnr) {
  return std::pow(10.0, -psnr / 10);
}

}  // namespace

double ErrorTarget::error_of(const OrderError& measured) const {
  if (least_frame_time) return measured.repaired;
  return min_psnr ? mean_squared_error(measured.psnr) : measured.ipr;
}

double ErrorTarget::largest() const {
  if (least_frame_time) return 0;
  return min_psnr ? mean_squared_error(*min_psnr) : max_ipr;
}

ErrorTarget error_target(const OrderOptions& options) {
  return {options.max_error, options.min_psnr, options.least_frame_time};
}

}  // namespace pellucid
