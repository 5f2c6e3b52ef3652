// Tests overdraw against a z-buffer that draws the triangles one after the other.
#include <gtest/gtest.h>

#include <limits>

#include "metric_helpers.h"

namespace pellucid {
namespace {

using testing::random_soup;

// Every triangle is rasterised alone, in draw order, against a depth buffer.
OverdrawStatistics draw_with_depth_buffer(const Mesh& mesh, std::span<const Viewpoint> viewpoints,
                                          std::uint32_t size, std::span<const NodeId> sequence) {
  OverdrawStatistics total;
  const BoundingSphere sphere = bounding_sphere(mesh);
  for (const Viewpoint& viewpoint : viewpoints) {
    std::vector<float> nearest(std::size_t{size} * size, std::numeric_limits<float>::infinity());
    for (const NodeId node : sequence) {
      if (is_flipped(node)) continue;
      Mesh one;
      one.positions = mesh.positions;
      one.triangles = {mesh.triangles[triangle_of(node)]};
      FragmentBuffer buffer;
      rasterize(one, look_at_sphere(sphere, viewpoint, size, size), {Culling::back}, buffer);
      for (std::size_t p = 0; p < nearest.size(); ++p) {
        for (const Fragment& f : buffer.pixel(p)) {
          if (!(f.depth < nearest[p])) continue;
          total.covered += nearest[p] == std::numeric_limits<float>::infinity() ? 1U : 0U;
          nearest[p] = f.depth;
          ++total.shaded;
        }
      }
    }
  }
  total.overdraw = static_cast<double>(total.shaded) / static_cast<double>(total.covered);
  return total;
}

TEST(Overdraw, TwoQuadsByHand) {
  const Mesh mesh = testing::two_quads();
  const std::vector<Viewpoint> front{{{0, 0, 1}, kInfiniteDistance}};
  const NodeSequence far_first{0, 2, 4, 6};
  const NodeSequence near_first{4, 6, 0, 2};
  const auto measure = [&](const NodeSequence& sequence) {
    return measure_overdraw(mesh, front, 200,
                            [&](const Viewpoint&) { return std::span<const NodeId>(sequence); });
  };
  const OverdrawStatistics good = measure(near_first);
  const OverdrawStatistics bad = measure(far_first);
  EXPECT_EQ(good.shaded, good.covered);
  EXPECT_DOUBLE_EQ(good.overdraw, 1.0);
  EXPECT_EQ(bad.covered, good.covered);
  // The small square is a quarter of the large one.
  EXPECT_NEAR(bad.overdraw, 1.25, 0.02);
}

TEST(Overdraw, EqualsADepthBuffer) {
  Mesh mesh = random_soup(250, 0.3, 5, 0.5);
  // Exact duplicates: equal depths must fail a strict test.
  for (std::size_t i = 0; i < 10; ++i) mesh.triangles.push_back(mesh.triangles[i]);
  const std::vector<Viewpoint> viewpoints = random_viewpoints(3, 2, 5, 9);
  NodeSequence sequence = testing::file_order(mesh);
  Random random(4);
  for (std::size_t i = sequence.size(); i > 1; --i) std::swap(sequence[i - 1], sequence[random.below(i)]);
  sequence.resize(sequence.size() - 20);  // some are not drawn at all
  const OverdrawStatistics expected = draw_with_depth_buffer(mesh, viewpoints, 64, sequence);
  const OverdrawStatistics actual = measure_overdraw(
      mesh, viewpoints, 64, [&](const Viewpoint&) { return std::span<const NodeId>(sequence); });
  EXPECT_EQ(actual.covered, expected.covered);
  EXPECT_EQ(actual.shaded, expected.shaded);
  EXPECT_DOUBLE_EQ(actual.overdraw, expected.overdraw);
  EXPECT_GT(actual.overdraw, 1.1);
}

TEST(Overdraw, NothingCovered) {
  const OverdrawStatistics none =
      measure_overdraw(testing::two_quads(), random_viewpoints(2, 2, 5, 1), 16,
                       [](const Viewpoint&) { return std::span<const NodeId>(); });
  EXPECT_EQ(none.covered, 0U);
  EXPECT_DOUBLE_EQ(none.overdraw, 0.0);
}

}  // namespace
}  // namespace pellucid
