// check, clean and weld_by_position on literal meshes, and against plain reference counts on random ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "meshes.h"
#include "pellucid/mesh.h"

namespace pellucid {
namespace {

using testing::kInfinity;
using testing::kNaN;

Mesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

TEST(Check, EmptyMeshHasNothingAndIsNotClosed) {
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

TEST(Check, EveryDefectCountsOnceUnderTheFirstThatFits) {
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

// Plain maps over positions instead of welded indices and sorted keys.
TEST(Check, AgreesWithMapsOverPositions) {
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

TEST(Clean, DropsWhatDrawsNothingAndKeepsOrderVerticesAndDuplicates) {
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

TEST(Clean, StrictRefusesAndSaysWhy) {
  Mesh mesh = tetrahedron();
  mesh.triangles.push_back({1, 0, 2});
  EXPECT_EQ(strict_refusal(mesh, DuplicatePolicy::keep), "");
  EXPECT_EQ(strict_refusal(mesh, DuplicatePolicy::drop),
            "cup.obj: strict checking refuses these of 5 triangles: 1 doubled");
  mesh.positions.push_back({kNaN, 0, 0});
  mesh.triangles.push_back({0, 1, 4});
  mesh.triangles.push_back({0, 1, 5});
  mesh.triangles.push_back({0, 0, 1});
  EXPECT_EQ(
      strict_refusal(mesh, DuplicatePolicy::keep),
      "cup.obj: strict checking refuses these of 8 triangles: 1 with an index out of range, 1 with a NaN or "
      "infinite corner, 1 without area");
}

TEST(Weld, FirstVertexWithTheSamePosition) {
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

}  // namespace
}  // namespace pellucid
