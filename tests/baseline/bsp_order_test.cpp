// Tests the walk of a binary space partition against rays and against the raster, from outside and inside the
// hull.
#include <gtest/gtest.h>

#include <optional>

#include "order_helpers.h"
#include "pellucid/baseline.h"
#include "pellucid/raster.h"

namespace pellucid {
namespace {

double area_of(const Mesh& mesh, const Triangle& t) {
  const Vec3d a = to_double(mesh.positions[t[0]]);
  return 0.5 * length(cross(to_double(mesh.positions[t[1]]) - a, to_double(mesh.positions[t[2]]) - a));
}

// Distance at which a ray meets the inside of a triangle, well away from its outline.
std::optional<double> hit(const Mesh& mesh, const Triangle& t, const Vec3d& eye, const Vec3d& direction) {
  const Vec3d a = to_double(mesh.positions[t[0]]);
  const Vec3d ab = to_double(mesh.positions[t[1]]) - a;
  const Vec3d ac = to_double(mesh.positions[t[2]]) - a;
  const Vec3d p = cross(direction, ac);
  const double determinant = dot(ab, p);
  if (std::fabs(determinant) < 1e-9) return std::nullopt;
  const double u = dot(eye - a, p) / determinant;
  const Vec3d q = cross(eye - a, ab);
  const double v = dot(direction, q) / determinant;
  const double distance = dot(ac, q) / determinant;
  constexpr double kMargin = 1e-4;
  if (u < kMargin || v < kMargin || u + v > 1 - kMargin || distance < 1e-3) return std::nullopt;
  return distance;
}

std::vector<std::uint32_t> ranks_from(const BspTree& tree, const Eye& eye) {
  std::vector<std::uint32_t> pieces;
  walk_bsp(tree, eye, pieces);
  std::vector<std::uint32_t> ranks(2 * tree.mesh.triangles.size(), kNoRank);
  for (std::uint32_t rank = 0; rank < pieces.size(); ++rank) {
    ranks[node_of(pieces[rank], false)] = ranks[node_of(pieces[rank], true)] = rank;
  }
  return ranks;
}

// Triangles that cross each other, some of them large.
Mesh crossing_soup(std::uint64_t seed) {
  Mesh mesh = testing::random_soup(60, 0.8, seed);
  testing::append(mesh, testing::random_soup(60, 0.25, seed + 1));
  return mesh;
}

TEST(BspOrder, AlongRandomRaysNearerPiecesComeFirst) {
  Random random(11);
  std::size_t compared = 0;
  std::size_t inside = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Mesh mesh = crossing_soup(100 * seed);
    const BoundingSphere sphere = bounding_sphere(mesh);
    const BspTree tree = build_bsp(mesh, {});
    ASSERT_TRUE(tree.complete);
    EXPECT_GT(tree.splits, 20U);
    for (int k = 0; k < 12; ++k) {
      const Eye eye{sphere.center + random.direction() * random.uniform(0, 2 * sphere.radius), 1};
      if (length(eye.at - sphere.center) < sphere.radius) ++inside;
      const std::vector<std::uint32_t> ranks = ranks_from(tree, eye);
      for (int ray = 0; ray < 100; ++ray) {
        const Vec3d target = sphere.center + random.direction() * random.uniform(0, sphere.radius);
        const Vec3d direction = normalized(target - eye.at);
        std::vector<std::pair<double, std::uint32_t>> hits;
        for (std::uint32_t t = 0; t < tree.mesh.triangles.size(); ++t) {
          if (const auto at = hit(tree.mesh, tree.mesh.triangles[t], eye.at, direction))
            hits.push_back({*at, t});
        }
        std::sort(hits.begin(), hits.end());
        for (std::size_t i = 1; i < hits.size(); ++i) {
          if (hits[i].first - hits[i - 1].first < 1e-5) continue;
          ++compared;
          EXPECT_LT(ranks[node_of(hits[i - 1].second, false)], ranks[node_of(hits[i].second, false)]);
        }
      }
    }
  }
  EXPECT_GT(compared, 5000U);
  EXPECT_GT(inside, 10U);
}

TEST(BspOrder, IsTheOrderOfTheRaster) {
  Random random(12);
  const Mesh mesh = crossing_soup(7);
  const BoundingSphere sphere = bounding_sphere(mesh);
  const BspTree tree = build_bsp(mesh, {});
  PixelCount walked;
  PixelCount sorted;
  for (int k = 0; k < 10; ++k) {
    // Outside, inside the hull, and infinitely far.
    const double distance = k % 3 == 0 ? random.uniform(0.1, 0.9) : k % 3 == 1 ? 2.5 : kInfiniteDistance;
    const Viewpoint view{random.direction(), distance};
    FragmentBuffer fragments;
    rasterize(tree.mesh, look_at_sphere(sphere, view, 256, 256), {}, fragments);
    const PixelCount of_walk = count_incorrect_pixels(fragments, ranks_from(tree, eye_of(sphere, view)));
    walked.foreground += of_walk.foreground;
    walked.incorrect += of_walk.incorrect;
    rasterize(mesh, look_at_sphere(sphere, view, 256, 256), {}, fragments);
    sorted.incorrect += count_incorrect_pixels(
                            fragments, ranks_of(centroid_sorted(mesh, sphere, view), mesh.triangles.size()))
                            .incorrect;
  }
  // Vertices snap to 1/256 pixel, so that pieces can overlap by a sliver where they meet.
  EXPECT_GT(walked.foreground, 100000U);
  EXPECT_LT(walked.incorrect, walked.foreground / 500);
  EXPECT_GT(sorted.incorrect, 50 * walked.incorrect);
}

TEST(BspOrder, PiecesMakeUpTheirTriangle) {
  for (std::uint64_t seed = 20; seed < 25; ++seed) {
    const Mesh mesh = crossing_soup(seed);
    const BspTree tree = build_bsp(mesh, {});
    ASSERT_EQ(tree.source.size(), tree.mesh.triangles.size());
    std::vector<double> areas(mesh.triangles.size(), 0);
    for (std::size_t i = 0; i < tree.source.size(); ++i) {
      const Triangle& whole = mesh.triangles[tree.source[i]];
      areas[tree.source[i]] += area_of(tree.mesh, tree.mesh.triangles[i]);
      // Same winding, same plane.
      const Vec3d normal = triangle_normal(mesh, tree.source[i]);
      if (area_of(tree.mesh, tree.mesh.triangles[i]) > 1e-3) {
        EXPECT_GT(dot(triangle_normal(tree.mesh, static_cast<std::uint32_t>(i)), normal), 0.99);
      }
      for (const std::uint32_t corner : tree.mesh.triangles[i]) {
        const Vec3d offset = to_double(tree.mesh.positions[corner]) - to_double(mesh.positions[whole[0]]);
        EXPECT_NEAR(dot(normal, offset), 0, 1e-5);
      }
    }
    for (std::size_t t = 0; t < areas.size(); ++t) {
      EXPECT_NEAR(areas[t], area_of(mesh, mesh.triangles[t]), 1e-5) << t;
    }
  }
}

TEST(BspOrder, EveryPieceIsDrawnOnceFromAnywhere) {
  const Mesh mesh = crossing_soup(3);
  const BspTree tree = build_bsp(mesh, {});
  Random random(5);
  for (int k = 0; k < 20; ++k) {
    std::vector<std::uint32_t> pieces;
    walk_bsp(tree, {random.direction() * random.uniform(0, 4), k % 2 == 0 ? 1.0 : 0.0}, pieces);
    EXPECT_EQ(pieces.size(), tree.mesh.triangles.size());
    EXPECT_TRUE(testing::is_permutation_of_all(pieces));
  }
}

TEST(BspOrder, DegenerateMeshes) {
  std::vector<std::uint32_t> pieces{7};
  const BspTree none = build_bsp({}, {});
  EXPECT_TRUE(none.complete);
  walk_bsp(none, {}, pieces);
  EXPECT_TRUE(pieces.empty());

  const BspTree one = build_bsp(testing::one_triangle(), {});
  walk_bsp(one, {{0, 0, 3}, 1}, pieces);
  EXPECT_EQ(pieces, (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(one.splits, 0U);

  // Doubled, turned over, and side by side in one plane: one node, nothing is cut.
  Mesh flat = testing::one_triangle();
  testing::append(flat, testing::one_triangle());
  flat.triangles.push_back({0, 2, 1});
  testing::append(flat, {{{5, 5, 0}, {6, 5, 0}, {5, 6, 0}}, {}, {{0, 1, 2}}});
  const BspTree plane = build_bsp(flat, {});
  EXPECT_EQ(plane.nodes.size(), 1U);
  EXPECT_EQ(plane.nodes[0].count, 4U);
  EXPECT_EQ(plane.splits, 0U);
}

TEST(BspOrder, ConvexMeshesAreNotCut) {
  const Mesh sphere = testing::icosphere_mesh(3);
  const BspTree tree = build_bsp(sphere, {});
  EXPECT_EQ(tree.splits, 0U);
  EXPECT_EQ(tree.mesh.triangles.size(), sphere.triangles.size());
  EXPECT_EQ(tree.mesh.positions.size(), sphere.positions.size());
}

TEST(BspOrder, GivesUpWhereItWouldOutgrowItsLimit) {
  const Mesh mesh = crossing_soup(1);
  BspOptions options;
  options.max_pieces = mesh.triangles.size() + 10;
  const BspTree tree = build_bsp(mesh, options);
  EXPECT_FALSE(tree.complete);
  EXPECT_TRUE(tree.nodes.empty());
  EXPECT_TRUE(tree.mesh.triangles.empty());
}

TEST(BspOrder, SameSeedSameTree) {
  const Mesh mesh = crossing_soup(9);
  const BspTree a = build_bsp(mesh, {});
  const BspTree b = build_bsp(mesh, {});
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.mesh.positions, b.mesh.positions);
  EXPECT_EQ(a.source, b.source);
}

}  // namespace
}  // namespace pellucid
