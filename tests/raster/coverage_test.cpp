// Tests the coverage of single triangles: literal cases, the top-left rule, and the SIMD kernel against the
// scalar version and against a point-in-triangle test in exact integers.
#include "raster/coverage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>

#include "pellucid/base.h"
#include "raster/projection.h"

namespace pellucid::raster {
namespace {

using Pixel = std::pair<std::int32_t, std::int32_t>;
using Corners = std::array<FixedPoint, 3>;

constexpr std::int32_t kSide = 40;

Corners clockwise(Corners t) {
  if (twice_area(t[0], t[1], t[2]) < 0) std::swap(t[1], t[2]);
  return t;
}

// The reference applies the definition of the fill rule to one centre at a time, without boxes or steps.
bool covers_center(const Corners& t, Pixel pixel) {
  const FixedPoint p{pixel.first * kSubpixels + kSubpixels / 2, pixel.second * kSubpixels + kSubpixels / 2};
  for (std::size_t k = 0; k < 3; ++k) {
    const FixedPoint& a = t[k];
    const FixedPoint& b = t[(k + 1) % 3];
    const std::int64_t side = twice_area(a, b, p);
    const bool left = b.y < a.y;
    const bool top = b.y == a.y && b.x > a.x;
    if (side < 0 || (side == 0 && !left && !top)) return false;
  }
  return true;
}

std::set<Pixel> covered_by_definition(const Corners& t, std::int32_t side) {
  std::set<Pixel> pixels;
  for (std::int32_t y = 0; y < side; ++y) {
    for (std::int32_t x = 0; x < side; ++x) {
      if (covers_center(t, {x, y})) pixels.insert({x, y});
    }
  }
  return pixels;
}

std::set<Pixel> covered_by_rows(const Corners& t, std::int32_t side) {
  std::set<Pixel> pixels;
  const auto limit = static_cast<std::uint32_t>(side);
  const std::optional<PixelBox> box = pixel_box(t[0], t[1], t[2], limit, limit);
  if (!box) return pixels;
  const Edges<std::int64_t> edges = make_edges(t[0], t[1], t[2], *box);
  for (std::uint32_t row = 0; row < box->rows(); ++row) {
    const RowSpan span = cover_row(edges, row, box->columns());
    for (std::uint32_t i = 0; i < span.count; ++i) {
      pixels.insert({box->first_x + static_cast<std::int32_t>(span.first + i),
                     box->first_y + static_cast<std::int32_t>(row)});
    }
  }
  return pixels;
}

using SmallKernel = void (*)(std::span<const SmallTriangle>, std::span<SmallRow>);

std::set<Pixel> covered_by_kernel(SmallKernel kernel, const Corners& t, std::int32_t side) {
  std::set<Pixel> pixels;
  const auto limit = static_cast<std::uint32_t>(side);
  const std::optional<PixelBox> box = pixel_box(t[0], t[1], t[2], limit, limit);
  if (!box) return pixels;
  const Edges<std::int64_t> wide = make_edges(t[0], t[1], t[2], *box);
  SmallTriangle small{{}, box->columns(), box->rows()};
  for (std::size_t k = 0; k < 3; ++k) {
    small.edges.start[k] = static_cast<std::int32_t>(wide.start[k]);
    small.edges.step_x[k] = static_cast<std::int32_t>(wide.step_x[k]);
    small.edges.step_y[k] = static_cast<std::int32_t>(wide.step_y[k]);
  }
  std::vector<SmallRow> rows(small.rows);
  kernel({&small, 1}, rows);
  for (std::uint32_t row = 0; row < small.rows; ++row) {
    for (std::int32_t i = 0; i < rows[row].count; ++i) {
      pixels.insert({box->first_x + rows[row].first + i, box->first_y + static_cast<std::int32_t>(row)});
    }
  }
  return pixels;
}

// Returns corners on a grid of `step` subpixels around the image. With coarse steps, centres are often on
// edges.
Corners random_triangle(Random& random, std::int32_t side, std::int32_t step) {
  Corners t{};
  const auto cells = static_cast<std::uint64_t>((side + 8) * kSubpixels / step);
  for (FixedPoint& corner : t) {
    corner.x = static_cast<std::int32_t>(random.below(cells)) * step - 4 * kSubpixels;
    corner.y = static_cast<std::int32_t>(random.below(cells)) * step - 4 * kSubpixels;
  }
  return clockwise(t);
}

TEST(Coverage, SquareOfTwoTrianglesOwnsItsTopAndLeftEdges) {
  // The corners are the centres of the pixels (1, 1) and (4, 3).
  const std::int32_t left = 1 * 256 + 128, top = 1 * 256 + 128, right = 4 * 256 + 128, bottom = 3 * 256 + 128;
  const Corners upper{{{left, top}, {right, top}, {left, bottom}}};
  const Corners lower{{{right, top}, {right, bottom}, {left, bottom}}};
  const std::set<Pixel> first = covered_by_rows(upper, kSide);
  const std::set<Pixel> second = covered_by_rows(lower, kSide);
  // The diagonal through (4, 1) and (1, 3) is the left edge of the lower triangle.
  EXPECT_EQ(first, (std::set<Pixel>{{1, 1}, {2, 1}, {3, 1}, {1, 2}, {2, 2}}));
  EXPECT_EQ(second, (std::set<Pixel>{{3, 2}}));
}

TEST(Coverage, CoversACentreOnTheUpperLeftCornerOnly) {
  const Corners t = clockwise({{{128, 128}, {640, 128}, {128, 640}}});
  EXPECT_TRUE(covers_center(t, {0, 0}));
  EXPECT_TRUE(covered_by_rows(t, kSide).contains({0, 0}));
  EXPECT_FALSE(covered_by_rows(t, kSide).contains({2, 0}));
  EXPECT_FALSE(covered_by_rows(t, kSide).contains({0, 2}));
}

TEST(Coverage, ThinTriangleBetweenCentersCoversNothing) {
  const Corners t = clockwise({{{130, 0}, {380, 0}, {250, 5000}}});
  EXPECT_TRUE(covered_by_rows(t, kSide).empty());
  EXPECT_FALSE(pixel_box({130, 0}, {380, 0}, {250, 5000}, kSide, kSide).has_value());
}

TEST(Coverage, MatchesTheDefinitionOnRandomTriangles) {
  Random random(7);
  std::size_t covered = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::int32_t step = i % 3 == 0 ? 128 : (i % 3 == 1 ? 32 : 1);
    const Corners t = random_triangle(random, kSide, step);
    if (twice_area(t[0], t[1], t[2]) == 0) continue;
    const std::set<Pixel> expected = covered_by_definition(t, kSide);
    ASSERT_EQ(covered_by_rows(t, kSide), expected) << i;
    ASSERT_EQ(covered_by_kernel(cover_small_scalar, t, kSide), expected) << i;
    ASSERT_EQ(covered_by_kernel(cover_small, t, kSide), expected) << i;
    covered += expected.size();
  }
  EXPECT_GT(covered, 100000U);
}

TEST(Coverage, IsExactForTheLargestSmallTriangles) {
  // Extents just below the limit, anywhere on the subpixel grid, have at most 64 columns and rows, and 32
  // bits suffice.
  Random random(8);
  for (int i = 0; i < 300; ++i) {
    const auto x = static_cast<std::int32_t>(random.below(2 * kSubpixels));
    const auto y = static_cast<std::int32_t>(random.below(2 * kSubpixels));
    constexpr std::int32_t kExtent = kSmallExtent * kSubpixels - 1;
    const auto at = [&](std::int32_t limit) {
      return static_cast<std::int32_t>(random.below(static_cast<std::uint64_t>(limit) + 1));
    };
    const Corners t =
        clockwise({{{x, y + at(kExtent)}, {x + kExtent, y + at(kExtent)}, {x + at(kExtent), y + kExtent}}});
    const std::set<Pixel> expected = covered_by_definition(t, 70);
    ASSERT_EQ(covered_by_kernel(cover_small, t, 70), expected) << i;
    ASSERT_EQ(covered_by_kernel(cover_small_scalar, t, 70), expected) << i;
  }
}

TEST(Coverage, KernelEqualsTheScalarVersionOnBatches) {
  Random random(9);
  std::vector<SmallTriangle> triangles;
  std::size_t row_count = 0;
  for (int i = 0; i < 2000; ++i) {
    SmallTriangle small{{},
                        1 + static_cast<std::uint32_t>(random.below(64)),
                        1 + static_cast<std::uint32_t>(random.below(64))};
    const Corners t = random_triangle(random, kSmallExtent, 1);
    const PixelBox box{0, 0, static_cast<std::int32_t>(small.columns) - 1,
                       static_cast<std::int32_t>(small.rows) - 1};
    const Edges<std::int64_t> wide = make_edges(t[0], t[1], t[2], box);
    for (std::size_t k = 0; k < 3; ++k) {
      small.edges.start[k] = static_cast<std::int32_t>(wide.start[k]);
      small.edges.step_x[k] = static_cast<std::int32_t>(wide.step_x[k]);
      small.edges.step_y[k] = static_cast<std::int32_t>(wide.step_y[k]);
    }
    row_count += small.rows;
    triangles.push_back(small);
  }
  std::vector<SmallRow> fast(row_count), slow(row_count);
  cover_small(triangles, fast);
  cover_small_scalar(triangles, slow);
  for (std::size_t i = 0; i < row_count; ++i) {
    ASSERT_EQ(fast[i].count, slow[i].count) << i;
    ASSERT_EQ(fast[i].first, slow[i].first) << i;
  }
}

TEST(Coverage, HugeTrianglesDoNotOverflow) {
  // The corners are as far out as the guard band allows. The image is in the middle.
  constexpr std::int32_t kFar = (1 << 20) * kSubpixels;
  const Corners everything = clockwise({{{-kFar, -kFar}, {2 * kFar, -kFar}, {-kFar, 2 * kFar}}});
  EXPECT_EQ(covered_by_rows(everything, kSide).size(), static_cast<std::size_t>(kSide * kSide));
  // The diagonal x + y = 20 pixels runs exactly through the image.
  const Corners half =
      clockwise({{{-kFar, kFar + 20 * kSubpixels}, {kFar + 20 * kSubpixels, -kFar}, {-kFar, -kFar}}});
  for (const Pixel& p : covered_by_rows(half, kSide)) EXPECT_LT(p.first + p.second + 1, 20);
  EXPECT_EQ(covered_by_rows(half, kSide), covered_by_definition(half, kSide));
}

}  // namespace
}  // namespace pellucid::raster
