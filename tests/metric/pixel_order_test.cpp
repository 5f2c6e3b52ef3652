// Tests which pixels are drawn in the right order and which are not.
#include <gtest/gtest.h>

#include "order_helpers.h"
#include "pellucid/shading.h"

namespace pellucid {
namespace {

using Ranks = std::vector<std::uint32_t>;

bool in_order(const std::vector<Fragment>& fragments, const Ranks& ranks) {
  return pixel_in_order(fragments, ranks);
}

TEST(PixelInOrder, LiteralCases) {
  const Ranks ranks{0, 1, 2, kNoRank};
  EXPECT_TRUE(in_order({}, ranks));
  EXPECT_TRUE(in_order({{0.5F, 1}}, ranks));
  EXPECT_TRUE(in_order({{0.1F, 0}, {0.2F, 1}, {0.3F, 2}}, ranks));
  EXPECT_FALSE(in_order({{0.1F, 1}, {0.2F, 0}}, ranks));
  EXPECT_FALSE(in_order({{0.1F, 0}, {0.2F, 2}, {0.3F, 1}}, ranks));
  // Not neighbours, but wrong all the same.
  EXPECT_FALSE(in_order({{0.1F, 1}, {0.2F, 2}, {0.3F, 0}}, ranks));
  // A node that the order does not contain is not drawn.
  EXPECT_FALSE(in_order({{0.1F, 0}, {0.2F, 3}}, ranks));
  EXPECT_FALSE(in_order({{0.1F, 3}}, ranks));
}

TEST(PixelInOrder, TiesMayComeInEitherOrder) {
  const Ranks ranks{0, 1, 2};
  const float tie = 0.5F + 0.9F * kDepthTie;
  EXPECT_TRUE(in_order({{0.5F, 1}, {tie, 0}}, ranks));
  EXPECT_TRUE(in_order({{0.5F, 0}, {tie, 1}}, ranks));
  EXPECT_FALSE(in_order({{0.5F, 1}, {0.5F + 3 * kDepthTie, 0}}, ranks));
  // A tie behind one that is in front, and the other way round.
  EXPECT_TRUE(in_order({{0.4F, 0}, {0.5F, 2}, {tie, 1}}, ranks));
  EXPECT_FALSE(in_order({{0.4F, 1}, {0.5F, 2}, {tie, 0}}, ranks));
  EXPECT_FALSE(in_order({{0.5F, 2}, {tie, 0}, {0.6F, 1}}, ranks));
}

TEST(PixelInOrder, IsThePairwiseRule) {
  // Wrong: a node without rank, or two fragments more than a tie apart in the wrong order.
  Random random(2);
  int right = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::vector<Fragment> fragments;
    for (std::uint64_t i = random.below(6); i > 0; --i) {
      fragments.push_back({static_cast<float>(0.25 + 0.4e-6 * static_cast<double>(random.below(12))),
                           static_cast<NodeId>(random.below(6))});
    }
    std::sort(fragments.begin(), fragments.end(), [](const Fragment& a, const Fragment& b) {
      return a.depth != b.depth ? a.depth < b.depth : a.node < b.node;
    });
    const Ranks ranks{0, 2, 1, 4, 3, kNoRank};
    bool expected = true;
    for (std::size_t j = 0; j < fragments.size(); ++j) {
      if (ranks[fragments[j].node] == kNoRank) expected = false;
      for (std::size_t i = 0; i < j; ++i) {
        if (fragments[j].depth - fragments[i].depth > kDepthTie &&
            ranks[fragments[i].node] > ranks[fragments[j].node]) {
          expected = false;
        }
      }
    }
    ASSERT_EQ(in_order(fragments, ranks), expected) << trial;
    right += expected ? 1 : 0;
  }
  EXPECT_GT(right, 2000);
  EXPECT_LT(right, 18000);
}

// What is verified is in order; what is in order and has no two fragments near each other is verified.
TEST(PixelIsVerified, AsksForAscendingDepthsAndRanks) {
  const Ranks ranks{0, 1, 2, kNoRank};
  const auto verified = [&](const std::vector<Fragment>& fragments) {
    const bool is = pixel_is_verified(fragments, ranks);
    EXPECT_TRUE(!is || pixel_in_order(fragments, ranks));
    return is;
  };
  EXPECT_TRUE(verified({}));
  EXPECT_TRUE(verified({{0.4F, 2}}));
  EXPECT_FALSE(verified({{0.4F, 3}}));
  EXPECT_TRUE(verified({{0.4F, 0}, {0.5F, 1}, {0.6F, 2}}));
  EXPECT_FALSE(verified({{0.4F, 0}, {0.5F, 2}, {0.6F, 1}}));
  EXPECT_FALSE(verified({{0.4F, 0}, {0.4F, 1}}));  // coplanar
  const float next = std::nextafter(0.4F, 1.0F);
  EXPECT_TRUE(verified({{0.4F, 0}, {next, 1}}));
  EXPECT_FALSE(verified({{0.4F, 1}, {next, 0}}));
}

TEST(CountIncorrectPixels, CountsForegroundOnly) {
  FragmentBuffer buffer;
  buffer.width = 4;
  buffer.height = 1;
  buffer.offsets = {0, 0, 2, 4, 5};
  buffer.fragments = {{0.1F, 0}, {0.2F, 1}, {0.1F, 1}, {0.2F, 0}, {0.5F, 1}};
  const PixelCount count = count_incorrect_pixels(buffer, Ranks{0, 1});
  EXPECT_EQ(count.foreground, 3U);
  EXPECT_EQ(count.incorrect, 1U);
  EXPECT_EQ(count.repaired, 1U);
}

}  // namespace
}  // namespace pellucid
