// Every technique against the CPU raster: the same fragments, in the same order, each once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "render_helpers.h"

namespace pellucid {
namespace {

std::vector<std::string> technique_names() {
  std::vector<std::string> names;
  for (const TechniqueInfo& info : render_techniques()) names.push_back(info.name);
  return names;
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
  // Depths increase, no fragment comes twice, and each is one of the oracle's; of exact techniques all are there.
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
  }
  static bool agrees(std::vector<Fragment> captured, std::span<const Fragment> expected, bool all) {
    const auto key = [](const Fragment& f) { return std::make_pair(f.depth, f.node); };
    const auto before = [&](const Fragment& a, const Fragment& b) { return key(a) < key(b); };
    if (!std::is_sorted(captured.begin(), captured.end(), [](const auto& a, const auto& b) { return a.depth < b.depth; })) {
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

TEST_P(Capture, PicturesOfOddSize) {
  expect_as_oracle(testing::random_stack(4, 30), testing::unit_camera(37, 37));
}

// A triangle that covers a whole tile of a CPU driver may not undo what was stored before.
TEST_P(Capture, TrianglesOverTheWholePicture) {
  expect_as_oracle(testing::joined(testing::coplanar_squares(5, 0.5F), testing::coplanar_squares(2, 0.25F)),
                   testing::unit_camera(128, 128));
}

TEST_P(Capture, NearestAndFarthestDepth) {
  const RenderScene scene = testing::joined(testing::coplanar_squares(3, 0.0F), testing::coplanar_squares(2, 1.0F));
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

// Pixels of many layers: more than any array in registers.
TEST_P(Capture, DeepPixels) {
  RenderScene scene = testing::coplanar_squares(1, 0);
  for (std::uint32_t i = 1; i < 75; ++i) {
    scene = testing::joined(scene, testing::coplanar_squares(1 + i % 3 / 2, static_cast<float>(i) / 128.0F));
  }
  expect_as_oracle(scene, testing::unit_camera(8, 8));
}

// What is drawn does not depend on the sequence in which it is drawn.
TEST_P(Capture, ShuffledTrianglesGiveTheSamePicture) {
  if (!info_.exact) GTEST_SKIP() << "not exact";
  RenderScene scene = testing::random_stack(5, 80);
  const Camera camera = testing::unit_camera(48, 48);
  const RenderResult straight = draw(scene, camera);
  Random random(7);
  for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) scene.sequence.push_back(i);
  for (std::size_t i = scene.sequence.size(); i > 1; --i) std::swap(scene.sequence[i - 1], scene.sequence[random.below(i)]);
  const RenderResult shuffled = draw(scene, camera);
  EXPECT_EQ(straight.pixels, shuffled.pixels);
}

INSTANTIATE_TEST_SUITE_P(Techniques, Capture, ::testing::ValuesIn(technique_names()), [](const auto& parameter) {
  std::string name = parameter.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace pellucid
