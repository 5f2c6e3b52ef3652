// Tests key frames at run time: the functions of select.h against brute force over all times and cells.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "pellucid/runtime/select.h"
#include "pellucid/view.h"
#include "runtime_helpers.h"

namespace pellucid {
namespace {

using testing::Direction;
using testing::kInfinity;
using testing::kNaN;
using testing::to_array;

using Matrix = std::array<double, 16>;
constexpr Matrix kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

PellucidKeyframes key_frames_at(const std::vector<float>& times) {
  PellucidKeyframes keyframes{};
  keyframes.times = times.data();
  keyframes.count = static_cast<std::uint32_t>(times.size());
  return keyframes;
}

std::uint32_t nearest_of(const std::vector<float>& times, double time) {
  const PellucidKeyframes keyframes = key_frames_at(times);
  return pellucid_nearest_keyframe(&keyframes, time);
}

std::uint32_t nearest_by_brute_force(const std::vector<float>& times, double time) {
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < times.size(); ++i) {
    if (std::fabs(double{times[i]} - time) < std::fabs(double{times[best]} - time)) best = i;
  }
  return best;
}

TEST(NearestKeyframe, PicksTheEarlierOfTiesAndClampsToTheEnds) {
  EXPECT_EQ(nearest_of({}, 1), 0U);
  EXPECT_EQ(nearest_of({3}, -5), 0U);
  EXPECT_EQ(nearest_of({3}, 5), 0U);
  const std::vector<float> times{-1, 0, 0.5F, 2};
  EXPECT_EQ(nearest_of(times, -7), 0U);
  EXPECT_EQ(nearest_of(times, -0.5), 0U);  // the earlier of two
  EXPECT_EQ(nearest_of(times, -0.4999), 1U);
  EXPECT_EQ(nearest_of(times, 0.25), 1U);
  EXPECT_EQ(nearest_of(times, 0.5), 2U);
  EXPECT_EQ(nearest_of(times, 1.25), 2U);
  EXPECT_EQ(nearest_of(times, 1.26), 3U);
  EXPECT_EQ(nearest_of(times, 1e300), 3U);
  EXPECT_EQ(nearest_of(times, kInfinity), 3U);
  EXPECT_EQ(nearest_of(times, -kInfinity), 0U);
  EXPECT_EQ(nearest_of(times, kNaN), 0U);
}

TEST(NearestKeyframe, AgreesWithBruteForceOverAllTimes) {
  Random random(1);
  for (std::size_t count = 1; count <= 40; ++count) {
    std::vector<float> times{static_cast<float>(random.uniform(-2, 2))};
    while (times.size() < count) {
      // Use steps of quarters in some cases, so that exact ties occur.
      const bool even = random.below(2) == 0;
      times.push_back(even ? std::floor(times.back()) + 1.25F
                           : times.back() + static_cast<float>(random.uniform(1e-3, 1)));
      if (times.back() <= times[times.size() - 2]) times.back() = times[times.size() - 2] + 0.5F;
    }
    for (int i = 0; i < 200; ++i) {
      const double time = random.uniform(double{times.front()} - 1, double{times.back()} + 1);
      ASSERT_EQ(nearest_of(times, time), nearest_by_brute_force(times, time)) << time;
    }
    for (std::size_t i = 0; i < times.size(); ++i) {
      ASSERT_EQ(nearest_of(times, times[i]), i);
      if (i == 0) continue;
      const double middle = (double{times[i - 1]} + double{times[i]}) / 2;
      ASSERT_EQ(nearest_of(times, middle), i - 1);
    }
  }
}

// A moving model with a different table for every key frame.
struct Walk {
  PartitionSpec spec;
  ViewPartition partition;
  std::vector<float> times, spheres;
  std::vector<std::uint16_t> rows;  // as stored: P cells once per corner
  std::vector<std::uint8_t> rest;
  PellucidOrders orders{};
  PellucidKeyframes keyframes{};

  Walk(const char* text, std::uint32_t count, std::uint64_t seed)
      : spec(parse_partition(text)), partition(make_partition(spec)) {
    const bool corners = spec.kind == PartitionKind::viewpoints;
    const std::size_t cells = corners ? partition.corner_cells.size() : partition.cell_count();
    Random random(seed);
    rest.assign(cells, 200);
    for (std::uint32_t k = 0; k < count; ++k) {
      times.push_back(0.25F * static_cast<float>(k * k + k));
      for (int i = 0; i < 3; ++i) spheres.push_back(static_cast<float>(random.uniform(-9, 9)));
      spheres.push_back(static_cast<float>(random.uniform(0, 3)));
      for (std::uint32_t c = 0; c < cells; ++c) {
        rows.push_back(static_cast<std::uint16_t>(order_of(k, corners ? partition.corner_cells[c] : c)));
      }
    }
    orders.cells = corners ? pellucid_cells_corners : pellucid_cells_triangles;
    orders.level = spec.level;
    orders.radius = 1;
    orders.min_distance = 2;
    orders.max_distance = 3;
    orders.cell_orders = rest.data();
    orders.cell_order_bytes = 1;
    orders.fallback_order = PELLUCID_NO_ORDER;
    keyframes = {times.data(), spheres.data(), count, rows.data(), 2};
  }

  // The order differs for every cell and key frame.
  [[nodiscard]] std::uint32_t order_of(std::uint32_t frame, std::uint32_t cell) const {
    return frame * partition.cell_count() + cell;
  }
  [[nodiscard]] Vec3d center(std::uint32_t frame) const {
    return {spheres[4 * frame], spheres[4 * frame + 1], spheres[4 * frame + 2]};
  }
};

class AnimatedCells : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, AnimatedCells, ::testing::Values("S0,0", "S1,0", "P1"));

TEST_P(AnimatedCells, AgreesWithBruteForceFromEverywhere) {
  const Walk walk(GetParam(), 7, 3);
  Random random(5);
  for (int i = 0; i < 100000 / 3; ++i) {
    const double time = random.uniform(-1, 15);
    const std::uint32_t frame = nearest_by_brute_force(walk.times, time);
    // Test near and far cameras and those inside of the sphere, because overdraw orders have no range.
    const Vec3d direction = random.direction();
    const double distance = std::exp(random.uniform(-5, 9));
    const Direction camera = to_array(walk.center(frame) + direction * distance);
    const Vec3d seen = Vec3d{camera[0], camera[1], camera[2]} - walk.center(frame);
    ASSERT_EQ(pellucid_select_animated(&walk.orders, &walk.keyframes, time, kIdentity.data(), camera.data()),
              walk.order_of(frame, find_cell_brute_force(walk.partition, seen)));
    const Direction forward = to_array(-direction);
    ASSERT_EQ(pellucid_select_animated_orthographic(&walk.orders, &walk.keyframes, time, kIdentity.data(),
                                                    forward.data()),
              walk.order_of(frame, find_cell_brute_force(walk.partition, direction)));
  }
}

TEST(AnimatedSelection, AppliesTheMatrixOfTheModel) {
  const Walk walk("S1,0", 3, 7);
  // The matrix mirrors, rotates, scales and translates.
  const Matrix world{0, 2, 0, 0, 2, 0, 0, 0, 0, 0, 3, 0, 5, -6, 7, 1};
  Random random(9);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d d = random.direction() * 4;
    const Vec3d local = walk.center(1) + d;
    const Direction camera{2 * local.y + 5, 2 * local.x - 6, 3 * local.z + 7};
    ASSERT_EQ(pellucid_select_animated(&walk.orders, &walk.keyframes, 0.5, world.data(), camera.data()),
              walk.order_of(1, find_cell_brute_force(walk.partition, d)));
    const Direction forward{-2 * d.y, -2 * d.x, -3 * d.z};
    ASSERT_EQ(pellucid_select_animated_orthographic(&walk.orders, &walk.keyframes, 0.5, world.data(),
                                                    forward.data()),
              walk.order_of(1, find_cell_brute_force(walk.partition, d)));
  }
}

TEST(AnimatedSelection, UsesTheModelAtRestWithoutAnAnimation) {
  Walk walk("S0,0", 2, 11);
  for (std::size_t cell = 0; cell < walk.rest.size(); ++cell) {
    walk.rest[cell] = static_cast<std::uint8_t>(100 + cell);
  }
  Random random(13);
  for (int i = 0; i < 200; ++i) {
    const Vec3d d = random.direction() * random.uniform(0.1, 20);  // minDistance and maxDistance do not count
    const std::uint32_t expected = 100 + find_cell_brute_force(walk.partition, d);
    const PellucidKeyframes none{};
    EXPECT_EQ(pellucid_select_animated(&walk.orders, nullptr, 1, kIdentity.data(), to_array(d).data()),
              expected);
    EXPECT_EQ(pellucid_select_animated(&walk.orders, &none, 1, kIdentity.data(), to_array(d).data()),
              expected);
  }
}

TEST(AnimatedSelection, ReturnsAnOrderWithoutADirection) {
  const Walk walk("S0,0", 2, 15);
  const Matrix flat{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
  const auto select = [&](const Matrix& world, const Direction& camera) {
    return pellucid_select_animated(&walk.orders, &walk.keyframes, 0.5, world.data(), camera.data());
  };
  const std::uint32_t cell_0 = walk.order_of(1, 0);
  EXPECT_EQ(select(flat, {1, 2, 3}), cell_0);
  EXPECT_EQ(select(kIdentity, {1, kNaN, 3}), cell_0);
  EXPECT_EQ(select(kIdentity, to_array(walk.center(1))), cell_0);
}

}  // namespace
}  // namespace pellucid
