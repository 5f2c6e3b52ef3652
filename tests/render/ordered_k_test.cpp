// Tests the ordered k-buffer: it is exact where no fragment comes after more than k farther ones, and it
// knows where.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <numeric>

#include "pellucid/sequencing.h"
#include "render_helpers.h"

namespace pellucid {
namespace {

// A fold ends where less than 1/16,384 gets through, the window does not.
constexpr float kWindowRounding = 1.0F / 16384 + 2e-6F;
constexpr std::uint32_t kMostAttachments = 8;

using Sequence = std::vector<std::uint32_t>;

// Of random_stack(), whose triangles have one depth each: by (depth, id).
Sequence by_depth(const RenderScene& scene) {
  Sequence sequence(scene.triangles.size());
  std::iota(sequence.begin(), sequence.end(), 0U);
  const auto depth = [&](std::uint32_t t) { return scene.positions[scene.triangles[t][0]].z; };
  std::stable_sort(sequence.begin(), sequence.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return depth(a) < depth(b); });
  return sequence;
}

// Only among neighbours, `block` of them.
Sequence shuffled_in_blocks(Sequence sequence, std::size_t block, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t begin = 0; begin < sequence.size(); begin += block) {
    const std::size_t end = std::min(begin + block, sequence.size());
    for (std::size_t i = end; i > begin + 1; --i)
      std::swap(sequence[i - 1], sequence[begin + random.below(i - begin)]);
  }
  return sequence;
}

// Does a fragment come after more than k farther ones?
bool one_is_too_late(std::span<const Fragment> drawn, std::uint32_t k) {
  const auto key = [](const Fragment& f) { return std::pair(f.depth, f.node); };
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const auto farther = std::count_if(drawn.begin(), drawn.begin() + static_cast<std::ptrdiff_t>(i),
                                       [&](const Fragment& f) { return key(f) > key(drawn[i]); });
    if (farther > std::ptrdiff_t{k}) return true;
  }
  return false;
}

// Pixels where one is, by the CPU's fragments in draw order.
std::uint64_t pixels_too_late(const RenderScene& scene, const Camera& camera, std::uint32_t k) {
  Sequence ranks(scene.triangles.size());
  for (std::uint32_t i = 0; i < ranks.size(); ++i) ranks[scene.draw_order[i]] = i;
  const FragmentBuffer all = testing::cpu_fragments(scene, camera);
  std::uint64_t count = 0;
  for (std::size_t p = 0; p + 1 < all.offsets.size(); ++p) {
    std::vector<Fragment> drawn(all.pixel(p).begin(), all.pixel(p).end());
    std::sort(drawn.begin(), drawn.end(), [&](const Fragment& a, const Fragment& b) {
      return ranks[triangle_of(a.node)] < ranks[triangle_of(b.node)];
    });
    if (one_is_too_late(drawn, k)) ++count;
  }
  return count;
}

// Panes over the whole image, drawn as they are named.
RenderScene panes(std::initializer_list<float> depths) {
  RenderScene scene;
  for (const float depth : depths) {
    RenderScene pane = testing::coplanar_squares(1, depth);
    pane.surfaces[0] = {.color = {depth, 1 - depth, 0.25F}, .alpha = 0.4F};
    scene = scene.triangles.empty() ? pane : testing::joined(scene, pane);
  }
  return scene;
}

float error_between(const RenderResult& a, const RenderResult& b) {
  float largest = 0;
  for (std::size_t p = 0; p < a.pixels.size(); ++p)
    largest = std::max(largest, testing::difference(a.pixels[p], b.pixels[p]));
  return largest;
}

class OrderedWindow : public ::testing::Test {
 protected:
  void SetUp() override {
    if (testing::test_renderer().info().ordered_attachments < kMostAttachments)
      GTEST_SKIP() << "too few ordered attachments";
  }
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }

  static void load(const RenderScene& scene) { testing::test_renderer().load(scene); }
  static RenderResult draw(const std::string& technique, std::uint32_t k = 8,
                           Effect effect = Effect::transparency) {
    return testing::test_renderer().draw(kCamera, {.technique = technique, .effect = effect, .k = k});
  }
  // By `sb`.
  static void expect_exact(std::uint32_t k, Effect effect = Effect::transparency) {
    const RenderResult drawn = draw("ordered-k", k, effect);
    EXPECT_LE(error_between(draw("sb", k, effect), drawn), kWindowRounding) << "k " << k;
    EXPECT_EQ(drawn.stats.misordered_pixels, 0U) << "k " << k;
    EXPECT_EQ(drawn.stats.captured, drawn.stats.fragments);
  }

  inline static const Camera kCamera = testing::unit_camera(45, 37);
};

TEST_F(OrderedWindow, RightSequencesAreExact) {
  RenderScene scene = testing::random_stack(21, 120);
  scene.draw_order = by_depth(scene);
  load(scene);
  for (const std::uint32_t k : {1U, 2U, 8U}) expect_exact(k);
  expect_exact(2, Effect::wireframe);
}

TEST_F(OrderedWindow, OfOneFragmentIsBlendingInTheRightSequence) {
  RenderScene scene = testing::random_stack(22, 120);
  scene.draw_order = by_depth(scene);
  load(scene);
  EXPECT_LE(error_between(draw("blend"), draw("ordered-k", 1)), 2e-6F);
}

TEST_F(OrderedWindow, PutsRightWhatIsUpToKPlacesTooLate) {
  RenderScene scene = testing::random_stack(23, 160);
  const Sequence right = by_depth(scene);
  for (const std::uint32_t k : {1U, 2U, 8U}) {
    scene.draw_order = shuffled_in_blocks(right, k + 1, k);
    load(scene);
    expect_exact(k);
  }
}

TEST_F(OrderedWindow, CountsPixelsWhereOneIsTooLate) {
  RenderScene scene = testing::random_stack(24, 160);
  scene.draw_order = shuffled_in_blocks(by_depth(scene), scene.triangles.size(), 5);
  load(scene);
  std::uint64_t fewer = kCamera.width * kCamera.height;
  for (const std::uint32_t k : {1U, 2U}) {
    const CaptureStats stats = draw("ordered-k", k).stats;
    EXPECT_EQ(stats.misordered_pixels, pixels_too_late(scene, kCamera, k)) << "k " << k;
    EXPECT_GT(stats.misordered_pixels, 0U);
    EXPECT_LT(stats.misordered_pixels, fewer);
    fewer = stats.misordered_pixels;
  }
}

// The nearest of three comes last: it finds the second blended when the window holds one.
TEST_F(OrderedWindow, BlendsWhatIsTooLateBehindWhatWasBlended) {
  load(panes({0.5F, 0.25F, 0.75F}));
  const RenderResult in_that_order = draw("blend");
  load(panes({0.5F, 0.75F, 0.25F}));
  const RenderResult late = draw("ordered-k", 1);
  EXPECT_EQ(late.stats.misordered_pixels, late.stats.covered_pixels);
  EXPECT_LE(error_between(in_that_order, late), 2e-6F);
  EXPECT_GT(error_between(draw("sb"), late), 0.01F);
  expect_exact(2);
}

// Fragments behind opaque surfaces are none, so they take no place.
TEST_F(OrderedWindow, OpaqueSurfacesTakeNoPlace) {
  RenderScene scene = panes({0.875F, 0.75F, 0.5F, 0.375F, 0.25F});
  scene.surfaces[2].opaque = true;
  load(scene);
  const CaptureStats stats = draw("ordered-k", 1).stats;
  EXPECT_EQ(stats.fragments, 2 * stats.covered_pixels);
  expect_exact(1);
}

TEST_F(OrderedWindow, EachSampleHasItsOwn) {
  RenderScene scene = testing::random_boxes(6, 4, 2);  // at most eight fragments in a pixel
  Sequence sequence(scene.triangles.size());
  std::iota(sequence.begin(), sequence.end(), 0U);
  scene.draw_order = shuffled_in_blocks(sequence, sequence.size(), 3);
  load(scene);
  const Camera camera = look_at_sphere({{0.5, 0.5, 0.5}, 0.9}, {normalized(Vec3d{1, 2, 3}), 3}, 41, 35);
  const auto sampled = [&](const std::string& technique, std::uint32_t k) {
    return testing::test_renderer().draw(camera, {.technique = technique, .k = k, .samples = 4});
  };
  const RenderResult drawn = sampled("ordered-k", 8);
  EXPECT_LE(error_between(sampled("sb", 8), drawn), kWindowRounding);
  EXPECT_EQ(drawn.stats.misordered_pixels, 0U);
  EXPECT_GT(sampled("ordered-k", 1).stats.misordered_pixels, 0U);
}

TEST_F(OrderedWindow, RefusesMoreThanTheAttachmentsHold) {
  load(panes({0.5F}));
  try {
    draw("ordered-k", 64);
    FAIL() << "was drawn";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_argument);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("k = 64"));
  }
  expect_exact(8);
}

}  // namespace
}  // namespace pellucid
