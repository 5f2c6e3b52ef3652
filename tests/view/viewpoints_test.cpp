// Random viewpoints: in range, spread over the sphere, and the same for the same seed.
#include <gtest/gtest.h>

#include "pellucid/view.h"

namespace pellucid {
namespace {

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

TEST(RandomViewpoints, DependOnTheSeedOnly) {
  const auto first = random_viewpoints(100, 2, 5, 3);
  const auto longer = random_viewpoints(200, 2, 5, 3);
  const auto other = random_viewpoints(100, 2, 5, 4);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].direction, longer[i].direction);
    EXPECT_EQ(first[i].distance, longer[i].distance);
    EXPECT_NE(first[i].direction, other[i].direction);
  }
}

TEST(RandomViewpoints, TakeOneDistanceOrRefuseNonsense) {
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
