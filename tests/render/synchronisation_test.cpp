// Tests that all ways of keeping fragments of a pixel apart capture the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <span>
#include <utility>

#include "render/frame.h"
#include "render_helpers.h"

namespace pellucid {
namespace testing {

// SPIR-V of shaders beside this, in a source that the build makes.
std::span<const std::uint32_t> replay_keys_code();
std::span<const std::uint32_t> replay_halves_code();
std::span<const std::uint32_t> replay_lock_code();

}  // namespace testing

namespace {

class Synchronisation : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }

  static std::vector<Sync> ways(std::uint32_t k) {
    const DeviceInfo& info = testing::test_renderer().info();
    std::vector<Sync> all;
    if (info.atomics64) all.push_back(Sync::atomics);
    if (3 * k <= 4 * info.ordered_attachments) all.push_back(Sync::ordered);
    if (info.interlock) all.push_back(Sync::interlock);
    return all;
  }
  static RenderResult draw(std::uint32_t k, Sync sync, Effect effect = Effect::transparency) {
    return testing::test_renderer().draw(
        testing::unit_camera(48, 40),
        {.technique = "kb", .effect = effect, .k = k, .k_buffer = {.sync = sync}, .keep_fragments = true});
  }
};

TEST_F(Synchronisation, AllWaysCaptureTheSame) {
  RenderScene scene = testing::random_stack(41, 90);
  const FragmentBuffer all = testing::cpu_fragments(scene, testing::unit_camera(48, 40));
  for (const bool shuffled : {false, true}) {
    if (shuffled) {
      for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) scene.draw_order.push_back(i);
      Random random(7);
      for (std::size_t i = scene.draw_order.size(); i > 1; --i)
        std::swap(scene.draw_order[i - 1], scene.draw_order[random.below(i)]);
    }
    testing::test_renderer().load(scene);
    for (const std::uint32_t k : {1U, 3U, 8U, 10U}) {
      std::vector<Vec3f> image;
      for (const Sync sync : ways(k)) {
        const RenderResult result = draw(k, sync);
        const auto what = std::to_string(static_cast<int>(sync)) + ", k " + std::to_string(k);
        EXPECT_EQ(result.stats.sync, sync) << what;
        EXPECT_EQ(result.stats.geometry_passes, sync == Sync::atomics ? 2U : 1U) << what;
        for (std::size_t p = 0; p + 1 < all.offsets.size(); ++p) {
          const auto nearest = all.pixel(p).first(std::min<std::size_t>(k, all.pixel(p).size()));
          ASSERT_TRUE(testing::same_fragments(testing::pixel_of(result.fragments, p), nearest))
              << what << ", pixel " << p;
        }
        if (image.empty()) image = result.pixels;
        EXPECT_EQ(result.pixels, image) << what;
      }
    }
  }
}

TEST_F(Synchronisation, OtherEffectsGetTheSame) {
  testing::test_renderer().load(testing::random_boxes(5, 8, 4));
  for (const Effect effect : {Effect::wireframe, Effect::coplanarity}) {
    std::vector<Vec3f> image;
    for (const Sync sync : ways(8)) {
      const RenderResult result = draw(8, sync, effect);
      if (image.empty()) image = result.pixels;
      EXPECT_EQ(result.pixels, image) << static_cast<int>(sync);
    }
  }
}

TEST_F(Synchronisation, WhatDoesNotFitIsRefusedOrReplaced) {
  Renderer& renderer = testing::test_renderer();
  const DeviceInfo& info = renderer.info();
  renderer.load(testing::coplanar_squares(3, 0.5F));
  const Camera camera = testing::unit_camera(8, 8);
  const auto refusal = [&](const RenderOptions& options) -> std::string {
    try {
      renderer.draw(camera, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_argument);
      return error.what();
    }
    return "";
  };
  if (!info.interlock) {
    EXPECT_THAT(refusal({.technique = "kb", .k_buffer = {.sync = Sync::interlock}}),
                ::testing::HasSubstr("VK_EXT_fragment_shader_interlock"));
  }
  EXPECT_THAT(refusal({.technique = "kb", .k = 64, .k_buffer = {.sync = Sync::ordered}}),
              ::testing::HasSubstr("ordered synchronisation"));
  if (!info.atomics64) return;
  EXPECT_EQ(renderer.draw(camera, {.technique = "kb", .k = 64}).stats.sync,
            info.interlock ? Sync::interlock : Sync::atomics);
  EXPECT_EQ(renderer.draw(camera, {.technique = "sb", .k_buffer = {.sync = Sync::ordered}}).stats.sync,
            Sync::automatic);
}

// The chain of atomic minima, with keys of a few pixels inserted by thousands of invocations at once.
TEST_F(Synchronisation, ChainOfMinimaUnderContention) {
  if (!testing::test_renderer().info().atomics64) GTEST_SKIP() << "this device has no 64-bit atomics";
  constexpr std::uint32_t kPixels = 4;
  constexpr std::uint32_t kSlotsOfPixel = 8;
  constexpr std::uint32_t kKeys = 1U << 17U;
  Random random(3);
  std::vector<std::uint64_t> list;
  std::vector<std::uint32_t> pixels;
  std::vector<std::vector<std::uint64_t>> expected(kPixels);
  for (std::uint32_t i = 0; i < kKeys; ++i) {
    // Half of them nearer than all before, so that whole chains move.
    const std::uint64_t depth = random.below(2) == 0 ? kKeys - i : random.below(kKeys);
    list.push_back((depth << 32U) | (i + 2));
    pixels.push_back(static_cast<std::uint32_t>(random.below(kPixels)));
    expected[pixels.back()].push_back(list.back());
  }
  std::vector<std::uint64_t> nearest;
  for (auto& keys : expected) {
    std::partial_sort(keys.begin(), keys.begin() + kSlotsOfPixel, keys.end());
    nearest.insert(nearest.end(), keys.begin(), keys.begin() + kSlotsOfPixel);
  }

  render::Context context(
      {.device = testing::test_renderer().info().name, .validate = testing::validation_is_on()});
  const render::Buffer unused(context, "unused slot", 16);
  const render::Buffer keys =
      render::make_filled(context, "keys", std::vector(nearest.size(), ~std::uint64_t{0}));
  const render::Buffer given = render::make_filled(context, "list", list);
  const render::Buffer pixel_of = render::make_filled(context, "pixels", pixels);
  const render::OwnedPipeline pipeline =
      render::make_compute_pipeline(context, testing::replay_keys_code(), {0, kSlotsOfPixel});
  context.submit([&](VkCommandBuffer commands) {
    render::Recorder recorder(context, commands, unused, VK_NULL_HANDLE);
    recorder.bind(render::Slot::a, keys);
    recorder.bind(render::Slot::b, given);
    recorder.bind(render::Slot::c, pixel_of);
    recorder.push().p[0] = kKeys;
    recorder.dispatch(pipeline, kKeys / 64, 1);
  });
  std::vector<std::uint64_t> found(nearest.size());
  keys.download(context, std::as_writable_bytes(std::span(found)));
  EXPECT_EQ(found, nearest);
  EXPECT_TRUE(context.validation_messages().empty());
}

// The same without 64-bit atomics: depths, ids and colours of fragments of which many share a depth, and the
// sum of what found no place.
TEST_F(Synchronisation, ChainsOfHalvesUnderContention) {
  constexpr std::uint32_t kPixels = 4;
  constexpr std::uint32_t kSlotsOfPixel = 9;  // the last is the tail
  constexpr std::uint32_t kFragments = 1U << 16U;
  constexpr std::uint32_t kMark = 1U << 31U;
  Random random(5);
  using Given = std::array<std::uint32_t, 4>;  // pixel, depth, id, colour
  std::vector<Given> list;
  std::vector<std::vector<Given>> of_pixel(kPixels);
  for (std::uint32_t i = 0; i < kFragments; ++i) {
    const auto pixel = static_cast<std::uint32_t>(random.below(kPixels));
    // Colours that may be taken for ids, and groups of some five at a depth, the nearest last.
    list.push_back(
        {pixel, (kFragments - i) / 20, i + 2, static_cast<std::uint32_t>(random.below(kFragments))});
    of_pixel[pixel].push_back(list.back());
  }
  std::vector<std::uint64_t> expected;
  for (auto& fragments : of_pixel) {
    std::sort(fragments.begin(), fragments.end(),
              [](const Given& a, const Given& b) { return std::pair(a[1], a[2]) < std::pair(b[1], b[2]); });
    std::uint64_t tail = ~std::uint64_t{0};
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      const auto [pixel, depth, id, color] = fragments[i];
      if (i + 1 < kSlotsOfPixel) {
        expected.push_back((std::uint64_t{kMark | depth} << 32U) | color);
      } else {
        tail += (std::uint64_t{color} << 32U) | id;
      }
    }
    expected.push_back(tail);
  }

  render::Context context(
      {.device = testing::test_renderer().info().name, .validate = testing::validation_is_on()});
  const render::Buffer unused(context, "unused slot", 16);
  const render::Buffer pool =
      render::make_filled(context, "pool", std::vector(expected.size(), ~std::uint64_t{0}));
  const render::Buffer given = render::make_filled(context, "list", list);
  std::vector<render::OwnedPipeline> passes;
  for (const std::uint32_t pass : {0U, 1U, 2U})
    passes.push_back(render::make_compute_pipeline(context, testing::replay_halves_code(), {0, pass}));
  context.submit([&](VkCommandBuffer commands) {
    render::Recorder recorder(context, commands, unused, VK_NULL_HANDLE);
    recorder.bind(render::Slot::a, pool);
    recorder.bind(render::Slot::c, given);
    recorder.push().p = {kSlotsOfPixel, 1, kFragments, 0};
    for (const render::OwnedPipeline& pass : passes) {
      recorder.dispatch(pass, kFragments / 64, 1);
      recorder.barrier();
    }
  });
  std::vector<std::uint64_t> found(expected.size());
  pool.download(context, std::as_writable_bytes(std::span(found)));
  EXPECT_EQ(found, expected);
  EXPECT_TRUE(context.validation_messages().empty());
}

// Critical sections, with an array and with a heap. In kernels of lavapipe holders of a lock may be suspended
// for long where it has several threads; invocations of one of them contend all the same.
TEST_F(Synchronisation, SpinLocksUnderContention) {
  constexpr std::uint32_t kPixels = 4;
  constexpr std::uint32_t kKept = 20;
  constexpr std::uint32_t kFragments = 1U << 14U;
  constexpr std::uint64_t kUnlocked = std::uint64_t{1} << 63U;
  Random random(6);
  std::vector<std::array<std::uint32_t, 4>> list;
  std::vector<std::vector<std::uint64_t>> expected(kPixels);
  for (std::uint32_t i = 0; i < kFragments; ++i) {
    const auto pixel = static_cast<std::uint32_t>(random.below(kPixels));
    const std::uint32_t depth = (kFragments - i) / 20;
    list.push_back({pixel, depth, i + 2, 0});
    expected[pixel].push_back((std::uint64_t{depth} << 32U) | (i + 2));
  }
  for (auto& keys : expected) {
    std::partial_sort(keys.begin(), keys.begin() + kKept, keys.end());
    keys.resize(kKept);
  }
  ::setenv("LP_NUM_THREADS", "0", 1);
  render::Context context(
      {.device = testing::test_renderer().info().name, .validate = testing::validation_is_on()});
  ::unsetenv("LP_NUM_THREADS");
  const render::Buffer unused(context, "unused slot", 16);
  const render::Buffer given = render::make_filled(context, "list", list);
  for (const std::uint32_t heap_from : {1U, 1000U}) {
    const std::size_t slots = std::size_t{kPixels} * (kKept + 1);
    const render::Buffer pool = render::make_filled(context, "pool", std::vector(slots, ~std::uint64_t{0}));
    const render::Buffer counters =
        render::make_filled(context, "counters", std::vector<render::Counters>(1));
    const render::OwnedPipeline pipeline =
        render::make_compute_pipeline(context, testing::replay_lock_code(), {0, heap_from});
    context.submit([&](VkCommandBuffer commands) {
      render::Recorder recorder(context, commands, unused, VK_NULL_HANDLE);
      recorder.bind(render::Slot::a, pool);
      recorder.bind(render::Slot::c, given);
      recorder.bind(render::Slot::counters, counters);
      recorder.push().p = {kKept + 1, 1, 2000, kFragments};
      recorder.dispatch(pipeline, kFragments / 64, 1);
    });
    std::vector<std::uint64_t> found(slots);
    pool.download(context, std::as_writable_bytes(std::span(found)));
    std::array<render::Counters, 1> counted{};
    counters.download(context, std::as_writable_bytes(std::span(counted)));
    EXPECT_EQ(counted[0].overflowed, 0U);
    for (std::uint32_t p = 0; p < kPixels; ++p) {
      const auto first = found.begin() + std::ptrdiff_t{p} * (kKept + 1);
      EXPECT_EQ(*first, expected[p].back() | kUnlocked)
          << "the farthest comes first, and nobody has the lock";
      *first &= ~kUnlocked;
      std::sort(first, first + kKept);
      EXPECT_TRUE(std::equal(expected[p].begin(), expected[p].end(), first)) << heap_from << ", pixel " << p;
    }
  }
  EXPECT_TRUE(context.validation_messages().empty());
}

}  // namespace
}  // namespace pellucid
