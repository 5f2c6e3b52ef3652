// Tests overdraw counted on the device against the fragments of the CPU raster.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "render_helpers.h"

namespace pellucid {
namespace {

// Pixel by pixel, in draw order: a fragment is shaded if it is nearer than all before it.
std::uint64_t shaded_on_cpu(const RenderScene& scene, const Camera& camera) {
  std::vector<std::uint32_t> place(scene.triangles.size());
  for (std::uint32_t i = 0; i < place.size(); ++i) {
    place[scene.draw_order.empty() ? i : scene.draw_order[i]] = i;
  }
  const FragmentBuffer fragments = testing::cpu_fragments(scene, camera);
  std::uint64_t shaded = 0;
  for (std::size_t p = 0; p + 1 < fragments.offsets.size(); ++p) {
    const auto pixel = fragments.pixel(p);
    std::vector<Fragment> list(pixel.begin(), pixel.end());
    std::sort(list.begin(), list.end(),
              [&](const Fragment& a, const Fragment& b) { return place[a.node / 2] < place[b.node / 2]; });
    float nearest = 1;  // what depth is cleared to
    for (const Fragment& f : list) {
      if (f.depth >= nearest) continue;
      ++shaded;
      nearest = f.depth;
    }
  }
  return shaded;
}

TEST(OverdrawCount, IsWhatASimulatedDepthTestSays) {
  Renderer& renderer = testing::test_renderer();
  const Camera camera = testing::unit_camera(48, 48);
  Random random(3);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    RenderScene scene = testing::random_stack(seed, 80);
    if (seed > 1) {
      scene.draw_order.resize(scene.triangles.size());
      std::iota(scene.draw_order.begin(), scene.draw_order.end(), 0U);
      for (std::size_t i = scene.draw_order.size(); i > 1; --i)
        std::swap(scene.draw_order[i - 1], scene.draw_order[random.below(i)]);
    }
    renderer.load(scene);
    const OverdrawCount count = renderer.count_overdraw(camera);
    EXPECT_EQ(count.shaded, shaded_on_cpu(scene, camera));
    EXPECT_EQ(count.covered, testing::cpu_fragments(scene, camera).covered_pixels());
  }
  EXPECT_EQ(testing::first_validation_message(), "");
}

TEST(OverdrawCount, FrontToBackIsOne) {
  RenderScene scene =
      testing::joined(testing::coplanar_squares(1, 0.25F), testing::coplanar_squares(1, 0.5F));
  Renderer& renderer = testing::test_renderer();
  renderer.load(scene);
  const OverdrawCount near_first = renderer.count_overdraw(testing::unit_camera(16, 16));
  EXPECT_EQ(near_first.shaded, 256U);
  EXPECT_EQ(near_first.covered, 256U);
  scene.draw_order = {2, 3, 0, 1};
  renderer.load(scene);
  EXPECT_EQ(renderer.count_overdraw(testing::unit_camera(16, 16)).shaded, 512U);
}

}  // namespace
}  // namespace pellucid
