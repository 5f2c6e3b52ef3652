// Tests IPR and PSNR: scenes with known answers, exact and reversed orders, determinism, interruption.
#include <gtest/gtest.h>

#include <atomic>

#include "metric_helpers.h"
#include "pellucid/baseline.h"

namespace pellucid {
namespace {

using testing::fragments_of;
using testing::front_camera;
using testing::random_soup;
using testing::two_quads;

MeasureOptions small_measure() {
  MeasureOptions options;
  options.viewpoints = 12;
  options.size = 96;
  return options;
}

// Far apart along x, never overlapping in depth: sorting the centroids is exact from everywhere.
Mesh far_apart() {
  Mesh mesh;
  for (std::uint32_t i = 0; i < 8; ++i) {
    const auto x = static_cast<float>(i) - 3.5F;
    mesh.positions.insert(mesh.positions.end(), {{x, -0.1F, -0.1F}, {x, 0.1F, -0.1F}, {x, 0.0F, 0.1F}});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

TEST(FrameErrorOf, CountsTheWrongPixelsOfTwoQuads) {
  const Mesh mesh = two_quads();
  const Camera camera = front_camera(64);
  const FragmentBuffer fragments = fragments_of(mesh, camera);
  const auto error_of = [&](const NodeSequence& sequence) {
    return frame_error(mesh, camera, fragments, ranks_of(sequence, 4), {});
  };
  // 64 pixels for two units: the squares are 32 and 16 pixels wide.
  const FrameError right = error_of({4, 6, 0, 2});
  EXPECT_EQ(right.foreground, 32U * 32U);
  EXPECT_EQ(right.incorrect, 0U);
  EXPECT_EQ(right.squared_error, 0.0);
  EXPECT_EQ(error_of({0, 2, 4, 6}).incorrect, 16U * 16U);
  EXPECT_DOUBLE_EQ(error_of({0, 2, 4, 6}).ipr(), 0.25);
  // A missing node is wrong wherever it would be seen: half of the large square, diagonal to one side.
  const FrameError missing = error_of({4, 6, 0});
  EXPECT_NEAR(static_cast<double>(missing.incorrect), 512, 17);
  EXPECT_GT(missing.squared_error, 0.0);
}

TEST(FrameErrorOf, SquaredErrorIsThatOfTheImages) {
  const Mesh mesh = random_soup(80, 0.4, 8, 0.5);
  const Camera camera = look_at_sphere(bounding_sphere(mesh), {{0, 0, 1}, 3}, 80, 80);
  const FragmentBuffer fragments = fragments_of(mesh, camera);
  std::vector<std::uint32_t> ranks = ranks_of(testing::file_order(mesh), mesh.triangles.size());
  for (const Shading shading : {Shading::lit, Shading::depth}) {
    ShadingOptions options;
    options.shading = shading;
    const Image exact = shade_exact(mesh, camera, fragments, options);
    const Image drawn = shade_ordered(mesh, camera, fragments, ranks, options);
    double expected = 0;
    for (std::size_t i = 0; i < exact.rgb.size(); ++i) {
      const double d = (exact.rgb[i] - drawn.rgb[i]) / 255.0;
      expected += d * d;
    }
    const double actual = frame_error(mesh, camera, fragments, ranks, options).squared_error;
    // The images are rounded to 8 bits.
    EXPECT_NEAR(actual, expected, 0.03 * expected);
    EXPECT_GT(actual, 1.0);
  }
}

TEST(OrderQuality, ExactOrderHasNoErrorAndReversedOrderMuch) {
  const Mesh mesh = far_apart();
  const BoundingSphere sphere = bounding_sphere(mesh);
  const std::vector<DrawingMethod> methods{
      {"exact",
       [&](const Viewpoint& v) { return ranks_of(centroid_sorted(mesh, sphere, v), mesh.triangles.size()); }},
      {"reversed", [&](const Viewpoint& v) {
         NodeSequence nodes = centroid_sorted(mesh, sphere, v);
         std::reverse(nodes.begin(), nodes.end());
         return ranks_of(nodes, mesh.triangles.size());
       }}};
  MeasureOptions options = small_measure();
  options.viewpoints = 60;
  options.size = 200;
  options.shading.shading = Shading::depth;  // parallel triangles are lit alike
  const std::vector<MethodQuality> result = measure_order_quality(mesh, methods, options);
  ASSERT_EQ(result.size(), 2U);
  EXPECT_EQ(result[0].name, "exact");
  EXPECT_EQ(result[0].ipr_mean, 0.0);
  EXPECT_EQ(result[0].psnr_mean, 100.0);
  EXPECT_EQ(result[0].psnr_min, 100.0);
  EXPECT_GT(result[1].ipr_max, 0.1);
  EXPECT_LT(result[1].psnr_min, 40.0);
  EXPECT_LE(result[1].ipr_mean, result[1].ipr_max);
  EXPECT_LE(result[1].psnr_min, result[1].psnr_mean);
}

TEST(OrderQuality, MeansAndBinsFollowFromTheFrames) {
  const Mesh mesh = random_soup(100, 0.4, 2, 0.5);
  std::vector<std::uint32_t> ranks = ranks_of(testing::file_order(mesh), mesh.triangles.size());
  MeasureOptions options = small_measure();
  options.viewpoints = 40;
  const std::vector<DrawingMethod> methods{{"file", [&](const Viewpoint&) { return ranks; }}};
  const MethodQuality quality = measure_order_quality(mesh, methods, options)[0];
  const std::vector<Viewpoint> viewpoints = random_viewpoints(40, 2, 5, options.seed);
  ASSERT_EQ(quality.frames.size(), 40U);
  double ipr = 0, psnr = 0, first_bin = 0, first_count = 0;
  for (std::size_t i = 0; i < 40; ++i) {
    const FrameError& f = quality.frames[i];
    const double mse = f.squared_error / (3.0 * static_cast<double>(f.foreground));
    ipr += f.ipr() / 40;
    psnr += -10 * std::log10(mse) / 40;
    if (viewpoints[i].distance >= 2.5) continue;
    first_bin += f.ipr();
    ++first_count;
  }
  EXPECT_NEAR(quality.ipr_mean, ipr, 1e-12);
  EXPECT_NEAR(quality.psnr_mean, psnr, 1e-9);
  ASSERT_FALSE(quality.by_distance.empty());
  EXPECT_LE(quality.by_distance.size(), 6U);
  EXPECT_DOUBLE_EQ(quality.by_distance[0].distance, 2.5);
  EXPECT_NEAR(quality.by_distance[0].ipr, first_bin / first_count, 1e-12);
  EXPECT_DOUBLE_EQ(quality.by_distance.back().distance, 5.0);
}

TEST(OrderQuality, PsnrOfAKnownDifference) {
  // One white-on-black half step: two quads where only the wrong square differs, by a known colour
  // difference.
  const Mesh mesh = two_quads();
  const Camera camera = front_camera(64);
  const FragmentBuffer fragments = fragments_of(mesh, camera);
  ShadingOptions options;
  options.shading = Shading::depth;
  const std::vector<std::uint32_t> wrong = ranks_of(NodeSequence{0, 2, 4, 6}, 4);
  const FragmentShader shader(mesh, camera, options);
  const std::size_t middle = 32 * 64 + 32;
  const std::span<const Fragment> list = fragments.pixel(middle);
  std::vector<ShadedFragment> shaded;
  shader.shade(middle, list, shaded);
  const Vec3d right = shader.blend(shaded);
  std::swap(shaded[0], shaded[1]);
  const Vec3d difference = right - shader.blend(shaded);
  EXPECT_NEAR(frame_error(mesh, camera, fragments, wrong, options).squared_error,
              256 * dot(difference, difference), 1e-9);
}

TEST(OrderQuality, SingleFacingIgnoresBackFaces) {
  const Mesh mesh = random_soup(60, 0.4, 12, 0.5);
  // Ranks for front facings only: with both facings drawn, back faces would be missing.
  const BoundingSphere sphere = bounding_sphere(mesh);
  const std::vector<DrawingMethod> fronts{{"fronts", [&](const Viewpoint& v) {
                                             NodeSequence nodes = centroid_sorted(mesh, sphere, v);
                                             std::erase_if(nodes,
                                                           [](NodeId node) { return is_flipped(node); });
                                             return ranks_of(nodes, mesh.triangles.size());
                                           }}};
  MeasureOptions options = small_measure();
  const double both = measure_order_quality(mesh, fronts, options)[0].ipr_mean;
  options.facing = Facing::single;
  const double single = measure_order_quality(mesh, fronts, options)[0].ipr_mean;
  EXPECT_LT(single, 0.5 * both);
}

TEST(OrderQuality, SameNumbersForAnyNumberOfThreads) {
  const Mesh mesh = random_soup(200, 0.3, 6, 0.5);
  std::vector<std::uint32_t> ranks = ranks_of(testing::file_order(mesh), mesh.triangles.size());
  const std::vector<DrawingMethod> methods{{"file", [&](const Viewpoint&) { return ranks; }}};
  const auto measure = [&](unsigned threads) {
    const ThreadLimit limit(threads);
    return measure_order_quality(mesh, methods, small_measure())[0];
  };
  const MethodQuality one = measure(1);
  for (const unsigned threads : {2U, 7U}) {
    const MethodQuality many = measure(threads);
    EXPECT_EQ(one.ipr_mean, many.ipr_mean);
    EXPECT_EQ(one.psnr_mean, many.psnr_mean);
    for (std::size_t i = 0; i < one.frames.size(); ++i) {
      EXPECT_EQ(one.frames[i].incorrect, many.frames[i].incorrect);
      EXPECT_EQ(one.frames[i].squared_error, many.frames[i].squared_error);
    }
  }
}

class StopAfter : public Progress {
 public:
  explicit StopAfter(std::uint64_t frames) : frames_(frames) {}
  void begin(std::string_view, std::uint64_t total) override { total_ = total; }
  void advance(std::uint64_t amount) override { done_ += amount; }
  [[nodiscard]] bool stop_requested() const override { return done_ >= frames_; }
  [[nodiscard]] std::uint64_t done() const { return done_; }
  [[nodiscard]] std::uint64_t total() const { return total_; }

 private:
  std::uint64_t frames_, total_ = 0;
  std::atomic<std::uint64_t> done_{0};
};

TEST(OrderQuality, TellsItsProgressAndStopsWhenAsked) {
  const Mesh mesh = two_quads();
  std::vector<std::uint32_t> ranks = ranks_of(testing::file_order(mesh), 4);
  const std::vector<DrawingMethod> methods{{"file", [&](const Viewpoint&) { return ranks; }}};
  MeasureOptions options = small_measure();
  StopAfter never(1000);
  options.progress = &never;
  measure_order_quality(mesh, methods, options);
  EXPECT_EQ(never.total(), 12U);
  EXPECT_EQ(never.done(), 12U);

  StopAfter soon(3);
  options.progress = &soon;
  options.viewpoints = 500;
  try {
    measure_order_quality(mesh, methods, options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::interrupted);
  }
  EXPECT_LT(soon.done(), 500U);
}

TEST(OrderQuality, NoViewpointsAndEmptyMeshes) {
  MeasureOptions options = small_measure();
  const std::vector<DrawingMethod> methods{
      {"none", [](const Viewpoint&) { return std::vector<std::uint32_t>(); }}};
  const MethodQuality empty = measure_order_quality({}, methods, options)[0];
  EXPECT_EQ(empty.ipr_mean, 0.0);
  EXPECT_EQ(empty.psnr_min, 100.0);
  options.viewpoints = 0;
  EXPECT_TRUE(measure_order_quality(two_quads(), methods, options)[0].frames.empty());
}

}  // namespace
}  // namespace pellucid
