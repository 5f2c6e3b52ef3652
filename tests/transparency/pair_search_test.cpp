// Tests the broad phase against a test of all pairs of bounds.
#include <gtest/gtest.h>

#include <algorithm>

#include "order_helpers.h"
#include "transparency/graph/screen_pairs.h"

namespace pellucid {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

std::vector<Pair> brute_force(const std::vector<Bounds2>& bounds) {
  std::vector<Pair> pairs;
  for (std::uint32_t a = 0; a < bounds.size(); ++a) {
    for (std::uint32_t b = a + 1; b < bounds.size(); ++b) {
      const Bounds2& p = bounds[a];
      const Bounds2& q = bounds[b];
      if (p.min_x < q.max_x && q.min_x < p.max_x && p.min_y < q.max_y && q.min_y < p.max_y)
        pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

// Sorted, so that a pair reported twice stands twice.
std::vector<Pair> search(PairSearch& grid, const std::vector<Bounds2>& bounds) {
  std::vector<CandidatePair> found{{7, 7}};  // must be replaced
  grid.find(bounds, found);
  std::vector<Pair> pairs;
  pairs.reserve(found.size());
  for (const CandidatePair& p : found) pairs.emplace_back(std::min(p.a, p.b), std::max(p.a, p.b));
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

Bounds2 random_box(Random& random, double extent, double size) {
  const double x = random.uniform(-extent, extent);
  const double y = random.uniform(-extent, extent);
  const double w = random.uniform(0.01, 1.0) * size;
  const double h = random.uniform(0.01, 1.0) * size;
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(x + w), static_cast<float>(y + h)};
}

TEST(PairSearch, FindsWhatTestingAllPairsFinds) {
  Random random(1);
  PairSearch grid;  // one for all: its memory must not remember
  std::size_t total = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Bounds2> bounds;
    const std::uint64_t count = random.below(150);
    const double size = std::pow(10.0, random.uniform(-3.0, 0.5));
    for (std::uint64_t i = 0; i < count; ++i) bounds.push_back(random_box(random, 1, size));
    const std::vector<Pair> expected = brute_force(bounds);
    total += expected.size();
    ASSERT_EQ(search(grid, bounds), expected) << "trial " << trial;
  }
  EXPECT_GT(total, 10000U);
}

TEST(PairSearch, OneHugeBoxAmongTinyOnes) {
  Random random(2);
  std::vector<Bounds2> bounds;
  bounds.reserve(3001);
  for (int i = 0; i < 3000; ++i) bounds.push_back(random_box(random, 1, 0.002));
  bounds.push_back({-1, -1, 1.1F, 1.1F});
  PairSearch grid;
  EXPECT_EQ(search(grid, bounds), brute_force(bounds));
}

TEST(PairSearch, IdenticalTouchingOneAndNone) {
  PairSearch grid;
  EXPECT_TRUE(search(grid, {}).empty());
  EXPECT_TRUE(search(grid, {{0, 0, 1, 1}}).empty());
  const std::vector<Bounds2> same(50, Bounds2{0.25F, 0.25F, 0.5F, 0.5F});
  EXPECT_EQ(search(grid, same).size(), 50U * 49U / 2U);
  // Boxes that only touch do not overlap.
  EXPECT_TRUE(search(grid, {{0, 0, 1, 1}, {1, 0, 2, 1}, {0, 1, 1, 2}}).empty());
}

TEST(PairSearch, ATileFloorAlignedWithTheGrid) {
  std::vector<Bounds2> bounds;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      const auto fx = static_cast<float>(x) * 0.125F;
      const auto fy = static_cast<float>(y) * 0.125F;
      bounds.push_back({fx, fy, fx + 0.25F, fy + 0.25F});
    }
  }
  PairSearch grid;
  EXPECT_EQ(search(grid, bounds), brute_force(bounds));
}

}  // namespace
}  // namespace pellucid
