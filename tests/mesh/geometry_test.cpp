// Bounding sphere and normals, with their hostile corners.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "meshes.h"
#include "pellucid/mesh.h"

namespace pellucid {
namespace {

using testing::kInfinity;
using testing::kNaN;

TEST(BoundingSphere, OfNothingIsAPointAtTheOrigin) {
  EXPECT_EQ(bounding_sphere({}).radius, 0);
  EXPECT_EQ(bounding_sphere({}).center, (Vec3d{}));
  EXPECT_EQ(bounding_sphere({{{5, 5, 5}}, {}, {}}).radius, 0);
  EXPECT_EQ(bounding_sphere({{{kNaN, 0, 0}}, {}, {{0, 0, 0}}}).radius, 0);
}

TEST(BoundingSphere, CentreOfTheBoxAndFarthestCorner) {
  const Mesh mesh{{{0, 0, 0}, {4, 0, 0}, {0, 2, 0}}, {}, {{0, 1, 2}}};
  const BoundingSphere sphere = bounding_sphere(mesh);
  EXPECT_EQ(sphere.center, (Vec3d{2, 1, 0}));
  EXPECT_DOUBLE_EQ(sphere.radius, std::sqrt(5.0));
}

TEST(BoundingSphere, IgnoresUnusedNonFiniteAndOutOfRangeVertices) {
  Mesh mesh{{{-1, 0, 0}, {1, 0, 0}, {0, 0.5F, 0}, {99, 99, 99}, {kNaN, 0, 0}, {0, -kInfinity, 0}},
            {},
            {{0, 1, 2}, {0, 1, 4}, {5, 1, 2}, {0, 1, 77}}};
  const BoundingSphere sphere = bounding_sphere(mesh);
  EXPECT_EQ(sphere.center, (Vec3d{0, 0.25, 0}));
  EXPECT_DOUBLE_EQ(sphere.radius, std::hypot(1.0, 0.25));
}

TEST(BoundingSphere, KeepsItsRelativePrecisionAtTheEndsOfFloat) {
  for (const double scale : {1e-44, 1e-38, 1e-20, 1.0, 1e20, 3e38}) {
    const auto s = static_cast<float>(scale);
    const Mesh mesh{{{-s, 0, 0}, {s, 0, 0}, {0, s, 0}}, {}, {{0, 1, 2}}};
    const double expected = std::hypot(static_cast<double>(s), static_cast<double>(s) / 2);
    EXPECT_NEAR(bounding_sphere(mesh).radius, expected, 1e-12 * expected) << scale;
  }
}

TEST(BoundingSphere, HoldsAllRandomPointsAndTouchesOne) {
  Random random(5);
  Mesh mesh;
  for (std::uint32_t v = 0; v < 300; ++v) {
    mesh.positions.push_back(to_float(random.direction() * random.uniform(0.0, 7.0)));
    mesh.triangles.push_back({v, v, v});
  }
  const BoundingSphere sphere = bounding_sphere(mesh);
  double farthest = 0;
  for (const Vec3f& p : mesh.positions) farthest = std::fmax(farthest, length(to_double(p) - sphere.center));
  EXPECT_EQ(sphere.radius, farthest);
}

TEST(TriangleNormal, CounterClockwiseAndUnit) {
  const Mesh mesh{{{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {4, 0, 0}, {kNaN, 0, 0}},
                  {},
                  {{0, 1, 2}, {0, 2, 1}, {0, 1, 3}, {0, 1, 4}}};
  EXPECT_EQ(triangle_normal(mesh, 0), (Vec3d{0, 0, 1}));
  EXPECT_EQ(triangle_normal(mesh, 1), (Vec3d{0, 0, -1}));
  EXPECT_EQ(triangle_normal(mesh, 2), (Vec3d{}));
  EXPECT_EQ(triangle_normal(mesh, 3), (Vec3d{}));
}

TEST(TriangleNormal, OfAnInfiniteTriangleIsZero) {
  const Mesh mesh{{{0, 0, 0}, {kInfinity, 0, 0}, {1, 1, 1}}, {}, {{0, 1, 2}}};
  EXPECT_EQ(triangle_normal(mesh, 0), (Vec3d{}));
}

TEST(TriangleNormal, IsUnitAtTheEndsOfFloat) {
  for (const float s : {1e-44F, 1e-38F, 1e38F}) {
    const Mesh mesh{{{0, 0, 0}, {s, 0, 0}, {0, s, s}}, {}, {{0, 1, 2}}};
    EXPECT_NEAR(length(triangle_normal(mesh, 0)), 1.0, 1e-12) << s;
  }
}

TEST(VertexNormals, AreWeightedByAreaAndKeptApartAtSeams) {
  // Vertex 0 belongs to a triangle of area 2 facing +z and one of area 1/2 facing +x; vertex 5 stands at the
  // same place but belongs to the second only through its own index.
  const Mesh mesh{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}, {9, 9, 9}},
                  {},
                  {{0, 1, 2}, {0, 3, 4}, {5, 3, 4}, {0, 1, 77}}};
  const std::vector<Vec3f> normals = vertex_normals(mesh);
  ASSERT_EQ(normals.size(), mesh.positions.size());
  const Vec3d expected = normalized(Vec3d{0.5, 0, 2});
  EXPECT_NEAR(normals[0].x, expected.x, 1e-6);
  EXPECT_NEAR(normals[0].z, expected.z, 1e-6);
  EXPECT_EQ(normals[5], (Vec3f{1, 0, 0}));
  EXPECT_EQ(normals[6], (Vec3f{}));
}

TEST(VertexNormals, IgnoreTrianglesWithNaN) {
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {kNaN, 0, 0}}, {}, {{0, 1, 2}, {0, 1, 3}}};
  EXPECT_EQ(vertex_normals(mesh)[0], (Vec3f{0, 0, 1}));
  EXPECT_EQ(vertex_normals(mesh)[3], (Vec3f{}));
}

}  // namespace
}  // namespace pellucid
