// Tests techniques whose memory is too small for all fragments: they capture all in more rounds, or keep the
// nearest and average the rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "render_helpers.h"

namespace pellucid {
namespace {

class BoundedMemory : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!testing::test_renderer().info().atomics64) GTEST_SKIP() << "this device has no 64-bit atomics";
  }
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }

  static RenderResult draw(const RenderScene& scene, const RenderOptions& options, std::uint32_t side = 24) {
    testing::test_renderer().load(scene);
    return testing::test_renderer().draw(testing::unit_camera(side, side), options);
  }
  static std::vector<std::uint32_t> counts_of(const FragmentBuffer& all) {
    std::vector<std::uint32_t> counts;
    for (std::size_t p = 0; p + 1 < all.offsets.size(); ++p)
      counts.push_back(static_cast<std::uint32_t>(all.pixel(p).size()));
    return counts;
  }
};

void expect_all(const RenderResult& result, const FragmentBuffer& all, const std::string& what) {
  EXPECT_EQ(result.stats.captured, all.fragments.size()) << what;
  EXPECT_EQ(result.stats.overflowed, 0U) << what;
  ASSERT_EQ(result.fragments.offsets.size(), all.offsets.size()) << what;
  for (std::size_t p = 0; p + 1 < all.offsets.size(); ++p)
    ASSERT_TRUE(testing::same_fragments(testing::pixel_of(result.fragments, p), all.pixel(p)))
        << what << ", pixel " << p;
}

void expect_same_image(const RenderResult& a, const RenderResult& b, float most, const std::string& what) {
  ASSERT_EQ(a.pixels.size(), b.pixels.size());
  float largest = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    largest = std::max(largest, testing::difference(a.pixels[i], b.pixels[i]));
  EXPECT_LE(largest, most) << what;
}

// The fewest rounds r whose shares ceil(count / r), at most 64, fit; with shares of one that do not, times
// the parts in which they do.
std::uint32_t expected_rounds(const std::vector<std::uint32_t>& counts, std::uint64_t places) {
  const std::uint32_t deepest = *std::max_element(counts.begin(), counts.end());
  for (std::uint32_t rounds = 1;; ++rounds) {
    std::uint64_t sum = 0;
    for (const std::uint32_t n : counts) sum += (n + rounds - 1) / rounds;
    if (sum <= places && (deepest + rounds - 1) / rounds <= 64) return rounds;
    if (rounds == deepest) return rounds * static_cast<std::uint32_t>((sum + places - 1) / places);
  }
}

TEST_F(BoundedMemory, ExactInAnyPool) {
  const RenderScene scene = testing::random_stack(31, 60);
  const FragmentBuffer all = testing::cpu_fragments(scene, testing::unit_camera(24, 24));
  const RenderResult expected = draw(scene, {.technique = "sb", .plain_resolve = true});
  for (const char* technique : {"sb", "ll", "bun-ll"}) {
    for (const std::uint64_t pool : {std::uint64_t{40}, std::uint64_t{700}, expected.stats.fragments - 1}) {
      if (pool == 40 && std::string(technique) != "sb") continue;  // long, and the same for all
      const RenderResult result = draw(scene, {.technique = technique,
                                               .pool = {.nodes = pool, .overflow = Overflow::exact},
                                               .keep_fragments = true});
      const std::string what = std::string(technique) + " " + std::to_string(pool);
      expect_all(result, all, what);
      expect_same_image(result, expected, 1e-4F, what);
      EXPECT_TRUE(result.stats.pool_exceeded) << what;
      EXPECT_EQ(result.stats.coplanar, expected.stats.coplanar) << what;
      EXPECT_EQ(result.stats.coplanar_pixels, expected.stats.coplanar_pixels) << what;
      EXPECT_EQ(result.stats.rounds, expected_rounds(counts_of(all), pool)) << what;
      EXPECT_EQ(result.stats.geometry_passes, 1 + 2 * result.stats.rounds) << what;
    }
  }
}

TEST_F(BoundedMemory, PoolThatSufficesIsUsedAsItIs) {
  const RenderScene scene = testing::random_stack(31, 60);
  const std::uint64_t fragments = draw(scene, {.technique = "sb", .plain_resolve = true}).stats.fragments;
  const RenderResult result = draw(
      scene,
      {.technique = "sb", .pool = {.nodes = fragments, .overflow = Overflow::exact}, .plain_resolve = true});
  EXPECT_FALSE(result.stats.pool_exceeded);
  EXPECT_EQ(result.stats.rounds, 0U);
  EXPECT_EQ(result.stats.captured, fragments);
}

// Pixels far deeper than a round goes, in one layer and in many.
TEST_F(BoundedMemory, DeepPixels) {
  RenderScene layers = testing::coplanar_squares(2, 0);
  for (std::uint32_t i = 1; i < 150; ++i)
    layers = testing::joined(layers, testing::coplanar_squares(2, static_cast<float>(i) / 256.0F));
  for (const RenderScene& scene : {layers, testing::coplanar_squares(300, 0.5F)}) {
    const FragmentBuffer all = testing::cpu_fragments(scene, testing::unit_camera(4, 4));
    ASSERT_EQ(all.pixel(0).size(), 300U);
    for (const std::uint64_t places : {10U, 17U}) {
      const RenderResult result = draw(scene,
                                       {.technique = "sb",
                                        .pool = {.nodes = 16 * places, .overflow = Overflow::exact},
                                        .keep_fragments = true},
                                       4);
      expect_all(result, all, std::to_string(places));
      EXPECT_EQ(result.stats.rounds, (300 + places - 1) / places);
    }
  }
}

TEST_F(BoundedMemory, BudgetInBytesIsKept) {
  const RenderScene scene = testing::random_stack(32, 60);
  const FragmentBuffer all = testing::cpu_fragments(scene, testing::unit_camera(24, 24));
  const RenderResult expected = draw(scene, {.technique = "sb", .plain_resolve = true});
  std::uint32_t rounds = 0;
  // From bands of a few rows on.
  for (const std::uint64_t memory :
       {44ULL * 24 * 4 + 500, 44ULL * 24 * 24 + 3000, 44ULL * 24 * 24 + 100000}) {
    const RenderResult result =
        draw(scene, {.technique = "bounded", .budget = {.bytes = memory}, .keep_fragments = true});
    expect_all(result, all, std::to_string(memory));
    expect_same_image(result, expected, 1e-4F, std::to_string(memory));
    EXPECT_LE(result.stats.bytes, memory);
    rounds = result.stats.rounds;
  }
  EXPECT_EQ(rounds, 1U);
  EXPECT_THROW(draw(scene, {.technique = "multikb", .budget = {.bytes = 44 * 24}}), Error);
}

TEST_F(BoundedMemory, AllEffectsGoOnFromRoundToRound) {
  const RenderScene scene = testing::random_boxes(3, 8, 4);
  for (const NamedEffect& effect : render_effects()) {
    const RenderResult expected =
        draw(scene, {.technique = "sb", .effect = effect.effect, .plain_resolve = true});
    const RenderResult result =
        draw(scene, {.technique = "sb",
                     .effect = effect.effect,
                     .pool = {.nodes = expected.stats.fragments / 3, .overflow = Overflow::exact}});
    EXPECT_GT(result.stats.rounds, 1U) << effect.name;
    expect_same_image(result, expected, 1e-4F, effect.name);
  }
}

TEST_F(BoundedMemory, NearestAreKeptAndTheRestIsCounted) {
  const RenderScene scene = testing::random_stack(33, 60);
  const FragmentBuffer all = testing::cpu_fragments(scene, testing::unit_camera(24, 24));
  for (const std::uint64_t pool : {50U, 1000U, 1500U}) {
    const RenderResult result =
        draw(scene, {.technique = "ll", .pool = {.nodes = pool}, .keep_fragments = true});
    EXPECT_TRUE(result.stats.pool_exceeded);
    EXPECT_EQ(result.stats.captured, pool);
    EXPECT_EQ(result.stats.overflowed, all.fragments.size() - pool);
    EXPECT_EQ(result.stats.rounds, 1U);
    // Those that lost some keep the same number, give or take one.
    std::size_t least = 1000;
    std::size_t most = 0;
    for (std::size_t p = 0; p + 1 < all.offsets.size(); ++p) {
      const std::vector<Fragment> kept = testing::pixel_of(result.fragments, p);
      ASSERT_LE(kept.size(), all.pixel(p).size());
      ASSERT_TRUE(testing::same_fragments(kept, all.pixel(p).first(kept.size()))) << pool << ", pixel " << p;
      if (kept.size() == all.pixel(p).size()) continue;
      least = std::min(least, kept.size());
      most = std::max(most, kept.size());
    }
    EXPECT_LE(most, least + 1) << pool;
  }
}

// A layer's colour times opacity, and its opacity, as any technique draws it: over black and over white.
struct Layer {
  Vec3f premultiplied;
  float alpha = 0;
};
Layer layer_of(const RenderScene& scene) {
  Renderer& renderer = testing::test_renderer();
  renderer.load(scene);
  const Camera camera = testing::unit_camera(4, 4);
  const Vec3f black = renderer.draw(camera, {.technique = "multikb", .background = {0, 0, 0}}).pixels[0];
  const Vec3f white = renderer.draw(camera, {.technique = "multikb", .background = {1, 1, 1}}).pixels[0];
  return {black, 1 - (white.x - black.x)};
}

TEST_F(BoundedMemory, LostFragmentsAreSeenAsTheirAverage) {
  const std::array<float, 5> depths{0.125F, 0.25F, 0.5F, 0.625F, 0.75F};
  std::vector<Layer> layers;
  RenderScene scene;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    RenderScene square = testing::coplanar_squares(1, depths.at(i));
    square.surfaces[0].alpha = 0.3F + 0.15F * static_cast<float>(i);
    square.surfaces[0].color = {0.2F * static_cast<float>(i), 0.9F - 0.2F * static_cast<float>(i), 0.5F};
    layers.push_back(layer_of(square));
    scene = i == 0 ? square : testing::joined(square, scene);  // drawn back to front
  }
  for (const std::uint64_t places : {0U, 1U, 2U, 4U}) {
    Vec3f color{0, 0, 0};
    float left = 1;  // of the light from behind
    for (std::size_t i = 0; i < places; ++i) {
      color = color + layers[i].premultiplied * left;
      left *= 1 - layers[i].alpha;
    }
    Vec3f sum{0, 0, 0};
    float weights = 0;
    float through = 1;
    for (std::size_t i = places; i < layers.size(); ++i) {
      sum = sum + layers[i].premultiplied;
      weights += layers[i].alpha;
      through *= 1 - layers[i].alpha;
    }
    color = color + sum * (left * (1 - through) / weights);
    left *= through;
    color = color + Vec3f{0.2F, 0.4F, 0.8F} * left;
    // Without places for all, one pixel of 16 has one, and only others are looked at.
    const std::uint64_t pool = places == 0 ? 1 : 16 * places;
    const RenderResult result =
        draw(scene, {.technique = "sb", .background = {0.2F, 0.4F, 0.8F}, .pool = {.nodes = pool}}, 4);
    const std::size_t pixel = places == 0 ? 3 : 0;
    EXPECT_LT(testing::difference(result.pixels[pixel], color), 2e-4F) << places;
  }
}

TEST_F(BoundedMemory, SequenceAndThreadsDoNotMatter) {
  RenderScene scene = testing::random_stack(34, 80);
  const RenderOptions options{.technique = "sb", .pool = {.nodes = 800}};
  const RenderResult straight = draw(scene, options);
  Random random(7);
  for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) scene.draw_order.push_back(i);
  for (std::size_t i = scene.draw_order.size(); i > 1; --i)
    std::swap(scene.draw_order[i - 1], scene.draw_order[random.below(i)]);
  const RenderResult shuffled = draw(scene, options);
  EXPECT_EQ(straight.pixels, shuffled.pixels);
  EXPECT_EQ(straight.stats.captured, shuffled.stats.captured);
  // The CPU driver has as many threads as it is told when it is started.
  for (const char* threads : {"0", "1", "5"}) {
    ::setenv("LP_NUM_THREADS", threads, 1);
    Renderer other({.device = testing::test_renderer().info().name});
    ::unsetenv("LP_NUM_THREADS");
    other.load(scene);
    EXPECT_EQ(other.draw(testing::unit_camera(24, 24), options).pixels, straight.pixels) << threads;
  }
}

TEST_F(BoundedMemory, Samples) {
  const RenderScene scene = testing::random_stack(35, 40);
  const RenderResult expected = draw(scene, {.technique = "sb", .samples = 4, .plain_resolve = true}, 12);
  const RenderResult result =
      draw(scene,
           {.technique = "sb",
            .samples = 4,
            .pool = {.nodes = expected.stats.fragments / 2, .overflow = Overflow::exact}},
           12);
  EXPECT_EQ(result.stats.captured, expected.stats.captured);
  expect_same_image(result, expected, 1e-4F, "4 samples");
}

// Pools have no more nodes than there are fragments, whatever is asked for.
TEST_F(BoundedMemory, HugePoolsAreNoLargerThanNeeded) {
  Renderer& renderer = testing::test_renderer();
  renderer.load(testing::random_stack(8, 60));
  const Camera camera = testing::unit_camera(24, 16);
  for (const char* technique : {"sb", "ll", "f2b-ll"}) {
    const RenderResult expected = renderer.draw(camera, {.technique = technique});
    for (const unsigned bits : {32U, 60U, 62U}) {
      const RenderResult result =
          renderer.draw(camera, {.technique = technique, .pool = {.nodes = std::uint64_t{1} << bits}});
      EXPECT_EQ(result.stats.captured, expected.stats.captured) << technique << " " << bits;
      EXPECT_EQ(result.stats.bytes, expected.stats.bytes) << technique << " " << bits;
    }
  }
  EXPECT_EQ(testing::first_validation_message(), "");
}

TEST_F(BoundedMemory, ATailOfManyOpaqueFragmentsIsNoHole) {
  Renderer& renderer = testing::test_renderer();
  RenderScene scene = testing::coplanar_squares(256, 0.5F);
  for (Surface& surface : scene.surfaces) {
    surface.alpha = 1;
    surface.color = {0.1F, 0.1F, 0.1F};
  }
  renderer.load(scene);
  const RenderResult result = renderer.draw(
      testing::unit_camera(4, 4), {.technique = "sb", .background = {9, 9, 9}, .pool = {.nodes = 1}});
  EXPECT_EQ(result.stats.overflowed, 256U * 16 - 1);
  for (const Vec3f& pixel : result.pixels) EXPECT_LT(pixel.x, 0.5F);
}

}  // namespace
}  // namespace pellucid
