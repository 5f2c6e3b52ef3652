// Implements error_target.h: converts errors to one measure, and picks points from the curve of error against
// number of buffers.
#include "transparency/cluster/error_target.h"

#include <algorithm>
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

// --------------------------------------------------------------------------- error against number of buffers

namespace {

// Errors that validation cannot distinguish from none: one of its ten million pixels, and 100 dB.
constexpr double kLeastIpr = 1e-7;
constexpr double kLeastSquaredError = 1e-10;
// A knee lies at least this many decades below the straight line between the ends of the curve.
constexpr double kLeastBend = 0.1;

double error_of(const FrontierPoint& point, const ErrorTarget& target) {
  return target.error_of({point.ipr, point.psnr, point.repaired});
}

double decades(const FrontierPoint& point, const ErrorTarget& target) {
  return std::log10(std::max(error_of(point, target), target.min_psnr ? kLeastSquaredError : kLeastIpr));
}

}  // namespace

double verified_frame_time(double repaired) {
  // The first term is the cost of the checks. The second is that of the repairs, whose triangles and tiles
  // grow with the outline of the marked area.
  return 1.2 + 1.7 * std::sqrt(repaired);
}

void keep_best(std::vector<FrontierPoint>& points, const ErrorTarget& target) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0 && error_of(points[i], target) >= error_of(points[i - 1], target)) {
      const std::uint32_t limit = points[i].limit;
      points[i] = points[i - 1];
      points[i].limit = limit;
    }
    points[i].meets_target = error_of(points[i], target) <= target.largest();
  }
  if (!target.least_frame_time) return;
  // Errors do not rise with the number, so the frames of the last point are the fastest.
  for (FrontierPoint& point : points)
    point.meets_target = point.frame_time <= kLongerFrame * points.back().frame_time;
}

std::uint32_t chosen_limit(std::span<const FrontierPoint> points, const ErrorTarget& target) {
  const FrontierPoint* best = &points.front();
  for (const FrontierPoint& point : points) {
    if (point.meets_target) return point.limit;
    if (error_of(point, target) < kWorthwhile * error_of(*best, target)) best = &point;
  }
  return best->limit;
}

std::uint32_t knee_limit(std::span<const FrontierPoint> points, const ErrorTarget& target) {
  const double first = decades(points.front(), target);
  const double slope =
      (decades(points.back(), target) - first) / std::max(1.0, static_cast<double>(points.size()) - 1);
  double deepest = kLeastBend;
  std::uint32_t knee = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const double depth = first + slope * static_cast<double>(i) - decades(points[i], target);
    if (depth > deepest) {
      deepest = depth;
      knee = points[i].limit;
    }
  }
  return knee;
}

}  // namespace pellucid
