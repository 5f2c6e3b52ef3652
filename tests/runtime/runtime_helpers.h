// Helpers that the tests of select.h share.
#pragma once

#include <array>
#include <limits>

#include "pellucid/base.h"

namespace pellucid::testing {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Direction = std::array<double, 3>;
inline Direction to_array(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

}  // namespace pellucid::testing
