// Tests the use of order sets at run time: selection, ranks and index buffers.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "order_helpers.h"
#include "pellucid/runtime/select.h"

namespace pellucid {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(SelectOrder, ReturnsTheOrderOfTheCellFoundByBruteForce) {
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

TEST(SelectOrder, AgreesWithSelectHForAnimations) {
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

TEST(RanksOf, MarksMissingNodes) {
  EXPECT_EQ(ranks_of(NodeSequence{3, 0}, 2), (std::vector<std::uint32_t>{1, kNoRank, kNoRank, 0}));
}

TEST(IndexBuffer, ReversesFlippedCopies) {
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {}, {{0, 1, 2}, {1, 3, 2}}};
  EXPECT_EQ(index_buffer(mesh, NodeSequence{3, 0}), (std::vector<std::uint32_t>{1, 2, 3, 0, 1, 2}));
}

}  // namespace
}  // namespace pellucid
