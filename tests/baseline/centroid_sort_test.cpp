// Tests the radix sort of centroids against a simple sort in double precision.
#include <gtest/gtest.h>

#include <numeric>

#include "order_helpers.h"
#include "pellucid/baseline.h"

namespace pellucid {
namespace {

TEST(CentroidSorted, NearestFirstWithTheFacingSeen) {
  // Three triangles along z; the middle one is turned away.
  Mesh mesh;
  for (const float z : {0.0F, 1.0F, -1.0F})
    testing::append(mesh, {{{-1, -1, z}, {1, -1, z}, {0, 1, z}}, {}, {{0, 1, 2}}});
  std::swap(mesh.triangles[1][0], mesh.triangles[1][1]);
  const BoundingSphere sphere = bounding_sphere(mesh);
  for (const double distance : {2.0, 5.0, kInfiniteDistance}) {
    EXPECT_EQ(centroid_sorted(mesh, sphere, {{0, 0, 1}, distance}),
              (NodeSequence{node_of(1, true), node_of(0, false), node_of(2, false)}));
    EXPECT_EQ(centroid_sorted(mesh, sphere, {{0, 0, -1}, distance}),
              (NodeSequence{node_of(2, true), node_of(0, true), node_of(1, false)}));
  }
}

TEST(CentroidSort, IsThePlainSortUpToRounding) {
  Random random(3);
  for (const double shift : {0.0, 100.0}) {
    Mesh mesh = testing::random_soup(3000, 0.1, 17);
    for (Vec3f& p : mesh.positions) p += to_float(Vec3d{shift, 0, 0});
    const BoundingSphere sphere = bounding_sphere(mesh);
    const CentroidSort sort(mesh, sphere);
    CentroidSort::Scratch scratch;
    std::vector<std::uint32_t> triangles;
    for (int k = 0; k < 8; ++k) {
      const Viewpoint view{random.direction(), k % 2 == 0 ? random.uniform(0, 4) : kInfiniteDistance};
      const Eye eye = eye_of(sphere, view);
      sort.sort(eye, scratch, triangles);
      ASSERT_TRUE(testing::is_permutation_of_all(triangles));
      double before = -1e300;
      for (const std::uint32_t t : triangles) {
        Vec3d centroid{};
        for (const std::uint32_t v : mesh.triangles[t]) centroid += to_double(mesh.positions[v]) / 3.0;
        // Rounded are the centroid and the camera, relative to the sphere, and the squared distance.
        const double distance =
            eye.w == 0 ? -dot(centroid - sphere.center, eye.at) : length(eye.at - centroid);
        EXPECT_GT(distance, before - 2e-6 * (1 + std::fabs(distance)));
        before = distance;
      }
    }
  }
}

TEST(CentroidSort, EqualDistancesStayInFileOrder) {
  Mesh mesh;
  for (int i = 0; i < 50; ++i) testing::append(mesh, testing::one_triangle());
  std::vector<std::uint32_t> expected(50);
  std::iota(expected.begin(), expected.end(), 0U);
  EXPECT_EQ(centroid_sorted(mesh, bounding_sphere(mesh), {{0, 0, 1}, 3}).front(), node_of(0, false));
  CentroidSort::Scratch scratch;
  std::vector<std::uint32_t> triangles;
  CentroidSort(mesh, bounding_sphere(mesh)).sort({{0, 0, 1}, 0}, scratch, triangles);
  EXPECT_EQ(triangles, expected);
  CentroidSort({}, {}).sort({{0, 0, 1}, 0}, scratch, triangles);
  EXPECT_TRUE(triangles.empty());
}

}  // namespace
}  // namespace pellucid
