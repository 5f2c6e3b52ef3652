// Implements budget_helpers.h: draws with a budget on the device, and computes the expected result on the
// CPU.
#include "budget_helpers.h"

namespace pellucid::testing {

BudgetImage draw_budget(const RenderScene& scene, const RenderOptions& options) {
  const Camera camera = unit_camera(kBudgetSide, kBudgetSide);
  test_renderer().load(scene);
  return {cpu_fragments(scene, camera), test_renderer().draw(camera, options)};
}

void expect_nearest(const BudgetImage& drawn) {
  std::uint64_t kept = 0;
  std::size_t wrong = 0;
  for (std::size_t p = 0; p < drawn.pixels(); ++p) {
    const auto all = drawn.oracle.pixel(p);
    const auto nearest = all.first(std::min<std::size_t>(all.size(), drawn.result.maps.k[p]));
    if (!same_fragments(pixel_of(drawn.result.fragments, p), nearest)) ++wrong;
    kept += nearest.size();
    EXPECT_EQ(drawn.result.maps.lost[p], all.size() - nearest.size());
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(drawn.result.stats.captured, kept);
}

void expect_no_holes(const BudgetImage& drawn) {
  std::size_t holes = 0;
  for (std::size_t p = 0; p < drawn.pixels(); ++p)
    if (drawn.n(p) > 0 && drawn.result.pixels[p] == Vec3f{1, 1, 1}) ++holes;
  EXPECT_EQ(holes, 0U);
}

}  // namespace pellucid::testing
