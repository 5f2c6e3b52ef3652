// Tests the images of a frame: blending computed by hand, missing nodes, error images.
#include <gtest/gtest.h>

#include "metric_helpers.h"

namespace pellucid {
namespace {

using testing::fragments_of;
using testing::front_camera;
using testing::two_quads;

std::array<int, 3> pixel_of(const Image& image, std::uint32_t x, std::uint32_t y) {
  const std::size_t p = 3 * (std::size_t{y} * image.width + x);
  return {image.rgb[p], image.rgb[p + 1], image.rgb[p + 2]};
}

int encoded(double linear) {
  return static_cast<int>(std::lround(255 * srgb_from_linear(linear)));
}

TEST(Shading, SrgbCurveAndItsInverse) {
  EXPECT_DOUBLE_EQ(srgb_from_linear(0), 0);
  EXPECT_NEAR(srgb_from_linear(1), 1, 1e-12);
  EXPECT_NEAR(srgb_from_linear(0.214041), 0.5, 1e-5);  // IEC 61966-2-1
  for (double v = 0; v <= 1; v += 0.01) {
    EXPECT_NEAR(srgb_from_linear(linear_from_srgb(v)), v, 1e-6);
  }
}

TEST(Shading, OpaqueFrontHidesWhatLiesBehind) {
  const Mesh mesh = two_quads();
  const Camera camera = front_camera(32);
  const FragmentBuffer fragments = fragments_of(mesh, camera);
  ShadingOptions options;
  options.shading = Shading::depth;
  options.alpha = 1;
  Mesh only_front = mesh;
  only_front.triangles.erase(only_front.triangles.begin(), only_front.triangles.begin() + 2);
  const Image both = shade_exact(mesh, camera, fragments, options);
  const Image one = shade_exact(only_front, camera, fragments_of(only_front, camera), options);
  EXPECT_EQ(pixel_of(both, 16, 16), pixel_of(one, 16, 16));
  EXPECT_NE(pixel_of(both, 9, 9), pixel_of(one, 9, 9));
  EXPECT_EQ(pixel_of(both, 0, 0), (std::array<int, 3>{255, 255, 255}));
}

TEST(Shading, BlendsOverInLinearSpace) {
  // No colour of its own and flat towards the eye: each layer leaves (1 - alpha) of the background.
  Mesh mesh = two_quads();
  mesh.normals.assign(mesh.positions.size(), {0, 0, 1});
  const Camera camera = front_camera(32);
  ShadingOptions options;
  options.alpha = 0.5;
  options.color = {0, 0, 0};
  options.background = {0.8F, 0.8F, 0.8F};
  const FragmentBuffer fragments = fragments_of(mesh, camera);
  const Image image = shade_exact(mesh, camera, fragments, options);
  const auto dark = [&](double transmittance, int actual) {
    // The highlight of the fill light adds a little.
    EXPECT_GE(actual, encoded(0.8 * transmittance));
    EXPECT_LE(actual, encoded(0.8 * transmittance + 0.01));
  };
  dark(0.25, pixel_of(image, 16, 16)[0]);
  dark(0.5, pixel_of(image, 9, 9)[0]);
  EXPECT_EQ(pixel_of(image, 1, 1)[0], encoded(static_cast<double>(0.8F)));
}

TEST(Shading, BothSidesOfASheetLookAlike) {
  // Normals are flipped to the side that is seen, so a sheet seen from behind is lit as one turned round.
  Mesh mesh = two_quads();
  mesh.normals.assign(mesh.positions.size(), {0, 0, 1});
  const Camera camera = front_camera(24);
  Mesh turned = mesh;
  for (Triangle& t : turned.triangles) std::swap(t[1], t[2]);
  for (Vec3f& normal : turned.normals) normal = -normal;
  EXPECT_EQ(shade_exact(mesh, camera, fragments_of(mesh, camera), {}).rgb,
            shade_exact(turned, camera, fragments_of(turned, camera), {}).rgb);
}

TEST(Shading, ExactOrderDrawsTheExactImage) {
  const Mesh mesh = testing::two_quads();
  const Camera camera = front_camera(32);
  const FragmentBuffer fragments = fragments_of(mesh, camera);
  for (const Shading shading : {Shading::lit, Shading::depth}) {
    ShadingOptions options;
    options.shading = shading;
    const Image exact = shade_exact(mesh, camera, fragments, options);
    const std::vector<std::uint32_t> right = ranks_of(NodeSequence{4, 6, 0, 2}, 4);
    const std::vector<std::uint32_t> missing = ranks_of(NodeSequence{0, 2}, 4);
    EXPECT_EQ(shade_ordered(mesh, camera, fragments, right, options).rgb, exact.rgb);
    // Without the small square: as if it were not there.
    Mesh large = mesh;
    large.triangles.resize(2);
    EXPECT_EQ(shade_ordered(mesh, camera, fragments, missing, options).rgb,
              shade_exact(large, camera, fragments_of(large, camera), options).rgb);
  }
}

TEST(ErrorImage, RedExactlyWhereTheOrderIsWrong) {
  const Mesh mesh = two_quads();
  const FragmentBuffer fragments = fragments_of(mesh, front_camera(64));
  const std::vector<std::uint32_t> wrong = ranks_of(NodeSequence{0, 2, 4, 6}, 4);
  const Image image = error_image(fragments, wrong);
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = 0; x < 64; ++x) {
      const auto [r, g, b] = pixel_of(image, x, y);
      const std::size_t layers = fragments.pixel(std::size_t{y} * 64 + x).size();
      ASSERT_EQ(r > g + 100, layers == 2) << x << "," << y;
      ASSERT_EQ(r == 255 && g == 255 && b == 255, layers == 0) << x << "," << y;
    }
  }
}

}  // namespace
}  // namespace pellucid
