// Tests verified blending: images are exact for any draw order, and repairs happen only where the order was
// wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "pellucid/sequencing.h"
#include "render_helpers.h"

namespace pellucid {
namespace {

using testing::kFoldRounding;
using testing::largest_difference;

std::vector<std::uint32_t> shuffled(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::uint32_t> sequence(count);
  std::iota(sequence.begin(), sequence.end(), 0U);
  for (std::size_t i = count; i > 1; --i) std::swap(sequence[i - 1], sequence[random.below(i)]);
  return sequence;
}

// Layers of random_stack() have one depth each.
std::vector<std::uint32_t> front_to_back(const RenderScene& scene) {
  std::vector<std::uint32_t> sequence(scene.triangles.size());
  std::iota(sequence.begin(), sequence.end(), 0U);
  const auto depth = [&](std::uint32_t t) { return scene.positions[scene.triangles[t][0]].z; };
  std::stable_sort(sequence.begin(), sequence.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return depth(a) < depth(b); });
  return sequence;
}

// Pixels where depths do not ascend strictly from 0 in draw order.
std::uint64_t pixels_out_of_order(const RenderScene& scene, const Camera& camera) {
  std::vector<std::uint32_t> ranks(scene.triangles.size());
  for (std::uint32_t i = 0; i < ranks.size(); ++i) ranks[scene.draw_order[i]] = i;
  const FragmentBuffer all = testing::cpu_fragments(scene, camera);
  std::uint64_t count = 0;
  for (std::size_t p = 0; p + 1 < all.offsets.size(); ++p) {
    const auto pixel = all.pixel(p);
    std::vector<Fragment> drawn(pixel.begin(), pixel.end());
    std::sort(drawn.begin(), drawn.end(), [&](const Fragment& a, const Fragment& b) {
      return ranks[triangle_of(a.node)] < ranks[triangle_of(b.node)];
    });
    float last = 0;
    bool wrong = false;
    for (const Fragment& f : drawn) {
      wrong = wrong || f.depth <= last;
      last = std::max(last, f.depth);
    }
    count += wrong ? 1 : 0;
  }
  return count;
}

TEST(VerifiedBlending, IsExactInAnySequence) {
  Renderer& renderer = testing::test_renderer();
  const Camera camera = testing::unit_camera(75, 61);
  for (const Effect effect : {Effect::transparency, Effect::wireframe}) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      RenderScene scene = testing::random_stack(seed, 160);
      scene.draw_order = shuffled(scene.triangles.size(), seed);
      renderer.load(scene);
      const RenderResult exact = renderer.draw(camera, {.technique = "sb", .effect = effect});
      const RenderResult verified = renderer.draw(camera, {.technique = "verified", .effect = effect});
      EXPECT_LE(largest_difference(exact, verified), kFoldRounding);
      EXPECT_EQ(verified.stats.repaired_pixels, pixels_out_of_order(scene, camera));
      EXPECT_GT(verified.stats.repaired_pixels, 0U);
      EXPECT_EQ(verified.stats.captured, exact.stats.captured);
      EXPECT_EQ(verified.stats.coplanar, exact.stats.coplanar);
    }
  }
  EXPECT_EQ(testing::first_validation_message(), "");
}

// Coplanar fragments come in the order of their ids in exact images, so they are repaired, too.
TEST(VerifiedBlending, RepairsNoMoreThanItMust) {
  Renderer& renderer = testing::test_renderer();
  const Camera camera = testing::unit_camera(64, 48);
  for (const std::uint64_t seed : {4U, 5U}) {
    RenderScene scene = testing::random_stack(seed, 80);
    scene.draw_order = front_to_back(scene);
    renderer.load(scene);
    const RenderResult verified = renderer.draw(camera, {.technique = "verified"});
    EXPECT_EQ(verified.stats.repaired_pixels, pixels_out_of_order(scene, camera));
    EXPECT_LE(largest_difference(renderer.draw(camera, {.technique = "sb"}), verified), kFoldRounding);
  }
}

TEST(VerifiedBlending, RepairsNothingInTheRightSequence) {
  Renderer& renderer = testing::test_renderer();
  RenderScene scene = testing::coplanar_squares(1, 0.125F);
  for (int i = 2; i <= 7; ++i)
    scene = testing::joined(scene, testing::coplanar_squares(1, 0.125F * static_cast<float>(i)));
  const Camera camera = testing::unit_camera(40, 24);
  renderer.load(scene);
  const RenderResult exact = renderer.draw(camera, {.technique = "sb"});
  const RenderResult verified = renderer.draw(camera, {.technique = "verified"});
  EXPECT_EQ(verified.stats.repaired_pixels, 0U);
  EXPECT_LE(largest_difference(exact, verified), kFoldRounding);
  EXPECT_EQ(verified.stats.geometry_passes, 2U);

  scene.draw_order = shuffled(scene.triangles.size(), 9);
  renderer.load(scene);
  const RenderResult repaired = renderer.draw(camera, {.technique = "verified"});
  EXPECT_EQ(repaired.stats.repaired_pixels, pixels_out_of_order(scene, camera));
  EXPECT_EQ(repaired.stats.geometry_passes, 3U);
  EXPECT_GT(repaired.stats.bytes, verified.stats.bytes);
}

TEST(VerifiedBlending, OpaqueSurfacesMarkNothing) {
  Renderer& renderer = testing::test_renderer();
  const Camera camera = testing::unit_camera(40, 24);
  RenderScene scene = testing::coplanar_squares(1, 0.5F);
  scene.surfaces[0].opaque = true;
  // Before and behind it, the farther one first: fragments behind opaque surfaces are none.
  for (const float depth : {0.75F, 0.25F})
    scene = testing::joined(scene, testing::coplanar_squares(1, depth));
  renderer.load(scene);
  const RenderResult verified = renderer.draw(camera, {.technique = "verified"});
  EXPECT_EQ(verified.stats.repaired_pixels, 0U);
  EXPECT_LE(largest_difference(renderer.draw(camera, {.technique = "sb"}), verified), kFoldRounding);
}

TEST(VerifiedBlending, TakesEveryOpacity) {
  Renderer& renderer = testing::test_renderer();
  const Camera camera = testing::unit_camera(48, 32);
  RenderScene scene = testing::random_stack(11, 120);
  scene.surfaces[0].alpha = 0;
  scene.surfaces[1].alpha = 1;
  for (const std::uint64_t seed : {1U, 2U}) {
    scene.draw_order = seed == 1 ? front_to_back(scene) : shuffled(scene.triangles.size(), seed);
    renderer.load(scene);
    EXPECT_LE(largest_difference(renderer.draw(camera, {.technique = "sb"}),
                                 renderer.draw(camera, {.technique = "verified"})),
              kFoldRounding);
  }
}

// Large triangles, and ones that pass the eye, touch tiles that their corners are far from.
TEST(VerifiedBlending, DrawsAgainWhatPassesTheEye) {
  Renderer& renderer = testing::test_renderer();
  RenderScene scene = testing::random_boxes(3, 8, 2);
  scene.draw_order = shuffled(scene.triangles.size(), 4);
  Camera camera = look_at_sphere({{0.5, 0.5, 0.5}, 0.9}, {normalized(Vec3d{1, 2, 3}), 1.2}, 120, 90);
  camera.eye = {0.5, 0.45, 0.55};  // among them
  camera.near_plane = 0.01;
  camera.far_plane = 3;
  renderer.load(scene);
  const RenderResult verified = renderer.draw(camera, {.technique = "verified"});
  EXPECT_GT(verified.stats.repaired_pixels, 100U);
  EXPECT_LE(largest_difference(renderer.draw(camera, {.technique = "sb"}), verified), kFoldRounding);
  EXPECT_EQ(testing::first_validation_message(), "");
}

TEST(VerifiedBlending, EachSampleIsVerified) {
  Renderer& renderer = testing::test_renderer();
  RenderScene scene = testing::random_boxes(6, 12, 4);
  scene.surfaces[1].opaque = true;
  scene.draw_order = shuffled(scene.triangles.size(), 9);
  renderer.load(scene);
  const Camera camera = look_at_sphere({{0.5, 0.5, 0.5}, 0.9}, {normalized(Vec3d{1, 2, 3}), 3}, 61, 45);
  const RenderResult one = renderer.draw(camera, {.technique = "verified"});
  const RenderResult four = renderer.draw(camera, {.technique = "verified", .samples = 4});
  EXPECT_GT(four.stats.repaired_pixels, 3 * one.stats.repaired_pixels);
  EXPECT_LE(largest_difference(renderer.draw(camera, {.technique = "sb", .samples = 4}), four),
            kFoldRounding);
  EXPECT_EQ(testing::first_validation_message(), "");
}

TEST(VerifiedBlending, RefusesWhatItCannotDo) {
  Renderer& renderer = testing::test_renderer();
  const Camera camera = testing::unit_camera(8, 8);
  renderer.load(testing::coplanar_squares(2, 0.5F));
  EXPECT_THROW(renderer.draw(camera, {.technique = "verified", .effect = Effect::csg}), Error);
  EXPECT_THROW(renderer.draw(camera, {.technique = "verified", .keep_fragments = true}), Error);
}

}  // namespace
}  // namespace pellucid
