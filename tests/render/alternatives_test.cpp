// Tests approximations with a fixed number of bytes: they are exact where they must be, and elsewhere give
// what their papers say.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numeric>

#include "render_helpers.h"

namespace pellucid {
namespace {

constexpr std::uint32_t kImageSide = 40;
// Sums of half floats.
constexpr float kHalfRounding = 2e-3F;

RenderResult draw_by(const std::string& technique, std::uint32_t k = 8, const Vec3f& background = {1, 1, 1}) {
  return testing::test_renderer().draw(
      testing::unit_camera(kImageSide, kImageSide),
      {.technique = technique, .background = background, .k = k, .plain_resolve = true});
}

// Squares over the whole image, one at each depth.
RenderScene sheets(std::initializer_list<float> depths, float alpha) {
  RenderScene scene;
  for (const float depth : depths) {
    RenderScene layer = testing::coplanar_squares(1, depth);
    layer.surfaces[0] = {.color = {depth, 1 - depth, 0.25F}, .alpha = alpha};
    scene = scene.triangles.empty() ? layer : testing::joined(scene, layer);
  }
  return scene;
}

std::vector<std::uint32_t> shuffled_sequence(const RenderScene& scene, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::uint32_t> sequence(scene.triangles.size());
  std::iota(sequence.begin(), sequence.end(), 0U);
  for (std::size_t i = sequence.size(); i > 1; --i) std::swap(sequence[i - 1], sequence[random.below(i)]);
  return sequence;
}

class Alternatives : public ::testing::TestWithParam<TechniqueInfo> {
 protected:
  void SetUp() override {
    const std::string missing = missing_for(GetParam(), testing::test_renderer().info());
    if (!missing.empty()) GTEST_SKIP() << "this device has no " << missing;
  }
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }
};

TEST_P(Alternatives, SingleLayersAreExact) {
  for (const float alpha : {0.05F, 0.5F, 0.95F}) {
    testing::test_renderer().load(sheets({0.625F}, alpha));
    EXPECT_LE(testing::largest_difference(draw_by("sb"), draw_by(GetParam().name)), kHalfRounding) << alpha;
  }
}

TEST_P(Alternatives, OpaqueSurfacesHideWhatIsBehindThem) {
  RenderScene scene = sheets({0.25F, 0.5F, 0.75F}, 0.5F);
  scene.surfaces[1].opaque = true;
  testing::test_renderer().load(scene);
  EXPECT_LE(testing::largest_difference(draw_by("sb"), draw_by(GetParam().name)), kHalfRounding);
}

TEST_P(Alternatives, ImagesDependOnTheDrawOrderOnlyWhereTheySay) {
  RenderScene scene = testing::random_stack(61, 90);
  testing::test_renderer().load(scene);
  const RenderResult straight = draw_by(GetParam().name);
  EXPECT_EQ(draw_by(GetParam().name).pixels, straight.pixels);
  scene.draw_order = shuffled_sequence(scene, 8);
  testing::test_renderer().load(scene);
  const float changed = testing::largest_difference(straight, draw_by(GetParam().name));
  if (GetParam().order_free) {
    EXPECT_LE(changed, 2 * kHalfRounding);
  } else {
    EXPECT_GT(changed, 2 * kHalfRounding);
  }
}

// What gets through all of them is known but for rounding, even where colours are not. Opaque fragments are
// none here: `mboit4` takes them for 255/256.
TEST_P(Alternatives, TransmittanceOfAllIsExact) {
  testing::test_renderer().load(testing::random_stack(62, 120));
  const auto seen_through = [](const std::string& technique) {
    std::vector<float> light;
    const RenderResult white = draw_by(technique, 8, {1, 1, 1});
    const RenderResult black = draw_by(technique, 8, {0, 0, 0});
    for (std::size_t p = 0; p < white.pixels.size(); ++p)
      light.push_back(white.pixels[p].x - black.pixels[p].x);
    return light;
  };
  const std::vector<float> expected = seen_through("sb");
  const std::vector<float> light = seen_through(GetParam().name);
  for (std::size_t p = 0; p < light.size(); ++p) EXPECT_NEAR(light[p], expected[p], kHalfRounding);
}

TEST_P(Alternatives, TakeTheBytesAndPassesOfTheirFormulas) {
  testing::test_renderer().load(sheets({0.25F, 0.5F}, 0.5F));
  for (const std::uint32_t k : {2U, 8U}) {
    const CaptureStats stats = draw_by(GetParam().name, k).stats;
    std::string formula = GetParam().bytes_formula;
    if (formula == "4 K + 12") formula = std::to_string(4 * k + 12);
    if (formula == "16 ceil((3 K + 7) / 4)") formula = std::to_string(16 * ((3 * k + 7 + 3) / 4));
    EXPECT_EQ(std::to_string(stats.bytes / (kImageSide * kImageSide)), formula);
    EXPECT_EQ(std::to_string(stats.geometry_passes), GetParam().passes_formula);
  }
}

TEST_P(Alternatives, ImagesInBandsAreTheSame) {
  RenderScene scene = testing::random_stack(63, 24);
  Renderer limited({.device = testing::test_renderer().info().name, .max_buffer_bytes = 8000});
  limited.load(scene);
  testing::test_renderer().load(scene);
  const Camera camera = testing::unit_camera(16, 24);
  for (const std::uint32_t samples : {1U, 4U}) {
    const RenderOptions options{.technique = GetParam().name, .samples = samples};
    EXPECT_EQ(limited.draw(camera, options).pixels, testing::test_renderer().draw(camera, options).pixels)
        << samples;
  }
}

TEST_P(Alternatives, RefuseWhatTheyCannotDo) {
  testing::test_renderer().load(sheets({0.5F}, 0.5F));
  const Camera camera = testing::unit_camera(8, 8);
  for (const RenderOptions& options :
       std::initializer_list<RenderOptions>{{.technique = GetParam().name, .effect = Effect::csg},
                                            {.technique = GetParam().name, .keep_fragments = true}})
    EXPECT_THROW(testing::test_renderer().draw(camera, options), Error);
}

std::vector<TechniqueInfo> alternatives() {
  std::vector<TechniqueInfo> infos;
  for (const TechniqueInfo& info : render_techniques())
    if (info.blends_only && !info.exact && info.name != "blend") infos.push_back(info);
  return infos;
}

INSTANTIATE_TEST_SUITE_P(Techniques, Alternatives, ::testing::ValuesIn(alternatives()),
                         [](const auto& parameter) {
                           std::string name = parameter.param.name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// ------------------------------------------------------------------------------- what each of them is good
// for

class OneAlternative : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }
};

// Equation 6 with the weight of equation 10, of colours that single layers show before black.
TEST_F(OneAlternative, WeightedIsTheFormulaOfThePaper) {
  constexpr std::array<float, 3> kDepths{0.25F, 0.5F, 0.875F};
  constexpr float kAlpha = 102.0F / 255;  // as a fragment has it
  Vec3f sum{0, 0, 0};
  float weights = 0;
  for (const float depth : kDepths) {
    testing::test_renderer().load(sheets({depth}, kAlpha));
    const Vec3f shown = draw_by("sb", 8, {0, 0, 0}).pixels[0];
    const float weight = kAlpha * std::clamp(3e3F * std::pow(1 - depth, 3.0F), 1e-2F, 3e3F);
    sum = sum + shown * weight;
    weights += kAlpha * weight;
  }
  testing::test_renderer().load(sheets({kDepths[0], kDepths[1], kDepths[2]}, kAlpha));
  const float opacity = 1 - std::pow(1 - kAlpha, 3.0F);
  const Vec3f expected = sum * (opacity / weights);
  EXPECT_LE(testing::difference(draw_by("wboit", 8, {0, 0, 0}).pixels[0], expected), kHalfRounding);
}

// Four moments tell two depths apart; more of them are blurred.
TEST_F(OneAlternative, MomentsAreExactForTwoLayers) {
  for (const float alpha : {0.2F, 0.6F}) {
    testing::test_renderer().load(sheets({0.75F, 0.25F}, alpha));
    EXPECT_LE(testing::largest_difference(draw_by("sb"), draw_by("mboit4")), 3 * kHalfRounding) << alpha;
  }
  testing::test_renderer().load(sheets({0.75F, 0.25F, 0.5F, 0.375F, 0.625F, 0.125F}, 0.5F));
  const float blurred = testing::largest_difference(draw_by("sb"), draw_by("mboit4"));
  EXPECT_GT(blurred, 3 * kHalfRounding);
  EXPECT_LT(blurred, 0.05F);
}

TEST_F(OneAlternative, MultiLayerIsExactUpToFourFragments) {
  if (testing::test_renderer().info().ordered_attachments < 3) GTEST_SKIP() << "no ordered attachments";
  RenderScene scene = sheets({0.25F, 0.5F, 0.375F, 0.125F}, 0.4F);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    scene.draw_order = shuffled_sequence(scene, seed);
    testing::test_renderer().load(scene);
    EXPECT_LE(testing::largest_difference(draw_by("sb"), draw_by("mlab4")), kHalfRounding);
  }
  // More of them from front to back, too: then the farthest are merged in order.
  testing::test_renderer().load(sheets({0.125F, 0.25F, 0.375F, 0.5F, 0.625F, 0.75F, 0.875F}, 0.4F));
  EXPECT_LE(testing::largest_difference(draw_by("sb"), draw_by("mlab4")), kHalfRounding);
}

TEST_F(OneAlternative, StochasticIsRightOnAverage) {
  testing::test_renderer().load(sheets({0.75F, 0.25F, 0.5F}, 0.5F));
  const float exact = draw_by("sb").pixels[0].x;
  double last = 1;
  for (const std::uint32_t k : {2U, 8U, 32U}) {
    double sum = 0;
    double squares = 0;
    const RenderResult drawn = draw_by("stochastic", k);
    for (const Vec3f& pixel : drawn.pixels) {
      const double error = double{pixel.x} - double{exact};
      sum += error;
      squares += error * error;
    }
    const double pixels = kImageSide * kImageSide;
    const double rms = std::sqrt(squares / pixels);
    EXPECT_LT(rms, 0.65 * last) << k;
    // Means of a ratio, which the alpha correction is, are off by a share of their variance.
    EXPECT_NEAR(sum / pixels, 0, 4 * rms / std::sqrt(pixels) + 2 * rms * rms + 5e-4) << k;
    last = rms;
  }
}

}  // namespace
}  // namespace pellucid
