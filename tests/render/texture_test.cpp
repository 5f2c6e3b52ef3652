// Tests textures, vertex colours, cut-outs, unlit and emissive surfaces: the reference on cases made by hand,
// and the device against the reference.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render_helpers.h"

namespace pellucid {
namespace {

using Rgba = std::array<std::uint8_t, 4>;

constexpr Rgba kRed{255, 0, 0, 255};
constexpr Rgba kGreen{0, 255, 0, 255};
constexpr Rgba kBlue{0, 0, 255, 255};
constexpr Rgba kClear{255, 255, 255, 0};

Texture texture_of(std::uint32_t width, std::uint32_t height, const std::vector<Rgba>& texels) {
  Texture texture{width, height, {}};
  for (const Rgba& texel : texels) texture.rgba.insert(texture.rgba.end(), texel.begin(), texel.end());
  return texture;
}

// A square over the whole image; its texture coordinates are those of the image, scaled and moved.
RenderScene textured_square(const Texture& texture, float scale = 1, float offset = 0) {
  RenderScene scene = testing::coplanar_squares(1, 0.5F);
  for (const Vec3f& p : scene.positions)
    scene.texcoords.push_back({scale * p.x + offset, scale * p.y + offset});
  scene.surfaces[0] = {.color = {1, 1, 1}, .alpha = 1, .opaque = true, .texture = 0};
  scene.textures = {texture};
  return scene;
}

// The only colour of an image of one opaque square.
Vec3f lit(const Vec3f& color) {
  RenderScene scene = testing::coplanar_squares(1, 0.5F);
  scene.surfaces[0] = {.color = color, .alpha = 1, .opaque = true};
  return draw_reference(scene, testing::unit_camera(2, 2), {}).pixels[0];
}

void expect_colors(const RenderScene& scene, const std::vector<Vec3f>& colors) {
  const auto side = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(colors.size())));
  const RenderResult result = draw_reference(scene, testing::unit_camera(side, side), {});
  for (std::size_t p = 0; p < colors.size(); ++p)
    EXPECT_LT(testing::difference(result.pixels[p], lit(colors[p])), 0.05F) << "pixel " << p;
}

TEST(TextureReference, TexelsLieFromTheUpperLeft) {
  expect_colors(textured_square(texture_of(2, 2, {kRed, kGreen, kBlue, {255, 255, 255, 255}})),
                {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}});
}

TEST(TextureReference, WrapsAsTheSamplerSays) {
  Texture texture = texture_of(2, 2, {kRed, kGreen, kRed, kGreen});
  const Vec3f red{1, 0, 0};
  const Vec3f green{0, 1, 0};
  // Two texels to the right of the image's: -1.25, -0.75 ...
  const auto columns = [&](TextureWrap wrap, const std::vector<Vec3f>& row) {
    texture.sampling.wrap_u = texture.sampling.wrap_v = wrap;
    std::vector<Vec3f> colors;
    for (int i = 0; i < 4; ++i) colors.insert(colors.end(), row.begin(), row.end());
    expect_colors(textured_square(texture, 2, -1), colors);
  };
  columns(TextureWrap::repeat, {red, green, red, green});
  columns(TextureWrap::mirror, {green, red, red, green});
  columns(TextureWrap::clamp, {red, red, red, green});
}

TEST(TextureReference, CutsOutWhatIsBelowTheCutoff) {
  RenderScene scene = textured_square(texture_of(2, 2, {kRed, kClear, kClear, kRed}));
  scene.surfaces[0].cutoff = 0.5F;
  RenderOptions options;
  const Vec3f white{1, 1, 1};
  const RenderResult result = draw_reference(scene, testing::unit_camera(2, 2), options);
  EXPECT_NE(result.pixels[0], white);
  EXPECT_EQ(result.pixels[1], white);
  // Where everything is captured, what was cut out is no fragment.
  options.effect = Effect::complexity;
  EXPECT_EQ(draw_reference(scene, testing::unit_camera(2, 2), options).stats.fragments, 2U);
}

TEST(TextureReference, FarAwayItIsTheMean) {
  std::vector<Rgba> texels;
  for (std::size_t i = 0; i < 64 * 64; ++i) texels.push_back((i + i / 64) % 2 == 0 ? kRed : kGreen);
  expect_colors(textured_square(texture_of(64, 64, texels)), std::vector<Vec3f>(4, Vec3f{0.5F, 0.5F, 0}));
}

TEST(TextureReference, FiltersAsTheSamplerSays) {
  Texture texture = texture_of(2, 2, {kRed, kGreen, kRed, kGreen});
  const Vec3f red{1, 0, 0};
  const Vec3f green{0, 1, 0};
  const auto rows = [](const std::vector<Vec3f>& row) {
    std::vector<Vec3f> colors;
    for (std::size_t i = 0; i < row.size(); ++i) colors.insert(colors.end(), row.begin(), row.end());
    return colors;
  };
  // Two pixels a texel: linear mixes a quarter of the neighbour in.
  texture.sampling.wrap_u = texture.sampling.wrap_v = TextureWrap::clamp;
  expect_colors(textured_square(texture), rows({red, {0.75F, 0.25F, 0}, {0.25F, 0.75F, 0}, green}));
  texture.sampling.magnify = TextureFilter::nearest;
  expect_colors(textured_square(texture), rows({red, red, green, green}));
  // Two texels a pixel: a level has the mean, without levels the texel right of the middle is the one.
  texture.sampling = {.minify = TextureFilter::nearest, .levels = TextureLevelsUse::nearest};
  expect_colors(textured_square(texture, 2), rows({{0.5F, 0.5F, 0}, {0.5F, 0.5F, 0}}));
  texture.sampling.levels = TextureLevelsUse::none;
  expect_colors(textured_square(texture, 2, 0.02F), rows({green, green}));
  texture.sampling.minify = TextureFilter::linear;
  expect_colors(textured_square(texture, 2), rows({{0.5F, 0.5F, 0}, {0.5F, 0.5F, 0}}));
}

TEST(TextureReference, WhatDoesNotFitIsRefused) {
  RenderScene scene = textured_square(texture_of(2, 2, {kRed}));
  EXPECT_THROW(draw_reference(scene, testing::unit_camera(2, 2), {}), Error);
  EXPECT_THROW(testing::test_renderer().load(scene), Error);
  scene = textured_square(texture_of(1, 1, {kRed}));
  scene.surfaces[0].texture = 1;
  EXPECT_THROW(testing::test_renderer().load(scene), Error);
}

// ------------------------------------------------------------------------------- the device against it

// Boxes whose faces have textures of all kinds, and vertex colours.
RenderScene textured_boxes(std::uint64_t seed) {
  Random random(seed);
  RenderScene scene = testing::random_boxes(seed, 8, 5);
  for (const std::uint32_t side : {8U, 5U, 1U}) {
    std::vector<Rgba> texels;
    for (std::uint32_t i = 0; i < side * side; ++i) {
      const auto byte = [&] { return static_cast<std::uint8_t>(random.below(256)); };
      texels.push_back({byte(), byte(), byte(), byte()});
    }
    scene.textures.push_back(texture_of(side, side, texels));
  }
  scene.textures[0].sampling.wrap_u = TextureWrap::mirror;
  scene.textures[0].sampling.magnify = TextureFilter::nearest;
  scene.textures[1].sampling.levels = TextureLevelsUse::nearest;
  scene.textures[2].sampling.levels = TextureLevelsUse::none;
  scene.textures[2].sampling.minify = TextureFilter::nearest;
  scene.textures[1].sampling.wrap_v = TextureWrap::clamp;
  for (std::size_t v = 0; v < scene.positions.size(); ++v) {
    const auto number = [&](double low, double high) {
      return static_cast<float>(random.uniform(low, high));
    };
    scene.texcoords.push_back({number(-1, 2), number(-1, 2)});
    scene.colors.push_back({number(0.5, 1), number(0.5, 1), number(0.5, 1), number(0.5, 1)});
  }
  scene.surfaces[0].texture = 0;
  scene.surfaces[1].texture = 1;
  scene.surfaces[1].opaque = true;
  scene.surfaces[2].texture = 2;
  scene.surfaces[3].texture = 0;
  scene.surfaces[3].opaque = true;
  scene.surfaces[3].alpha = 1;
  scene.surfaces[3].cutoff = 0.3F;
  return scene;
}

class TexturesOnDevice : public ::testing::TestWithParam<Effect> {
 protected:
  void TearDown() override { EXPECT_EQ(testing::first_validation_message(), ""); }
};

TEST_P(TexturesOnDevice, AreThoseOfTheReference) {
  const Camera camera = look_at_sphere({{0.5, 0.5, 0.5}, 0.9}, {normalized(Vec3d{0.4, 0.5, 1}), 3}, 80, 60);
  RenderOptions options;
  options.effect = GetParam();
  options.plain_resolve = true;
  for (const std::uint64_t seed : {1U, 2U}) {
    const RenderScene scene = textured_boxes(seed);
    testing::test_renderer().load(scene);
    const RenderResult expected = draw_reference(scene, camera, options);
    // One that counts and one that peels by the depth test.
    for (const char* technique : {"sb", "f2b-3p"}) {
      options.technique = technique;
      const RenderResult drawn = testing::test_renderer().draw(camera, options);
      // At the rim of a cut-out a fragment may fall the other way.
      EXPECT_NEAR(static_cast<double>(drawn.stats.fragments), static_cast<double>(expected.stats.fragments),
                  0.005 * static_cast<double>(expected.stats.fragments));
      std::size_t far = 0;
      for (std::size_t p = 0; p < drawn.pixels.size(); ++p)
        far += testing::difference(drawn.pixels[p], expected.pixels[p]) > 0.02F ? 1U : 0U;
      EXPECT_LE(far, drawn.pixels.size() / 100) << technique;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Effects, TexturesOnDevice,
                         ::testing::Values(Effect::transparency, Effect::complexity));

// A sheet over an opaque black square, on the whole image.
RenderScene sheet_over_black(const Surface& sheet) {
  RenderScene scene =
      testing::joined(testing::coplanar_squares(1, 0.25F), testing::coplanar_squares(1, 0.5F));
  scene.surfaces[0] = sheet;
  scene.surfaces[1] = {.color = {0, 0, 0}, .alpha = 1, .opaque = true, .unlit = true};
  return scene;
}

TEST(EmissionReference, AddsToTheLightAndKeepsItsColour) {
  const auto linear = [](const Surface& sheet) {
    return draw_reference(sheet_over_black(sheet), testing::unit_camera(2, 2), {}).pixels[0];
  };
  const Vec3f unlit = linear({.color = {0.5F, 0.25F, 0}, .alpha = 1, .opaque = true, .unlit = true});
  EXPECT_LT(testing::difference(unlit, {0.5F, 0.25F, 0}), 1e-6F);
  const Vec3f dark = linear({.color = {0, 0, 0}, .alpha = 1, .opaque = true});
  const Vec3f glowing =
      linear({.color = {0, 0, 0}, .alpha = 1, .opaque = true, .emissive = {0.5F, 0.25F, 0}});
  EXPECT_LT(testing::difference(glowing, dark + Vec3f{0.5F, 0.25F, 0}), 1e-6F);
}

class EmissionOnDevice : public ::testing::TestWithParam<std::string> {};

TEST_P(EmissionOnDevice, IsThatOfTheReference) {
  const Camera camera = testing::unit_camera(4, 4);
  RenderOptions options;
  for (const bool unlit : {false, true}) {
    for (const float strength : {0.5F, 1.9F, 10.0F}) {
      for (const float alpha : {0.05F, 0.3F}) {
        const RenderScene scene = sheet_over_black({.color = {0.2F, 0.1F, 0.1F},
                                                    .alpha = alpha,
                                                    .unlit = unlit,
                                                    .emissive = {strength, strength / 2, strength / 5}});
        testing::test_renderer().load(scene);
        options.technique = GetParam();
        const RenderResult drawn = testing::test_renderer().draw(camera, options);
        const RenderResult expected = draw_reference(scene, camera, options);
        EXPECT_LT(testing::largest_difference(drawn, expected), 0.02F)
            << "strength " << strength << ", alpha " << alpha << ", unlit " << unlit;
      }
    }
  }
}

std::vector<std::string> exact_techniques() {
  return testing::techniques_that([](const TechniqueInfo& info) { return info.exact; });
}
INSTANTIATE_TEST_SUITE_P(Techniques, EmissionOnDevice, ::testing::ValuesIn(exact_techniques()),
                         testing::technique_test_name);

}  // namespace
}  // namespace pellucid
