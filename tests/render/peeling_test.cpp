// Tests techniques that peel: how much they capture, and in how many rounds and passes.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "render_helpers.h"

namespace pellucid {
namespace {

class Peeling : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }

  static bool missing(const std::string& technique) {
    const auto infos = render_techniques();
    const auto info =
        std::find_if(infos.begin(), infos.end(), [&](const auto& i) { return i.name == technique; });
    return !missing_for(*info, testing::test_renderer().info()).empty();
  }
};

// Fragments of a scene where only `most` of those at one depth are captured.
std::uint64_t captured_of_groups(const FragmentBuffer& all, std::uint64_t most) {
  std::uint64_t captured = 0;
  for (std::size_t p = 0; p + 1 < all.offsets.size(); ++p) {
    std::map<float, std::uint64_t> groups;
    for (const Fragment& f : all.pixel(p)) ++groups[f.depth];
    for (const auto& [depth, count] : groups) captured += std::min(count, most);
  }
  return captured;
}

// Layers of 5, 1, 2 and 3 coplanar fragments at every pixel.
RenderScene four_layers() {
  RenderScene scene = testing::coplanar_squares(5, 0.125F);
  scene = testing::joined(scene, testing::coplanar_squares(1, 0.25F));
  scene = testing::joined(scene, testing::coplanar_squares(2, 0.5F));
  return testing::joined(scene, testing::coplanar_squares(3, 1.0F));
}

TEST_F(Peeling, InexactTechniquesLoseOnlyCoplanarFragments) {
  const RenderScene scene = testing::random_stack(21, 80);
  const Camera camera = testing::unit_camera(48, 48);
  const FragmentBuffer all = testing::cpu_fragments(scene, camera);
  Renderer& renderer = testing::test_renderer();
  renderer.load(scene);
  for (const char* name : {"f2b", "f2b2", "dual"}) {
    if (missing(name)) continue;
    EXPECT_EQ(renderer.draw(camera, {.technique = name}).stats.captured, captured_of_groups(all, 1)) << name;
  }
  for (const char* name : {"f2b-fab", "dual-fab"}) {
    for (const std::uint32_t k : {1U, 4U}) {
      const CaptureStats stats = renderer.draw(camera, {.technique = name, .k = k}).stats;
      EXPECT_EQ(stats.captured, captured_of_groups(all, k)) << name << " " << k;
      EXPECT_EQ(stats.captured + stats.overflowed, stats.fragments) << name << " " << k;
    }
  }
}

TEST_F(Peeling, AnyNumberOfPlacesIsEnoughForWhatIsResumed) {
  const RenderScene scene = testing::random_stack(22, 80);
  const Camera camera = testing::unit_camera(48, 48);
  Renderer& renderer = testing::test_renderer();
  renderer.load(scene);
  const RenderResult expected =
      renderer.draw(camera, {.technique = "sb", .plain_resolve = true, .keep_fragments = true});
  for (const char* name : {"f2b-kb", "dual-kb"}) {
    if (missing(name)) continue;
    for (const std::uint32_t k : {1U, 3U}) {
      const RenderResult result = renderer.draw(camera, {.technique = name, .k = k, .keep_fragments = true});
      EXPECT_EQ(result.stats.captured, expected.stats.captured) << name << " " << k;
      EXPECT_EQ(result.stats.coplanar, expected.stats.coplanar) << name << " " << k;
      // Also within a group: these come in the order of their ids.
      EXPECT_TRUE(std::ranges::equal(
          result.fragments.fragments, expected.fragments.fragments,
          [](const Fragment& a, const Fragment& b) { return a.depth == b.depth && a.node == b.node; }))
          << name << " " << k;
    }
  }
}

TEST_F(Peeling, RoundsAndPasses) {
  struct Expected {
    const char* name;
    std::uint32_t rounds, passes;
  };
  Renderer& renderer = testing::test_renderer();
  renderer.load(four_layers());
  // With k = 2, layers of 5, 1, 2, 3 are peeled in 3, 1, 1, 2 rounds.
  for (const Expected& expected : std::initializer_list<Expected>{{"f2b", 5, 5},
                                                                  {"f2b2", 5, 10},
                                                                  {"f2b-2p", 8, 15},
                                                                  {"f2b-3p", 8, 24},
                                                                  {"f2b-ll", 5, 10},
                                                                  {"f2b-kb", 8, 16},
                                                                  {"f2b-fab", 5, 10},
                                                                  {"dual", 3, 3},
                                                                  {"dual-2p", 5, 9},
                                                                  {"dual-ll", 3, 3},
                                                                  {"dual-kb", 5, 5},
                                                                  {"dual-fab", 3, 3}}) {
    if (missing(expected.name)) continue;
    const CaptureStats stats =
        renderer.draw(testing::unit_camera(16, 16), {.technique = expected.name, .k = 2}).stats;
    EXPECT_EQ(stats.rounds, expected.rounds) << expected.name;
    EXPECT_EQ(stats.geometry_passes, expected.passes) << expected.name;
  }
}

// Layers of 5 x 256, 256, 2 x 256, 3 x 256 fragments: a pool for each of them suffices, one for less does
// what pools do that are too small for all.
TEST_F(Peeling, LayersThatDoNotFitAreCapturedInRounds) {
  const RenderScene scene = four_layers();
  Renderer& renderer = testing::test_renderer();
  renderer.load(scene);
  for (const char* name : {"f2b-ll", "dual-ll"}) {
    if (missing(name)) continue;
    RenderOptions options{.technique = name, .pool = {.nodes = 8 * 256}};
    EXPECT_FALSE(renderer.draw(testing::unit_camera(16, 16), options).stats.pool_exceeded) << name;
    options.pool.nodes = 300;
    const RenderResult drawn = renderer.draw(testing::unit_camera(16, 16), options);
    options.technique = "sb";
    const RenderResult expected = renderer.draw(testing::unit_camera(16, 16), options);
    EXPECT_TRUE(drawn.stats.pool_exceeded) << name;
    EXPECT_EQ(drawn.stats.captured, 300U) << name;
    EXPECT_EQ(drawn.stats.overflowed, expected.stats.overflowed) << name;
    EXPECT_EQ(drawn.pixels, expected.pixels) << name;
  }
}

// Lists are searched for the next id again and again, and a driver may limit the turns of loops: then again.
TEST_F(Peeling, LargeGroups) {
  struct Expected {
    const char* name;
    std::uint32_t copies;
    bool at_once;
  };
  const bool limited = testing::test_renderer().info().cpu;
  for (const Expected& expected : std::initializer_list<Expected>{{"f2b-2p", 50, true},
                                                                  {"f2b-3p", 50, true},
                                                                  {"f2b-kb", 200, true},
                                                                  {"f2b-ll", 200, true},
                                                                  {"f2b-ll", 400, !limited},
                                                                  {"dual-2p", 50, true},
                                                                  {"dual-kb", 200, true},
                                                                  {"dual-ll", 200, true},
                                                                  {"dual-ll", 400, !limited}}) {
    if (missing(expected.name)) continue;
    testing::test_renderer().load(testing::coplanar_squares(expected.copies, 0.5F));
    const CaptureStats stats = testing::test_renderer()
                                   .draw(testing::unit_camera(8, 8),
                                         {.technique = expected.name, .effect = Effect::complexity, .k = 64})
                                   .stats;
    EXPECT_EQ(stats.captured, 64U * expected.copies) << expected.name;
    EXPECT_EQ(stats.overflowed, 0U) << expected.name;
    EXPECT_EQ(!stats.pool_exceeded, expected.at_once) << expected.name << " " << expected.copies;
  }
}

// What the turns left over by the near end do not suffice for is found by capturing once more.
TEST_F(Peeling, LargeGroupsAtBothEnds) {
  if (missing("dual-ll")) GTEST_SKIP() << "this device has no 64-bit atomics";
  RenderScene scene =
      testing::joined(testing::coplanar_squares(300, 0.0F), testing::coplanar_squares(2, 0.25F));
  scene = testing::joined(scene, testing::coplanar_squares(3, 0.5F));
  testing::test_renderer().load(testing::joined(scene, testing::coplanar_squares(300, 1.0F)));
  const RenderOptions options{.technique = "dual-ll", .effect = Effect::complexity, .keep_fragments = true};
  const RenderResult result = testing::test_renderer().draw(testing::unit_camera(8, 8), options);
  EXPECT_EQ(result.stats.captured, 64U * 605U);
  EXPECT_EQ(result.fragments.fragments.size(), 64U * 605U);
  EXPECT_EQ(result.fragments.offsets.size(), 65U);
  EXPECT_EQ(result.pixels.size(), 64U);
}

}  // namespace
}  // namespace pellucid
