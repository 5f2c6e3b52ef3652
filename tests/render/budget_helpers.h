// Computes from the CPU raster what techniques with a budget must keep.
#pragma once

#include <algorithm>
#include <string>

#include "render_helpers.h"

namespace pellucid::testing {

constexpr std::uint32_t kBudgetSide = 48;  // of the image

// A image with maps and fragments, and all fragments there are.
struct BudgetImage {
  FragmentBuffer oracle;
  RenderResult result;

  [[nodiscard]] std::size_t pixels() const { return oracle.offsets.size() - 1; }
  [[nodiscard]] std::uint64_t n(std::size_t p) const { return oracle.pixel(p).size(); }
  // Slots that a pixel takes: fragments, and a tail where they are not all.
  [[nodiscard]] std::uint64_t used(std::size_t p) const {
    return result.maps.k[p] + (result.maps.k[p] < n(p) ? 1U : 0U);
  }
  [[nodiscard]] std::uint64_t used() const {
    std::uint64_t sum = 0;
    for (std::size_t p = 0; p < pixels(); ++p) sum += used(p);
    return sum;
  }
};

BudgetImage draw_budget(const RenderScene& scene, const RenderOptions& options);
// Of each pixel the k(p) nearest by depth and id.
void expect_nearest(const BudgetImage& drawn);
// Where there are fragments something is seen.
void expect_no_holes(const BudgetImage& drawn);

}  // namespace pellucid::testing
