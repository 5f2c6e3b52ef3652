// simplify: fewer triangles, still the same shape, nothing left over.
#include <gtest/gtest.h>

#include <limits>

#include "meshes.h"
#include "pellucid/mesh.h"

namespace pellucid {
namespace {

using testing::kNaN;
using testing::volume;

TEST(Simplify, ReachesTheTargetAndKeepsTheShape) {
  const Mesh knot = make_sample("torus-knot").front().mesh;
  for (const std::uint32_t target : {4000U, 2000U}) {
    const Mesh simple = simplify(knot, target);
    EXPECT_LE(simple.triangles.size(), target);
    EXPECT_GE(simple.triangles.size(), target * 9 / 10);
    EXPECT_NEAR(volume(simple), volume(knot), 0.05 * volume(knot));
    const MeshReport report = check(simple);
    EXPECT_TRUE(report.closed());
    EXPECT_EQ(report.unreferenced_vertices + report.degenerate, 0U);
    EXPECT_EQ(simple.normals.size(), simple.positions.size());
  }
}

TEST(Simplify, IsDeterministic) {
  const Mesh knot = make_sample("torus-knot").front().mesh;
  const Mesh a = simplify(knot, 1500);
  const Mesh b = simplify(knot, 1500);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(Simplify, WeldsSeamsSoThatTheyDoNotOpen) {
  // Every triangle with vertices of its own, as in an STL file.
  const Mesh shell = make_sample("nested-shells").front().mesh;
  Mesh soup;
  for (const Triangle& t : shell.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (const std::uint32_t v : t) soup.positions.push_back(shell.positions[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const Mesh simple = simplify(soup, 500);
  EXPECT_LE(simple.triangles.size(), 500U);
  EXPECT_TRUE(check(simple).closed());
  EXPECT_TRUE(simple.normals.empty());
}

TEST(Simplify, LeavesSmallMeshesAloneButCleansThem) {
  const Mesh mesh{
      {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {kNaN, 0, 0}}, {}, {{1, 2, 3}, {1, 2, 4}, {1, 1, 2}}};
  const Mesh simple = simplify(mesh, 100);
  EXPECT_EQ(simple.positions, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(simple.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_TRUE(simplify({}, 10).triangles.empty());
  EXPECT_TRUE(simplify(mesh, 0).triangles.empty());
}

TEST(Simplify, ReachesTheTargetOnACloudOfSmallParts) {
  Random random(1);
  Mesh cloud;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const Vec3d center = random.direction();
    for (int corner = 0; corner < 3; ++corner) {
      cloud.positions.push_back(to_float(center + random.direction() * 0.05));
    }
    cloud.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_LE(simplify(cloud, 200).triangles.size(), 200U);
}

TEST(Simplify, WorksAtTheEndsOfFloat) {
  const Mesh knot = make_sample("torus-knot").front().mesh;
  for (const float scale : {1e-37F, 1e37F}) {
    Mesh scaled = knot;
    for (Vec3f& p : scaled.positions) p = p * scale;
    const Mesh simple = simplify(scaled, 2000);
    EXPECT_LE(simple.triangles.size(), 2000U);
    EXPECT_GE(simple.triangles.size(), 1800U);
  }
}

}  // namespace
}  // namespace pellucid
