// Tests pellucid/mesh.h except for the samples: bounds and normals, welding, checking, cleaning and
// simplification, on literal meshes, at the ends of the float32 range, and against simple reference code on
// random meshes.
#include "pellucid/mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "meshes.h"

namespace pellucid {
namespace {

using testing::kInfinity;
using testing::kNaN;
using testing::volume;

// ---------------------------------------------------------------------------------------- bounds and normals

TEST(BoundingSphere, OfAnEmptyMeshIsAPointAtTheOrigin) {
  EXPECT_EQ(bounding_sphere({}).radius, 0);
  EXPECT_EQ(bounding_sphere({}).center, (Vec3d{}));
  EXPECT_EQ(bounding_sphere({{{5, 5, 5}}, {}, {}}).radius, 0);
  EXPECT_EQ(bounding_sphere({{{kNaN, 0, 0}}, {}, {{0, 0, 0}}}).radius, 0);
}

TEST(BoundingSphere, HasTheCentreOfTheBoxAndReachesTheFarthestCorner) {
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

TEST(BoundingSphere, IsPreciseAtTheEndsOfTheFloatRange) {
  for (const double scale : {1e-44, 1e-38, 1e-20, 1.0, 1e20, 3e38}) {
    const auto s = static_cast<float>(scale);
    const Mesh mesh{{{-s, 0, 0}, {s, 0, 0}, {0, s, 0}}, {}, {{0, 1, 2}}};
    const double expected = std::hypot(static_cast<double>(s), static_cast<double>(s) / 2);
    EXPECT_NEAR(bounding_sphere(mesh).radius, expected, 1e-12 * expected) << scale;
  }
}

TEST(BoundingSphere, ContainsAllRandomPointsAndTouchesOne) {
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

TEST(TriangleNormal, FollowsTheWindingAndIsUnit) {
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

TEST(TriangleNormal, IsUnitAtTheEndsOfTheFloatRange) {
  for (const float s : {1e-44F, 1e-38F, 1e38F}) {
    const Mesh mesh{{{0, 0, 0}, {s, 0, 0}, {0, s, s}}, {}, {{0, 1, 2}}};
    EXPECT_NEAR(length(triangle_normal(mesh, 0)), 1.0, 1e-12) << s;
  }
}

TEST(VertexNormals, AreWeightedByAreaAndSeparateAtSeams) {
  // Vertex 0 belongs to a triangle of area 2 that faces +z and to one of area 1/2 that faces +x. Vertex 5 has
  // the same position but belongs only to the second triangle.
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

// ---------------------------------------------------------------------------- checking, cleaning and welding

Mesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

TEST(Check, EmptyMeshHasNoDefectsAndIsNotClosed) {
  const MeshReport report = check({});
  EXPECT_EQ(report.vertices, 0U);
  EXPECT_EQ(report.triangles, 0U);
  EXPECT_FALSE(report.closed());
}

TEST(Check, OneTriangleHasThreeBoundaryEdges) {
  const MeshReport report = check({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {{0, 1, 2}}});
  EXPECT_EQ(report.boundary_edges, 3U);
  EXPECT_EQ(report.non_manifold_edges, 0U);
  EXPECT_FALSE(report.closed());
}

TEST(Check, TetrahedronIsClosed) {
  const MeshReport report = check(tetrahedron());
  EXPECT_TRUE(report.closed());
  EXPECT_EQ(report.degenerate + report.duplicate + report.non_finite + report.out_of_range, 0U);
}

TEST(Check, CountsEachTriangleUnderItsFirstDefect) {
  Mesh mesh = tetrahedron();
  mesh.positions.push_back({kNaN, 0, 0});       // 4
  mesh.positions.push_back({0, kInfinity, 0});  // 5
  mesh.positions.push_back({-0.0F, 0, 0});      // 6: vertex 0 again
  mesh.positions.push_back({2, 0, 0});          // 7: in line with 0 and 1
  mesh.positions.push_back({9, 9, 9});          // 8: unreferenced
  mesh.triangles.push_back({0, 1, 99});         // out of range
  mesh.triangles.push_back({4, 4, 99});         // out of range first, although non-finite and degenerate too
  mesh.triangles.push_back({0, 4, 1});          // non-finite
  mesh.triangles.push_back({5, 5, 5});          // non-finite first
  mesh.triangles.push_back({0, 6, 1});          // two corners at one position
  mesh.triangles.push_back({0, 1, 7});          // no area
  mesh.triangles.push_back({2, 1, 6});          // triangle 0 rotated
  mesh.triangles.push_back({6, 1, 2});          // triangle 0 the other way round: not a duplicate
  const MeshReport report = check(mesh);
  EXPECT_EQ(report.triangles, 12U);
  EXPECT_EQ(report.vertices, 9U);
  EXPECT_EQ(report.out_of_range, 2U);
  EXPECT_EQ(report.non_finite, 2U);
  EXPECT_EQ(report.degenerate, 2U);
  EXPECT_EQ(report.duplicate, 1U);
  EXPECT_EQ(report.unreferenced_vertices, 1U);
  EXPECT_EQ(report.non_manifold_edges, 3U);  // those of triangle 0, drawn four times or more
}

TEST(Check, TinyAndHugeTrianglesHaveArea) {
  for (const float scale : {1e-38F, 1e-30F, 1e30F, 3e38F}) {
    Mesh mesh = tetrahedron();
    for (Vec3f& p : mesh.positions) p = p * scale;
    EXPECT_EQ(check(mesh).degenerate, 0U) << scale;
  }
}

Mesh random_mesh(Random& random) {
  Mesh mesh;
  const auto coordinate = [&] { return static_cast<float>(random.below(3)) - 1.0F; };
  const std::uint64_t vertices = 3 + random.below(20);
  for (std::uint64_t v = 0; v < vertices; ++v) {
    mesh.positions.push_back(
        {coordinate(), coordinate(), coordinate() * (random.below(2) == 0 ? 1.0F : -1.0F)});
  }
  const std::uint64_t triangles = random.below(60);
  for (std::uint64_t i = 0; i < triangles; ++i) {
    const auto index = [&] {
      return static_cast<std::uint32_t>(random.below(vertices + (i % 7 == 0 ? 1 : 0)));
    };
    mesh.triangles.push_back({index(), index(), index()});
  }
  return mesh;
}

// The reference uses maps over positions instead of welded indices and sorted keys.
TEST(Check, AgreesWithReferenceCountsOnRandomMeshes) {
  using Point = std::array<float, 3>;
  Random random(7);
  for (int round = 0; round < 300; ++round) {
    const Mesh mesh = random_mesh(random);
    std::map<std::set<Point>, int> edges;
    std::set<std::array<Point, 3>> seen;
    std::uint64_t out_of_range = 0;
    std::uint64_t degenerate = 0;
    std::uint64_t duplicate = 0;
    for (const Triangle& t : mesh.triangles) {
      if (*std::max_element(t.begin(), t.end()) >= mesh.positions.size()) {
        ++out_of_range;
        continue;
      }
      std::array<Point, 3> p;
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3f& q = mesh.positions[t[i]];
        p[i] = {q.x + 0.0F, q.y + 0.0F, q.z + 0.0F};  // -0 + 0 = +0
      }
      const bool distinct = std::set<Point>(p.begin(), p.end()).size() == 3;
      if (distinct) {
        for (std::size_t i = 0; i < 3; ++i) ++edges[{p[i], p[(i + 1) % 3]}];
      }
      std::rotate(p.begin(), std::min_element(p.begin(), p.end()), p.end());
      const Vec3d a{p[0][0], p[0][1], p[0][2]};
      const Vec3d area = cross(Vec3d{p[1][0], p[1][1], p[1][2]} - a, Vec3d{p[2][0], p[2][1], p[2][2]} - a);
      if (!distinct || length(area) == 0) {
        ++degenerate;
      } else if (!seen.insert(p).second) {
        ++duplicate;
      }
    }
    const auto edges_with = [&](auto&& condition) {
      return static_cast<std::uint64_t>(std::count_if(
          edges.begin(), edges.end(), [&](const auto& edge) { return condition(edge.second); }));
    };
    const MeshReport report = check(mesh);
    ASSERT_EQ(report.out_of_range, out_of_range);
    ASSERT_EQ(report.degenerate, degenerate);
    ASSERT_EQ(report.duplicate, duplicate);
    ASSERT_EQ(report.boundary_edges, edges_with([](int n) { return n == 1; }));
    ASSERT_EQ(report.non_manifold_edges, edges_with([](int n) { return n > 2; }));
  }
}

TEST(Clean, RemovesOnlyTrianglesThatDrawNothing) {
  Mesh mesh = tetrahedron();
  mesh.triangles.insert(mesh.triangles.begin() + 1, {0, 0, 1});
  mesh.triangles.push_back({1, 0, 2});  // triangle 0 again
  const CleanMesh kept = clean(mesh, {}, "m");
  EXPECT_EQ(kept.mesh.positions, mesh.positions);
  EXPECT_THAT(kept.source, ::testing::ElementsAre(0, 2, 3, 4, 5));
  for (std::size_t i = 0; i < kept.source.size(); ++i) {
    EXPECT_EQ(kept.mesh.triangles[i], mesh.triangles[kept.source[i]]);
  }
  EXPECT_EQ(kept.report.degenerate, 1U);

  const CleanMesh dropped = clean(mesh, {.duplicates = DuplicatePolicy::drop}, "m");
  EXPECT_THAT(dropped.source, ::testing::ElementsAre(0, 2, 3, 4));
}

TEST(Clean, ResultIsCleanOnRandomMeshes) {
  Random random(11);
  for (int round = 0; round < 200; ++round) {
    const CleanMesh result = clean(random_mesh(random), {.duplicates = DuplicatePolicy::drop}, "m");
    const MeshReport report = check(result.mesh);
    ASSERT_EQ(report.out_of_range + report.non_finite + report.degenerate + report.duplicate, 0U);
    ASSERT_TRUE(std::is_sorted(result.source.begin(), result.source.end()));
  }
}

std::string strict_refusal(const Mesh& mesh, DuplicatePolicy duplicates) {
  try {
    clean(mesh, {.duplicates = duplicates, .strict = true}, "cup.obj");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_input);
    return error.what();
  }
  return "";
}

TEST(Clean, StrictThrowsAndListsTheDefects) {
  Mesh mesh = tetrahedron();
  mesh.triangles.push_back({1, 0, 2});
  EXPECT_EQ(strict_refusal(mesh, DuplicatePolicy::keep), "");
  EXPECT_EQ(strict_refusal(mesh, DuplicatePolicy::drop),
            "cup.obj: strict checking refuses these of 5 triangles: 1 duplicate");
  mesh.positions.push_back({kNaN, 0, 0});
  mesh.triangles.push_back({0, 1, 4});
  mesh.triangles.push_back({0, 1, 5});
  mesh.triangles.push_back({0, 0, 1});
  EXPECT_EQ(
      strict_refusal(mesh, DuplicatePolicy::keep),
      "cup.obj: strict checking refuses these of 8 triangles: 1 with an index out of range, 1 with a NaN or "
      "infinite corner, 1 without area");
}

TEST(Weld, FindsTheFirstVertexAtEachPosition) {
  const std::vector<Vec3f> positions{{1, 2, 3}, {0, 0, 0}, {1, 2, 3}, {-0.0F, 0, -0.0F}, {3, 2, 1}};
  EXPECT_THAT(weld_by_position(positions), ::testing::ElementsAre(0, 1, 0, 1, 4));
  EXPECT_TRUE(weld_by_position({}).empty());
}

TEST(Weld, AgreesWithAMapOnRandomPoints) {
  Random random(3);
  std::vector<Vec3f> positions(5000);
  for (Vec3f& p : positions) {
    p = {static_cast<float>(random.below(12)), static_cast<float>(random.below(12)) * 1e-40F,
         -static_cast<float>(random.below(12)) * 1e37F};
  }
  std::map<std::array<float, 3>, std::uint32_t> first;
  const std::vector<std::uint32_t> weld = weld_by_position(positions);
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    const auto& p = positions[v];
    ASSERT_EQ(weld[v], first.try_emplace({p.x, p.y, p.z + 0.0F}, v).first->second);
  }
}

// -------------------------------------------------------------------------------------------- simplification

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

TEST(Simplify, DoesNotOpenSeams) {
  // Give every triangle its own vertices, as in an STL file.
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

TEST(Simplify, OnlyCleansMeshesBelowTheTarget) {
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

TEST(Simplify, WorksAtTheEndsOfTheFloatRange) {
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
