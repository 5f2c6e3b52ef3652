// Tests pellucid/split.h against a brute-force search, the raster and the source triangles.
#include "pellucid/split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "meshes.h"
#include "pellucid/raster.h"
#include "pellucid/view.h"

namespace pellucid {
namespace {

using testing::append;
using testing::icosphere_mesh;
using testing::random_soup;

// Returns a quad of two triangles with the sides b - a and d - a.
Mesh quad(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  return {{a, b, c, d}, {}, {{0, 1, 2}, {0, 2, 3}}};
}

Mesh crossing_quads() {
  Mesh mesh = quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
  append(mesh, quad({-1, 0.1F, -1}, {1, 0.1F, -1}, {1, 0.1F, 1}, {-1, 0.1F, 1}));
  return mesh;
}

// Returns a cube whose sides are grids of `cells` x `cells` quads with separate vertices, so that every edge
// of the cube is a seam.
Mesh cube_mesh(int cells, float half) {
  Mesh mesh;
  for (int side = 0; side < 6; ++side) {
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    const float out = side % 2 == 0 ? half : -half;
    for (int i = 0; i <= cells; ++i) {
      for (int k = 0; k <= cells; ++k) {
        const float u = half * (2.0F * static_cast<float>(i) / static_cast<float>(cells) - 1);
        const float v = half * (2.0F * static_cast<float>(k) / static_cast<float>(cells) - 1) *
                        (side % 2 == 0 ? 1.0F : -1.0F);
        const std::array<Vec3f, 3> at{{{out, u, v}, {v, out, u}, {u, v, out}}};
        mesh.positions.push_back(at[static_cast<std::size_t>(side / 2)]);
      }
    }
    const auto row = static_cast<std::uint32_t>(cells + 1);
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      for (std::uint32_t k = 0; k + 1 < row; ++k) {
        const std::uint32_t a = base + i * row + k;
        mesh.triangles.push_back({a, a + row, a + row + 1});
        mesh.triangles.push_back({a, a + row + 1, a + 1});
      }
    }
  }
  return mesh;
}

Mesh cube_through_sphere() {
  Mesh mesh = cube_mesh(4, 0.75F);
  append(mesh, icosphere_mesh(2, 1, {0.02, 0.03, 0.05}));
  return mesh;
}

std::array<Vec3d, 3> corners_at(const Mesh& mesh, std::uint32_t t) {
  const Triangle& c = mesh.triangles[t];
  return {to_double(mesh.positions[c[0]]), to_double(mesh.positions[c[1]]), to_double(mesh.positions[c[2]])};
}

double area_of(const Mesh& mesh, std::uint32_t t) {
  const auto [a, b, c] = corners_at(mesh, t);
  return 0.5 * length(cross(b - a, c - a));
}

double area_of(const Mesh& mesh) {
  double area = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) area += area_of(mesh, t);
  return area;
}

// Returns whether an edge of one triangle passes through the inside of the other, both by more than `margin`.
bool pierces(const std::array<Vec3d, 3>& edges, const std::array<Vec3d, 3>& face, double margin) {
  const Vec3d normal = normalized(cross(face[1] - face[0], face[2] - face[0]));
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d& p = edges[i];
    const Vec3d& q = edges[(i + 1) % 3];
    const double hp = dot(normal, p - face[0]);
    const double hq = dot(normal, q - face[0]);
    if (!(std::min(hp, hq) < -margin && std::max(hp, hq) > margin)) continue;
    const Vec3d at = p + (q - p) * (hp / (hp - hq));
    double inside = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d side = normalized(cross(normal, face[(k + 1) % 3] - face[k]));
      inside = std::min(inside, dot(side, at - face[k]));
    }
    if (inside > margin) return true;
  }
  return false;
}

std::size_t count_piercing_pairs(const Mesh& mesh, double margin) {
  std::size_t count = 0;
  for (std::uint32_t s = 0; s < mesh.triangles.size(); ++s) {
    for (std::uint32_t t = s + 1; t < mesh.triangles.size(); ++t) {
      const auto a = corners_at(mesh, s);
      const auto b = corners_at(mesh, t);
      if (pierces(a, b, margin) || pierces(b, a, margin)) ++count;
    }
  }
  return count;
}

// Checks the properties that every split has.
void expect_same_surface(const Mesh& input, const MeshSplit& split) {
  const Mesh& mesh = split.mesh;
  const std::size_t inputs = input.positions.size();
  ASSERT_EQ(mesh.positions.size(), inputs + split.new_vertices.size());
  ASSERT_EQ(split.source.size(), mesh.triangles.size());
  EXPECT_TRUE(std::equal(input.positions.begin(), input.positions.end(), mesh.positions.begin()));
  EXPECT_TRUE(std::is_sorted(split.source.begin(), split.source.end()));
  std::vector<double> areas(input.triangles.size(), 0);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) areas[split.source[t]] += area_of(mesh, t);
  for (std::uint32_t t = 0; t < areas.size(); ++t) {
    EXPECT_NEAR(areas[t], area_of(input, t), 1e-6) << "triangle " << t;
  }
  for (std::size_t i = 0; i < split.new_vertices.size(); ++i) {
    const SplitVertex& vertex = split.new_vertices[i];
    Vec3d sum{};
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_LT(vertex.sources[k], inputs);
      EXPECT_GE(vertex.weights[k], 0);
      sum += to_double(input.positions[vertex.sources[k]]) * vertex.weights[k];
    }
    EXPECT_NEAR(vertex.weights[0] + vertex.weights[1] + vertex.weights[2], 1, 1e-12);
    EXPECT_LT(length(sum - to_double(mesh.positions[inputs + i])), 3e-7);
  }
  // Corners are corners of the source triangle or weighted sums of them.
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& whole = input.triangles[split.source[t]];
    const auto is_corner = [&](std::uint32_t v) {
      return std::find(whole.begin(), whole.end(), v) != whole.end();
    };
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v < inputs) {
        EXPECT_TRUE(is_corner(v));
        continue;
      }
      const SplitVertex& from = split.new_vertices[v - inputs];
      EXPECT_TRUE(is_corner(from.sources[0]) && is_corner(from.sources[1]) && is_corner(from.sources[2]));
    }
    const auto [a, b, c] = corners_at(mesh, t);
    const auto [p, q, r] = corners_at(input, split.source[t]);
    EXPECT_GT(dot(cross(b - a, c - a), cross(q - p, r - p)), 0) << "turned over";
  }
}

// Checks that every pixel has the same layers of source triangles at the same depths.
void expect_same_picture(const Mesh& input, const MeshSplit& split, std::uint64_t seed) {
  const BoundingSphere sphere = bounding_sphere(input);
  std::uint64_t pixels = 0;
  std::uint64_t different = 0;
  for (const Viewpoint& view : random_viewpoints(6, 2, 5, seed)) {
    const Camera camera = look_at_sphere(sphere, view, 192, 192);
    FragmentBuffer before;
    FragmentBuffer after;
    rasterize(input, camera, {}, before);
    rasterize(split.mesh, camera, {}, after);
    for (std::uint64_t p = 0; p < 192U * 192U; ++p) {
      std::vector<std::pair<std::uint32_t, float>> a;
      std::vector<std::pair<std::uint32_t, float>> b;
      for (const Fragment& f : before.pixel(p)) a.emplace_back(f.node / 2, f.depth);
      for (const Fragment& f : after.pixel(p)) b.emplace_back(split.source[f.node / 2], f.depth);
      std::sort(a.begin(), a.end());
      std::sort(b.begin(), b.end());
      pixels += a.empty() ? 0U : 1U;
      const bool same = std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
        return x.first == y.first && std::fabs(x.second - y.second) < 1e-3F;
      });
      different += same ? 0U : 1U;
    }
  }
  // New vertices snap to 1/256 pixel, so a pixel centre on an edge may change sides.
  EXPECT_GT(pixels, 10000U);
  EXPECT_LE(different, pixels / 400);
}

TEST(SplitIntersections, CutsCrossingQuadsIntoPiecesOnEitherSide) {
  const Mesh mesh = crossing_quads();
  EXPECT_EQ(count_piercing_pairs(mesh, 1e-5), find_intersections(mesh).size());
  const IntersectionSplit result = split_intersections(mesh);
  EXPECT_EQ(result.pairs, find_intersections(mesh).size());
  EXPECT_EQ(result.left, 0U);
  EXPECT_TRUE(result.split.complete);
  EXPECT_EQ(count_piercing_pairs(result.split.mesh, 1e-5), 0U);
  expect_same_surface(mesh, result.split);
  // It is best to cut one of the quads: its two triangles in pieces of 3 and 4 corners give 8 triangles in
  // all.
  EXPECT_LE(result.split.mesh.triangles.size(), 11U);
}

TEST(SplitIntersections, FindsWhatBruteForceFinds) {
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    const Mesh mesh = random_soup(120, 0.4, seed);
    std::set<std::array<std::uint32_t, 2>> expected;
    for (std::uint32_t s = 0; s < 120; ++s) {
      for (std::uint32_t t = s + 1; t < 120; ++t) {
        const auto a = corners_at(mesh, s);
        const auto b = corners_at(mesh, t);
        if (pierces(a, b, 1e-4) || pierces(b, a, 1e-4)) expected.insert({s, t});
      }
    }
    const auto found = find_intersections(mesh);
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
    EXPECT_GT(expected.size(), 30U);
    for (const auto& pair : expected) EXPECT_TRUE(std::binary_search(found.begin(), found.end(), pair));
    EXPECT_LE(found.size(), expected.size() + 2);  // those within the margin
  }
}

TEST(SplitIntersections, LeavesNoIntersectionsInRandomSoups) {
  for (std::uint64_t seed = 10; seed < 16; ++seed) {
    Mesh mesh = random_soup(80, 0.6, seed);
    append(mesh, random_soup(80, 0.2, seed + 100));
    const IntersectionSplit result = split_intersections(mesh);
    EXPECT_GT(result.pairs, 60U);
    EXPECT_EQ(result.left, 0U);
    EXPECT_EQ(count_piercing_pairs(result.split.mesh, 5e-5), 0U);
    EXPECT_TRUE(find_intersections(result.split.mesh).empty());
    expect_same_surface(mesh, result.split);
    expect_same_picture(mesh, result.split, seed);
    // The mean is fewer than three new triangles per pair.
    EXPECT_LT(result.split.mesh.triangles.size(), mesh.triangles.size() + 3 * result.pairs);
  }
}

TEST(SplitIntersections, KeepsClosedSurfacesClosed) {
  const Mesh mesh = cube_through_sphere();
  ASSERT_TRUE(check(mesh).closed());
  const IntersectionSplit result = split_intersections(mesh);
  EXPECT_GT(result.pairs, 100U);
  EXPECT_EQ(result.left, 0U);
  EXPECT_EQ(count_piercing_pairs(result.split.mesh, 5e-5), 0U);
  expect_same_surface(mesh, result.split);
  expect_same_picture(mesh, result.split, 3);
  const MeshReport report = check(result.split.mesh);
  EXPECT_TRUE(report.closed());
  EXPECT_EQ(report.non_manifold_edges, 0U);
  EXPECT_EQ(report.degenerate, 0U);
}

TEST(SplitIntersections, LeavesNoGapsInClosedSurfaces) {
  const Mesh mesh = cube_through_sphere();
  const Mesh split = split_intersections(mesh).split.mesh;
  const BoundingSphere sphere = bounding_sphere(mesh);
  std::uint64_t pixels = 0;
  for (const Viewpoint& view : random_viewpoints(12, 1.5, 4, 9)) {
    FragmentBuffer fragments;
    rasterize(split, look_at_sphere(sphere, view, 512, 512), {}, fragments);
    for (std::uint64_t p = 0; p < 512U * 512U; ++p) {
      // A ray enters a closed surface as often as it leaves it.
      std::size_t fronts = 0;
      for (const Fragment& f : fragments.pixel(p)) fronts += f.node % 2 == 0 ? 1U : 0U;
      ASSERT_EQ(2 * fronts, fragments.pixel(p).size()) << "pixel " << p;
      pixels += fronts > 0 ? 1U : 0U;
    }
  }
  EXPECT_GT(pixels, 500000U);
}

TEST(SplitIntersections, KeepsSeparateVerticesAtSeams) {
  // Two triangles that share an edge by position only, and one that passes through both.
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {}, {{0, 1, 2}, {3, 4, 5}}};
  append(mesh, Mesh{{{-0.5F, 0.4F, -3}, {1.5F, 0.45F, -3}, {0.5F, 0.5F, 5}}, {}, {{0, 1, 2}}});
  const IntersectionSplit result = split_intersections(mesh);
  EXPECT_EQ(result.left, 0U);
  expect_same_surface(mesh, result.split);
  std::map<std::array<float, 3>, std::set<bool>> sides;
  for (std::size_t i = 0; i < result.split.new_vertices.size(); ++i) {
    const Vec3f& p = result.split.mesh.positions[mesh.positions.size() + i];
    if (p.z == 0 && std::fabs(p.x + p.y - 1) < 1e-6F)
      sides[{p.x, p.y, p.z}].insert(result.split.new_vertices[i].sources[0] >= 3);
  }
  ASSERT_EQ(sides.size(), 1U);  // one point, to the bit
  EXPECT_EQ(sides.begin()->second.size(), 2U);
}

TEST(SplitIntersections, InterpolatesNormals) {
  Mesh mesh = crossing_quads();
  Random random(5);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    mesh.normals.push_back(to_float(random.direction()));
  const MeshSplit split = split_intersections(mesh).split;
  ASSERT_EQ(split.mesh.normals.size(), split.mesh.positions.size());
  for (std::size_t i = 0; i < split.new_vertices.size(); ++i) {
    Vec3d sum{};
    for (std::size_t k = 0; k < 3; ++k) {
      sum += to_double(mesh.normals[split.new_vertices[i].sources[k]]) * split.new_vertices[i].weights[k];
    }
    EXPECT_LT(length(normalized(sum) - to_double(split.mesh.normals[mesh.positions.size() + i])), 1e-6);
  }
}

TEST(SplitIntersections, DoesNotCutTouchingOrCoplanarFaces) {
  // Neighbours, a fold, an edge that only touches, coplanar faces, and a pair that overlaps by only 1e-6.
  Mesh mesh = quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.3F});
  append(mesh, Mesh{{{0.5F, 0.2F, 0}, {0.7F, 0.2F, 0}, {0.5F, 0.2F, -1}}, {}, {{0, 1, 2}}});
  append(mesh, quad({3, 0, 0}, {4, 0, 0}, {4, 1, 0}, {3, 1, 0}));
  append(mesh, quad({3.5F, 0.5F, 0}, {4.5F, 0.5F, 0}, {4.5F, 1.5F, 0}, {3.5F, 1.5F, 0}));
  append(mesh, quad({3, 0, -1e-6F}, {4, 0, 1e-6F}, {4, 1, 1e-6F}, {3, 1, -1e-6F}));
  EXPECT_TRUE(find_intersections(mesh).empty());
  const IntersectionSplit result = split_intersections(mesh);
  EXPECT_EQ(result.split.mesh.triangles, mesh.triangles);
  EXPECT_TRUE(result.split.new_vertices.empty());
}

TEST(SplitIntersections, AddsFewTrianglesToNearlyCoplanarSheets) {
  // Two grids of 800 triangles with ripples of 5e-6 and of 5e-4 radii.
  for (const double height : {5e-6, 5e-4}) {
    Mesh mesh;
    for (int sheet = 0; sheet < 2; ++sheet) {
      Random random(static_cast<std::uint64_t>(sheet) + 1);
      Mesh grid;
      for (int i = 0; i < 21; ++i) {
        for (int k = 0; k < 21; ++k)
          grid.positions.push_back(to_float(Vec3d{0.1 * i, 0.1 * k, height * random.uniform(-1, 1)}));
      }
      for (std::uint32_t i = 0; i < 20; ++i) {
        for (std::uint32_t k = 0; k < 20; ++k) {
          const std::uint32_t a = 21 * i + k;
          grid.triangles.push_back({a, a + 21, a + 22});
          grid.triangles.push_back({a, a + 22, a + 1});
        }
      }
      append(mesh, grid);
    }
    const IntersectionSplit result = split_intersections(mesh);
    expect_same_surface(mesh, result.split);
    EXPECT_LT(result.split.mesh.triangles.size(), mesh.triangles.size() + 4 * result.pairs + 1);
    EXPECT_EQ(result.pairs == 0, height < kLeastCrossing);
    EXPECT_EQ(count_piercing_pairs(result.split.mesh, 1e-4), 0U);
  }
}

TEST(SplitIntersections, RespectsTheTriangleLimit) {
  const Mesh mesh = random_soup(150, 0.5, 33);
  const std::uint64_t needed = split_intersections(mesh).split.mesh.triangles.size() - mesh.triangles.size();
  for (const std::uint64_t limit : {std::uint64_t{0}, std::uint64_t{1}, needed / 2, needed}) {
    SplitOptions options;
    options.max_new_triangles = limit;
    const IntersectionSplit result = split_intersections(mesh, options);
    EXPECT_LE(result.split.mesh.triangles.size(), mesh.triangles.size() + limit);
    EXPECT_EQ(result.split.complete, limit == needed);
    EXPECT_EQ(result.left == 0, limit == needed);
    expect_same_surface(mesh, result.split);
  }
}

TEST(SplitIntersections, SurvivesDegenerateInput) {
  EXPECT_TRUE(split_intersections(Mesh{}).split.mesh.triangles.empty());
  // Needles, points and duplicates, far from the origin.
  Mesh mesh = random_soup(60, 0.5, 44);
  for (Vec3f& p : mesh.positions) p = p + Vec3f{3000, -2000, 1000};
  for (std::uint32_t t = 0; t < 20; ++t) mesh.triangles.push_back(mesh.triangles[t]);
  for (std::uint32_t t = 0; t < 20; ++t) {
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    const Vec3f a = mesh.positions[mesh.triangles[t][0]];
    mesh.positions.insert(mesh.positions.end(), {a, a + Vec3f{1, 1, 1}, a + Vec3f{0.5F, 0.5F, 0.5F + 1e-3F}});
    mesh.triangles.push_back({base, base + 1, base + 2});
  }
  const Mesh tidy = clean(mesh, {}, "").mesh;
  const IntersectionSplit result = split_intersections(tidy);
  EXPECT_EQ(result.left, 0U);
  EXPECT_LT(result.split.mesh.triangles.size(), 20 * tidy.triangles.size());
  EXPECT_NEAR(area_of(result.split.mesh), area_of(tidy), 1e-2);
  for (const Vec3f& p : result.split.mesh.positions) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
  EXPECT_EQ(check(result.split.mesh).degenerate, 0U);
}

TEST(SplitIntersections, IsTheSameForAnyNumberOfThreads) {
  const Mesh mesh = random_soup(700, 0.3, 55);
  const MeshSplit first = split_intersections(mesh).split;
  const ThreadLimit one(1);
  const MeshSplit second = split_intersections(mesh).split;
  EXPECT_EQ(first.mesh.positions, second.mesh.positions);
  EXPECT_EQ(first.mesh.triangles, second.mesh.triangles);
  EXPECT_EQ(first.source, second.source);
}

TEST(CutTriangles, CutsByThePlaneOfAnother) {
  const Mesh mesh = crossing_quads();
  const std::vector<TriangleCut> cuts{{0, 2}, {3, 0}};
  const MeshSplit split = cut_triangles(mesh, cuts);
  expect_same_surface(mesh, split);
  // No piece of triangle 0 is on both sides of y = 0.1, and no piece of triangle 3 is on both sides of z = 0.
  for (std::uint32_t t = 0; t < split.mesh.triangles.size(); ++t) {
    if (split.source[t] != 0 && split.source[t] != 3) continue;
    double least = 1;
    double most = -1;
    for (const Vec3d& p : corners_at(split.mesh, t)) {
      const double height = split.source[t] == 0 ? p.y - 0.1 : p.z;
      least = std::min(least, height);
      most = std::max(most, height);
    }
    EXPECT_TRUE(least > -1e-6 || most < 1e-6);
  }
  // Triangle 1 shares the diagonal with triangle 0, so it has the new vertex, too.
  EXPECT_GT(std::count(split.source.begin(), split.source.end(), 1U), 1);
}

TEST(Compose, JoinsTwoSplits) {
  const Mesh mesh = random_soup(60, 0.6, 66);
  const MeshSplit first = split_intersections(mesh).split;
  std::vector<TriangleCut> cuts;
  for (std::uint32_t t = 0; t + 7 < first.mesh.triangles.size(); ++t) cuts.push_back({t, t + 7});
  const MeshSplit second = cut_triangles(first.mesh, cuts);
  EXPECT_GT(second.new_vertices.size(), 10U);
  expect_same_surface(mesh, compose(first, second));
}

TEST(CutConvex, SharesOneCornerInThePlanePerChangeOfSides) {
  const auto never = [](std::uint32_t, std::uint32_t, double, double) -> std::uint32_t {
    ADD_FAILURE() << "no edge crosses the plane";
    return 0;
  };
  std::vector<std::uint32_t> front;
  std::vector<std::uint32_t> back;
  // The plane contains two adjacent corners at one side of the polygon and three at the other.
  const std::vector<std::uint32_t> corners{0, 1, 2, 3, 4, 5, 6};
  const std::vector<double> heights{1, 1e-9, -2e-9, -1, 3e-9, 0, 2e-9};
  cut_convex(corners, heights, 1e-6, never, front, back);
  EXPECT_EQ(front, (std::vector<std::uint32_t>{0, 1, 5, 6}));
  EXPECT_EQ(back, (std::vector<std::uint32_t>{1, 2, 3, 4, 5}));
}

}  // namespace
}  // namespace pellucid
