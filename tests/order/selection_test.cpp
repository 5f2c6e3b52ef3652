// What a renderer does with an order set: selection, pixels in order, index buffers.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "order_helpers.h"
#include "pellucid/runtime/select.h"

namespace pellucid {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
using Ranks = std::vector<std::uint32_t>;

bool in_order(const std::vector<Fragment>& fragments, const Ranks& ranks) {
  return pixel_in_order(fragments, ranks);
}

TEST(SelectOrder, IsTheOrderOfTheCellFoundByBruteForce) {
  Random random(1);
  for (const char* text : {"S0,0", "S1,1", "S2,2", "S3,0", "P0", "P2"}) {
    OrderSet set;
    set.partition = parse_partition(text);
    const ViewPartition partition = make_partition(set.partition);
    for (std::uint32_t c = 0; c < partition.cell_count(); ++c) set.cell_orders.push_back(1000 + c);
    for (int i = 0; i < 500; ++i) {
      const Vec3d direction = random.direction();
      EXPECT_EQ(select_order(set, direction), 1000 + find_cell_brute_force(partition, direction)) << text;
    }
  }
}

TEST(SelectOrder, OfAnAnimationIsThatOfTheSelectorOfRenderers) {
  constexpr double kIdentity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  Random random(3);
  for (const char* text : {"S0,0", "S1,1", "P1"}) {
    OrderSet set;
    set.partition = parse_partition(text);
    const ViewPartition partition = make_partition(set.partition);
    KeyFrameTable table;
    table.times = {0, 0.5, 0.75, 3};
    std::vector<float> times, spheres;
    std::vector<std::uint32_t> stored;
    for (std::size_t k = 0; k < table.times.size(); ++k) {
      const Vec3f center = to_float(random.direction() * 5);
      table.spheres.push_back({to_double(center), 1});
      times.push_back(static_cast<float>(table.times[k]));
      spheres.insert(spheres.end(), {center.x, center.y, center.z, 1});
      const auto first = static_cast<std::uint32_t>(table.cell_orders.size());
      for (std::uint32_t c = 0; c < partition.cell_count(); ++c) table.cell_orders.push_back(first + c);
      const bool corners = !has_triangle_cells(set.partition);
      const std::size_t entries = corners ? partition.corner_cells.size() : partition.cell_count();
      for (std::uint32_t c = 0; c < entries; ++c) {
        stored.push_back(first + (corners ? partition.corner_cells[c] : c));
      }
    }
    set.animations = {{}, table};

    PellucidOrders orders{};
    orders.cells = has_triangle_cells(set.partition) ? pellucid_cells_triangles : pellucid_cells_corners;
    orders.level = set.partition.level;
    const PellucidKeyframes keyframes{times.data(), spheres.data(), 4, stored.data(), 4};
    for (int i = 0; i < 2000; ++i) {
      const double time = i % 7 == 0 ? 0.125 * static_cast<double>(random.below(30)) : random.uniform(-1, 4);
      const Vec3d eye = random.direction() * random.uniform(0, 12);
      const double camera[3] = {eye.x, eye.y, eye.z};
      ASSERT_EQ(select_order_at(set, 1, time, eye),
                pellucid_select_animated(&orders, &keyframes, time, kIdentity, camera))
          << text << ' ' << time;
      const double forward[3] = {-eye.x, -eye.y, -eye.z};
      ASSERT_EQ(select_order(set, 1, nearest_key_frame(table, time), eye),
                pellucid_select_animated_orthographic(&orders, &keyframes, time, kIdentity, forward));
    }
    EXPECT_EQ(nearest_key_frame(table, kNaN), 0U);
    EXPECT_EQ(nearest_key_frame({}, 1), 0U);
  }
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
  // A node that the sequence does not hold is not drawn.
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

TEST(RanksOf, MarksMissingNodes) {
  EXPECT_EQ(ranks_of(NodeSequence{3, 0}, 2), (Ranks{1, kNoRank, kNoRank, 0}));
}

TEST(IndexBuffer, TurnsFlippedTwins) {
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {}, {{0, 1, 2}, {1, 3, 2}}};
  EXPECT_EQ(index_buffer(mesh, NodeSequence{3, 0}), (Ranks{1, 2, 3, 0, 1, 2}));
}

}  // namespace
}  // namespace pellucid
