// Tests which planes face the viewpoints of a cell, against dense samples of its directions and distances,
// and random viewpoints.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "pellucid/view.h"

namespace pellucid {
namespace {

// Returns directions of a cell: a barycentric grid for S, and random directions for P.
std::vector<Vec3d> directions_of(const ViewPartition& partition, std::uint32_t cell, std::uint32_t density) {
  std::vector<Vec3d> directions;
  if (partition.spec.kind == PartitionKind::sampled_triangles) {
    const auto& [a, b, c] = partition.corners[cell];
    for (std::uint32_t i = 0; i <= density; ++i) {
      for (std::uint32_t j = 0; i + j <= density; ++j) {
        const double u = i / static_cast<double>(density);
        const double v = j / static_cast<double>(density);
        directions.push_back(normalized(a * u + b * v + c * (1 - u - v)));
      }
    }
    return directions;
  }
  Random random(cell);
  while (directions.size() < std::size_t{density} * density / 2) {
    const Vec3d d = normalized(partition.samples[cell] + random.direction() * 0.5);
    if (find_cell_brute_force(partition, d) == cell) directions.push_back(d);
  }
  return directions;
}

double sampled_max(const std::vector<Vec3d>& directions, const Vec3d& normal) {
  double largest = -1;
  for (const Vec3d& d : directions) largest = std::max(largest, dot(d, normal));
  return largest;
}

class FacingOfCells : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Partitions, FacingOfCells, ::testing::Values("S0,0", "S1,0", "S2,2", "P1", "P2"),
                         [](const auto& instance) {
                           std::string name = instance.param;
                           std::erase(name, ',');
                           return name;
                         });

TEST_P(FacingOfCells, MaxCosineIsTheLargestOfTheCell) {
  const ViewPartition partition = make_partition(parse_partition(GetParam()));
  const bool exact = partition.spec.kind == PartitionKind::sampled_triangles;
  Random random(5);
  for (int trial = 0; trial < 12; ++trial) {
    const auto cell = static_cast<std::uint32_t>(random.below(partition.cell_count()));
    const std::vector<Vec3d> directions = directions_of(partition, cell, 100);
    for (int i = 0; i < 40; ++i) {
      // Half of the normals are near the cell, so that the cases inside, edge and corner all occur.
      Vec3d normal = random.direction();
      if (i % 2 == 0) normal = normalized(cell_direction(partition, cell) + normal * 0.6);
      const double expected = sampled_max(directions, normal);
      const double cosine = max_cosine(partition, cell, normal);
      EXPECT_LE(cosine, 1);
      EXPECT_GE(cosine, expected);
      // The spacing of the grid is about 1/100 of a cell. Caps are wider than the hexagonal cells.
      if (exact) {
        EXPECT_LT(cosine, expected + 0.006);
      } else {
        EXPECT_LT(std::acos(expected) - std::acos(cosine), 0.12);
      }
    }
  }
}

TEST(MaxCosine, IsOneInsideAndExactAtCornersAndEdges) {
  const ViewPartition partition = make_partition(parse_partition("S1,0"));
  for (std::uint32_t c = 0; c < partition.cell_count(); ++c) {
    EXPECT_EQ(max_cosine(partition, c, cell_direction(partition, c)), 1);
    const auto& [a, b, d] = partition.corners[c];
    EXPECT_NEAR(max_cosine(partition, c, a), 1, 1e-15);
    // Turn from the middle of edge ab outwards by an angle of 0.3.
    const Vec3d outward = -normalized(cross(a, b));
    const Vec3d normal = normalized(a + b) * std::cos(0.3) + outward * std::sin(0.3);
    EXPECT_NEAR(max_cosine(partition, c, normal), std::cos(0.3), 1e-14);
    // Turn away from the opposite side, so that the nearest direction is a corner.
    const Vec3d away = normalized(-d + outward * 1e-3);
    EXPECT_NEAR(max_cosine(partition, c, away), std::max(dot(a, away), dot(b, away)), 0.2);
  }
}

TEST_P(FacingOfCells, FrontIsVisibleExactlyIfACameraSeesIt) {
  const ViewPartition partition = make_partition(parse_partition(GetParam()));
  const bool exact = partition.spec.kind == PartitionKind::sampled_triangles;
  constexpr double kRadius = 2.5;
  Random random(6);
  int seen = 0;
  int hidden = 0;
  int missed_by_sampling = 0;
  for (int trial = 0; trial < 10; ++trial) {
    const auto cell = static_cast<std::uint32_t>(random.below(partition.cell_count()));
    const std::vector<Vec3d> directions = directions_of(partition, cell, 40);
    for (int i = 0; i < 100; ++i) {
      const Vec3d normal = random.direction();
      const double low = random.uniform(0.2, 3);
      const double high = low * random.uniform(1, 4);
      const double offset = random.uniform(-1, 1) * kRadius * low * 1.2;
      bool expected = false;
      for (const Vec3d& d : directions) {
        for (int step = 0; step <= 8; ++step) {
          const double distance = low + (high - low) * step / 8;
          expected = expected || dot(normal, d * (distance * kRadius)) > offset;
        }
      }
      const bool visible = front_visible(partition, cell, normal, offset, kRadius, low, high);
      EXPECT_TRUE(visible || !expected);
      seen += expected ? 1 : 0;
      hidden += visible ? 0 : 1;
      missed_by_sampling += visible && !expected ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 50);
  EXPECT_GT(hidden, 50);
  if (exact) {
    EXPECT_LT(missed_by_sampling, 10);
  }
}

TEST(FrontVisible, AtInfinityDependsOnlyOnTheDirection) {
  const ViewPartition partition = make_partition(parse_partition("S2,0"));
  const Vec3d toward = cell_direction(partition, 7);
  const double far = kInfiniteDistance;
  EXPECT_TRUE(front_visible(partition, 7, toward, 1e9, 1, far, far));
  EXPECT_FALSE(front_visible(partition, 7, -toward, -1e9, 1, far, far));
  EXPECT_TRUE(front_visible(partition, 7, toward, 1e9, 1, 2, far));
  EXPECT_FALSE(front_visible(partition, 7, toward, 1e9, 1, 2, 1000));
  // The plane faces away, but it is so far behind the centre that a camera at 2 radii is in front of it. A
  // camera at 5 radii is not.
  EXPECT_TRUE(front_visible(partition, 7, -toward, -3, 1, 2, far));
  EXPECT_FALSE(front_visible(partition, 7, -toward, -3, 1, 5, far));
}

TEST(FrontVisible, IncludesPlanesSeenEdgeOn) {
  const ViewPartition partition = make_partition(parse_partition("S2,0"));
  for (std::uint32_t c = 0; c < partition.cell_count(); ++c) {
    const auto& [a, b, d] = partition.corners[c];
    // The plane of an edge, facing away from the cell, contains the directions of the edge.
    const Vec3d outward = -normalized(cross(a, b));
    EXPECT_TRUE(front_visible(partition, c, outward, 0, 1, 2, 5));
    EXPECT_TRUE(front_visible(partition, c, outward, 0, 1, kInfiniteDistance, kInfiniteDistance));
    EXPECT_FALSE(front_visible(partition, c, outward, 1e-6, 1, 2, 5));
    // Turn it a little farther: by less than the rounding of a normal, and by clearly more.
    const Vec3d middle = normalized(a + b);
    const double far = kInfiniteDistance;
    EXPECT_TRUE(front_visible(partition, c, normalized(outward - middle * 1e-13), 0, 1, far, far));
    EXPECT_FALSE(front_visible(partition, c, normalized(outward - middle * 1e-6), 0, 1, far, far));
  }
}

TEST(FrontVisible, IncludesMeshesWithoutExtentAndInvalidNormals) {
  const ViewPartition partition = make_partition(parse_partition("S1,0"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(front_visible(partition, 0, cell_direction(partition, 0), 0, 0, 2, 5));
  EXPECT_TRUE(front_visible(partition, 0, {0, 0, 0}, 0, 1, 2, 5));
  EXPECT_TRUE(front_visible(partition, 0, {nan, nan, nan}, nan, 1, 2, 5));
}

// ----------------------------------------------------------------------------------------- random viewpoints

TEST(RandomViewpoints, AreUniformInRange) {
  const std::vector<Viewpoint> viewpoints = random_viewpoints(20000, 2, 5, 3);
  ASSERT_EQ(viewpoints.size(), 20000U);
  Vec3d direction_sum;
  double distance_sum = 0;
  for (const Viewpoint& v : viewpoints) {
    EXPECT_NEAR(length(v.direction), 1, 1e-15);
    EXPECT_GE(v.distance, 2);
    EXPECT_LT(v.distance, 5);
    direction_sum += v.direction;
    distance_sum += v.distance;
  }
  EXPECT_LT(length(direction_sum) / 20000, 0.02);
  EXPECT_NEAR(distance_sum / 20000, 3.5, 0.03);
}

TEST(RandomViewpoints, DependOnlyOnTheSeed) {
  const auto first = random_viewpoints(100, 2, 5, 3);
  const auto longer = random_viewpoints(200, 2, 5, 3);
  const auto other = random_viewpoints(100, 2, 5, 4);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].direction, longer[i].direction);
    EXPECT_EQ(first[i].distance, longer[i].distance);
    EXPECT_NE(first[i].direction, other[i].direction);
  }
}

TEST(RandomViewpoints, AcceptOneDistanceAndRejectInvalidRanges) {
  EXPECT_TRUE(random_viewpoints(0, 2, 5, 1).empty());
  EXPECT_EQ(random_viewpoints(1, 3, 3, 1)[0].distance, 3);
  EXPECT_EQ(random_viewpoints(1, kInfiniteDistance, kInfiniteDistance, 1)[0].distance, kInfiniteDistance);
  EXPECT_THROW(random_viewpoints(1, 0, 5, 1), Error);
  EXPECT_THROW(random_viewpoints(1, 5, 2, 1), Error);
  EXPECT_THROW(random_viewpoints(1, 2, kInfiniteDistance, 1), Error);
  EXPECT_THROW(random_viewpoints(1, std::nan(""), 5, 1), Error);
}

}  // namespace
}  // namespace pellucid
