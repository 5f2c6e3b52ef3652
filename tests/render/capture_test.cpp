// Tests every technique against the CPU raster: it delivers the same fragments, in the same order, each once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "render_helpers.h"

namespace pellucid {
namespace {

std::vector<std::string> technique_names() {
  return testing::techniques_that([](const TechniqueInfo& info) { return !info.blends_only; });
}

class Capture : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const auto infos = render_techniques();
    info_ = *std::find_if(infos.begin(), infos.end(), [](const auto& i) { return i.name == GetParam(); });
    const std::string missing = missing_for(info_, testing::test_renderer().info());
    if (!missing.empty()) GTEST_SKIP() << "this device has no " << missing;
    options_.technique = GetParam();
    options_.keep_fragments = true;
  }
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }

  RenderResult draw(const RenderScene& scene, const Camera& camera) {
    testing::test_renderer().load(scene);
    return testing::test_renderer().draw(camera, options_);
  }
  // Depths increase, no fragment comes twice, and each is one of the oracle's; of exact techniques all are
  // there.
  void expect_as_oracle(const RenderScene& scene, const Camera& camera) {
    const RenderResult result = draw(scene, camera);
    const FragmentBuffer oracle = testing::cpu_fragments(scene, camera);
    ASSERT_EQ(result.fragments.offsets.size(), oracle.offsets.size());
    EXPECT_EQ(result.stats.fragments, oracle.fragments.size());
    EXPECT_EQ(result.stats.captured, result.fragments.fragments.size());
    EXPECT_EQ(result.stats.covered_pixels, oracle.covered_pixels());
    const bool all = info_.exact && result.stats.overflowed == 0;
    std::size_t wrong = 0;
    for (std::size_t p = 0; p + 1 < oracle.offsets.size(); ++p) {
      if (!agrees(testing::pixel_of(result.fragments, p), oracle.pixel(p), all) && ++wrong < 4) {
        ADD_FAILURE() << GetParam() << ", pixel " << p % camera.width << ", " << p / camera.width << ": "
                      << testing::pixel_of(result.fragments, p).size() << " of " << oracle.pixel(p).size();
      }
    }
    EXPECT_EQ(wrong, 0U);
    if (all) expect_coplanar_counts(oracle, result.stats);
  }
  static void expect_coplanar_counts(const FragmentBuffer& oracle, const CaptureStats& stats) {
    std::uint64_t fragments = 0;
    std::uint64_t pixels = 0;
    for (std::size_t p = 0; p + 1 < oracle.offsets.size(); ++p) {
      std::uint64_t here = 0;
      const auto list = oracle.pixel(p);
      for (std::size_t i = 0; i < list.size(); ++i) {
        const bool shared = (i > 0 && list[i].depth == list[i - 1].depth) ||
                            (i + 1 < list.size() && list[i].depth == list[i + 1].depth);
        here += shared ? 1U : 0U;
      }
      fragments += here;
      pixels += here > 0 ? 1U : 0U;
    }
    EXPECT_EQ(stats.coplanar, fragments);
    EXPECT_EQ(stats.coplanar_pixels, pixels);
  }
  static bool agrees(std::vector<Fragment> captured, std::span<const Fragment> expected, bool all) {
    const auto key = [](const Fragment& f) { return std::make_pair(f.depth, f.node); };
    const auto before = [&](const Fragment& a, const Fragment& b) { return key(a) < key(b); };
    if (!std::is_sorted(captured.begin(), captured.end(),
                        [](const auto& a, const auto& b) { return a.depth < b.depth; })) {
      return false;
    }
    // Within a group at one depth, techniques that take two at a time deliver both of its ends first.
    std::sort(captured.begin(), captured.end(), before);
    const auto same = [&](const Fragment& a, const Fragment& b) { return key(a) == key(b); };
    if (std::adjacent_find(captured.begin(), captured.end(), same) != captured.end()) return false;
    return all ? std::equal(captured.begin(), captured.end(), expected.begin(), expected.end(), same)
               : std::includes(expected.begin(), expected.end(), captured.begin(), captured.end(), before);
  }

  RenderOptions options_;
  TechniqueInfo info_;
};

TEST_P(Capture, RandomStacksOfCoplanarTriangles) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    expect_as_oracle(testing::random_stack(seed, 60), testing::unit_camera(64, 64));
  }
}

TEST_P(Capture, ImagesOfOddSize) {
  expect_as_oracle(testing::random_stack(4, 30), testing::unit_camera(37, 37));
}

// A triangle that covers a whole tile of a CPU driver may not undo what was stored before.
TEST_P(Capture, TrianglesOverTheWholeImage) {
  expect_as_oracle(testing::joined(testing::coplanar_squares(5, 0.5F), testing::coplanar_squares(2, 0.25F)),
                   testing::unit_camera(128, 128));
}

TEST_P(Capture, NearestAndFarthestDepth) {
  const RenderScene scene =
      testing::joined(testing::coplanar_squares(3, 0.0F), testing::coplanar_squares(2, 1.0F));
  expect_as_oracle(scene, testing::unit_camera(16, 16));
}

TEST_P(Capture, NothingAtAll) {
  RenderScene scene = testing::coplanar_squares(1, 0.5F);
  for (Vec3f& p : scene.positions) p.x += 5;
  const RenderResult result = draw(scene, testing::unit_camera(16, 16));
  EXPECT_EQ(result.stats.fragments, 0U);
  EXPECT_EQ(result.stats.captured_share(), 1.0);
  for (const Vec3f& pixel : result.pixels) EXPECT_EQ(pixel, (Vec3f{1, 1, 1}));
}

RenderScene deep_stack(std::uint32_t layers) {
  RenderScene scene = testing::coplanar_squares(1, 0);
  for (std::uint32_t i = 1; i < layers; ++i) {
    scene = testing::joined(scene, testing::coplanar_squares(1 + i % 3 / 2, static_cast<float>(i) / 128.0F));
  }
  return scene;
}

// Pixels of many layers: runs that are merged, and more than runs have room for.
TEST_P(Capture, DeepPixels) {
  expect_as_oracle(deep_stack(75), testing::unit_camera(8, 8));
  expect_as_oracle(deep_stack(120), testing::unit_camera(8, 8));
}

// The image does not depend on the draw order.
TEST_P(Capture, ShuffledTrianglesGiveTheSameImage) {
  if (!info_.order_free) GTEST_SKIP() << "captures what is drawn first";
  RenderScene scene = testing::random_stack(5, 80);
  const Camera camera = testing::unit_camera(48, 48);
  const RenderResult straight = draw(scene, camera);
  Random random(7);
  for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) scene.draw_order.push_back(i);
  for (std::size_t i = scene.draw_order.size(); i > 1; --i)
    std::swap(scene.draw_order[i - 1], scene.draw_order[random.below(i)]);
  const RenderResult shuffled = draw(scene, camera);
  EXPECT_EQ(straight.pixels, shuffled.pixels);
}

// ----------------------------------------------------------------- what the techniques keep that do not keep
// all

class Bounded : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }
  // Calls `expect(captured, of all)` for every pixel of a stack.
  template <class Expect>
  static void for_pixels(const std::string& technique, std::uint32_t k, const Expect& expect) {
    RenderOptions options;
    options.technique = technique;
    options.k = k;
    options.plain_resolve = true;  // one kernel to compile for every k, not four
    options.keep_fragments = true;
    const RenderScene scene = testing::random_stack(21, 70);
    const Camera camera = testing::unit_camera(48, 48);
    testing::test_renderer().load(scene);
    const RenderResult result = testing::test_renderer().draw(camera, options);
    const FragmentBuffer oracle = testing::cpu_fragments(scene, camera);
    for (std::size_t p = 0; p + 1 < oracle.offsets.size(); ++p) {
      expect(testing::pixel_of(result.fragments, p), oracle.pixel(p));
    }
  }
};

TEST_F(Bounded, KBufferKeepsTheNearest) {
  for (const std::uint32_t k : {1U, 3U, 8U}) {
    for_pixels("kb", k, [&](std::span<const Fragment> captured, std::span<const Fragment> all) {
      EXPECT_TRUE(testing::same_fragments(captured, all.first(std::min<std::size_t>(k, all.size()))));
    });
  }
}

TEST_F(Bounded, ArraysAndLayersKeepSoManyAsTheyHavePlacesFor) {
  for (const char* technique : {"fab", "srab"}) {
    for_pixels(technique, 3, [&](std::span<const Fragment> captured, std::span<const Fragment> all) {
      EXPECT_EQ(captured.size(), std::min<std::size_t>(3, all.size())) << technique;
    });
  }
}

// The nearest and the farthest are those of the first and the last bucket; with one bucket there are no
// others.
TEST_F(Bounded, BucketsKeepTheirEnds) {
  for (const char* technique : {"bun", "bad"}) {
    for_pixels(technique, 1, [&](std::span<const Fragment> captured, std::span<const Fragment> all) {
      ASSERT_EQ(captured.size(), std::min<std::size_t>(2, all.size())) << technique;
      if (all.empty()) return;
      EXPECT_EQ(captured.front().node, all.front().node);
      EXPECT_EQ(captured.back().node, all.back().node);
    });
    for_pixels(technique, 4, [&](std::span<const Fragment> captured, std::span<const Fragment> all) {
      EXPECT_LE(captured.size(), 8U) << technique;
      EXPECT_GE(captured.size(), std::min<std::size_t>(2, all.size())) << technique;
    });
  }
}

// Buckets that adapt to where fragments are keep more of them than uniform ones where they are not spread
// evenly.
TEST_F(Bounded, AdaptiveBucketsKeepAllDistinctDepthsOfAPixelWithFewOfThem) {
  RenderScene scene = testing::coplanar_squares(1, 0);
  for (const float depth : {0.5F, 0.50390625F, 0.5078125F, 0.51171875F, 0.515625F, 1.0F}) {
    scene = testing::joined(scene, testing::coplanar_squares(1, depth));
  }
  RenderOptions options;
  options.k = 4;
  options.plain_resolve = true;
  testing::test_renderer().load(scene);
  options.technique = "bad";
  EXPECT_EQ(testing::test_renderer().draw(testing::unit_camera(8, 8), options).stats.captured_share(), 1.0);
  options.technique = "bun";
  EXPECT_LT(testing::test_renderer().draw(testing::unit_camera(8, 8), options).stats.captured_share(), 1.0);
}

// Without statistics kernels leave a pixel where nothing behind can be seen: the same image.
TEST_F(Bounded, ImagesWithoutStatisticsAreTheSame) {
  testing::test_renderer().load(deep_stack(75));
  for (const char* technique : {"sb", "ll"}) {
    RenderOptions options;
    options.technique = technique;
    const RenderResult counted = testing::test_renderer().draw(testing::unit_camera(8, 8), options);
    options.statistics = false;
    const RenderResult fast = testing::test_renderer().draw(testing::unit_camera(8, 8), options);
    EXPECT_EQ(counted.pixels, fast.pixels) << technique;
    EXPECT_EQ(fast.stats.captured, 0U) << technique;
    EXPECT_EQ(fast.stats.fragments, counted.stats.fragments) << technique;
  }
}

// ----------------------------------------------------------------------------------------- plain blending

TEST_F(Bounded, BlendingIsRightInTheRightSequenceOnly) {
  Renderer& renderer = testing::test_renderer();
  const Camera camera = testing::unit_camera(8, 8);
  RenderScene scene =
      testing::joined(testing::coplanar_squares(2, 0.25F), testing::coplanar_squares(3, 0.5F));
  const auto largest_error = [&] {
    renderer.load(scene);
    const RenderResult exact = renderer.draw(camera, {.technique = "sb", .plain_resolve = true});
    const RenderResult blended = renderer.draw(camera, {.technique = "blend"});
    EXPECT_EQ(blended.stats.captured, exact.stats.captured);
    float largest = 0;
    for (std::size_t i = 0; i < exact.pixels.size(); ++i) {
      largest = std::max(largest, testing::difference(exact.pixels[i], blended.pixels[i]));
    }
    return largest;
  };
  EXPECT_LT(largest_error(), 1e-4F);
  for (std::uint32_t i = 0; i < scene.triangles.size(); ++i)
    scene.draw_order.insert(scene.draw_order.begin(), i);
  EXPECT_GT(largest_error(), 1e-2F);
}

TEST_F(Bounded, BlendingHasNoFragmentsToShow) {
  Renderer& renderer = testing::test_renderer();
  renderer.load(testing::coplanar_squares(1, 0.5F));
  const Camera camera = testing::unit_camera(4, 4);
  EXPECT_THROW(renderer.draw(camera, {.technique = "blend", .effect = Effect::csg}), Error);
  EXPECT_THROW(renderer.draw(camera, {.technique = "blend", .keep_fragments = true}), Error);
}

TEST_F(Bounded, PoolThatIsTooSmallIsToldOf) {
  testing::test_renderer().load(testing::random_stack(22, 60));
  for (const char* technique : {"sb", "ll", "bun-ll"}) {
    RenderOptions options;
    options.technique = technique;
    options.pool.nodes = 100;
    options.plain_resolve = true;
    const CaptureStats stats = testing::test_renderer().draw(testing::unit_camera(32, 32), options).stats;
    EXPECT_EQ(stats.captured, 100U) << technique;
    EXPECT_EQ(stats.captured + stats.overflowed, stats.fragments) << technique;
  }
}

INSTANTIATE_TEST_SUITE_P(Techniques, Capture, ::testing::ValuesIn(technique_names()),
                         testing::technique_test_name);

}  // namespace
}  // namespace pellucid
