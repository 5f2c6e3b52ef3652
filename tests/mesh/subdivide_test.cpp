// Tests pellucid/subdivide.h: known weights and counts, seams, non-manifold input and random triangles.
#include "pellucid/subdivide.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <set>

#include "meshes.h"

namespace pellucid::testing {
namespace {

Subdivision subdivided(const Mesh& mesh, std::uint32_t levels) {
  return subdivide_loop(mesh.triangles, weld_by_position(mesh.positions), levels);
}

// Returns the weight of every control vertex in a refined vertex.
std::map<std::uint32_t, double> stencil(const Subdivision& s, std::uint32_t vertex) {
  std::map<std::uint32_t, double> weights;
  for (std::uint32_t i = s.first[vertex]; i < s.first[vertex + 1]; ++i) weights[s.control[i]] += s.weights[i];
  return weights;
}

std::uint32_t vertex_near(const Mesh& mesh, const Vec3f& position) {
  std::uint32_t best = 0;
  for (std::uint32_t v = 1; v < mesh.positions.size(); ++v) {
    if (length(mesh.positions[v] - position) < length(mesh.positions[best] - position)) best = v;
  }
  return best;
}

// Returns whether every edge has one triangle, or two that use it in opposite directions.
bool is_oriented_manifold(const std::vector<Triangle>& triangles) {
  std::set<std::array<std::uint32_t, 2>> directed;
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (t[k] == t[(k + 1) % 3]) return false;
      if (!directed.insert({t[k], t[(k + 1) % 3]}).second) return false;
    }
  }
  return true;
}

// Two triangles back to back have children back to back with common inner edges. The mesh that is refined
// must therefore be manifold, not the result.
void expect_sound(const Mesh& mesh, const Subdivision& s) {
  EXPECT_TRUE(is_oriented_manifold(subdivided(mesh, 0).triangles));
  ASSERT_EQ(s.source.size(), s.triangles.size());
  for (std::uint32_t v = 0; v < s.vertices(); ++v) {
    double sum = 0;
    for (std::uint32_t i = s.first[v]; i < s.first[v + 1]; ++i) {
      EXPECT_GE(s.weights[i], 0);
      sum += s.weights[i];
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

// Returns a large triangle of equilateral triangles, `size` per side.
Mesh triangle_patch(std::uint32_t size) {
  Mesh mesh;
  std::vector<std::vector<std::uint32_t>> rows;
  for (std::uint32_t y = 0; y <= size; ++y) {
    std::vector<std::uint32_t>& row = rows.emplace_back();
    for (std::uint32_t x = 0; x + y <= size; ++x) {
      row.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(
          {static_cast<float>(x) + 0.5F * static_cast<float>(y), static_cast<float>(y), 0});
    }
  }
  for (std::uint32_t y = 0; y < size; ++y) {
    for (std::uint32_t x = 0; x + y < size; ++x) {
      mesh.triangles.push_back({rows[y][x], rows[y][x + 1], rows[y + 1][x]});
      if (x + y + 1 < size) mesh.triangles.push_back({rows[y][x + 1], rows[y + 1][x + 1], rows[y + 1][x]});
    }
  }
  return mesh;
}

TEST(Subdivide, AddsAVertexPerEdge) {
  const Mesh mesh = icosphere_mesh(1);
  for (std::uint32_t levels = 0; levels <= 3; ++levels) {
    const Subdivision s = subdivided(mesh, levels);
    const std::size_t triangles = mesh.triangles.size() << (2 * levels);
    EXPECT_EQ(s.triangles.size(), triangles);
    // Euler: V = 2 + E - F, 2 E = 3 F.
    EXPECT_EQ(s.vertices(), 2 + triangles / 2);
    expect_sound(mesh, s);
    EXPECT_TRUE(is_oriented_manifold(s.triangles));
    const Mesh refined = subdivide(mesh, levels);
    EXPECT_EQ(check(refined).boundary_edges, 0U);
    EXPECT_GT(volume(refined), 0);
  }
}

TEST(Subdivide, FollowsLoopsRuleOnTheIcosahedron) {
  // Valence 5: beta = (5/8 - (3/8 + cos(2 pi / 5) / 4)^2) / 5; the five neighbours' mean is z / sqrt(5) of
  // the pole.
  const Mesh mesh = icosphere_mesh(0);
  const double cosine = std::cos(2 * 3.14159265358979323846 / 5);
  const double beta = (0.625 - std::pow(0.375 + 0.25 * cosine, 2)) / 5;
  const double radius = 1 - 5 * beta + 5 * beta / std::sqrt(5.0);
  const Mesh refined = subdivide(mesh, 1);
  const Vec3f pole = mesh.positions[0];
  const Vec3f moved = refined.positions[vertex_near(refined, pole * static_cast<float>(radius))];
  EXPECT_LT(length(moved - pole * static_cast<float>(radius)), 1e-6F);
}

TEST(Subdivide, HasLoopsWeightsInsideAndAtBoundaries) {
  const Mesh mesh = triangle_patch(4);
  const Subdivision s = subdivided(mesh, 1);
  const Mesh refined = subdivide(mesh, 1);

  // Valence 6: the weights are 5/8 and six times 1/16. The vertex of a regular patch does not move.
  const std::uint32_t inner = vertex_near(mesh, {2, 2, 0});
  std::map<std::uint32_t, double> weights = stencil(s, vertex_near(refined, {2, 2, 0}));
  EXPECT_EQ(weights.size(), 7U);
  EXPECT_NEAR(weights[inner], 0.625, 1e-12);
  for (const auto& [vertex, weight] : weights) {
    if (vertex == inner) continue;
    EXPECT_NEAR(weight, 0.0625, 1e-12);
  }
  // A boundary vertex has the weights 3/4 and twice 1/8.
  const std::uint32_t edge = vertex_near(mesh, {2, 0, 0});
  weights = stencil(s, vertex_near(refined, {2, 0, 0}));
  EXPECT_EQ(weights, (std::map<std::uint32_t, double>{{edge - 1, 0.125}, {edge, 0.75}, {edge + 1, 0.125}}));
  // The middle of an inner edge has the weights 3/8 for its ends and 1/8 for the opposite vertices.
  weights = stencil(s, vertex_near(refined, {2.25F, 1.5F, 0}));
  std::multiset<double> values;
  for (const auto& [vertex, weight] : weights) values.insert(weight);
  EXPECT_THAT(values, ::testing::ElementsAre(0.125, 0.125, 0.375, 0.375));
  // The new vertex of a boundary edge is its middle.
  weights = stencil(s, vertex_near(refined, {1.5F, 0, 0}));
  EXPECT_EQ(weights, (std::map<std::uint32_t, double>{{edge - 1, 0.5}, {edge, 0.5}}));
}

TEST(Subdivide, FlatMeshesStayFlatAndChildrenLieInTheirParent) {
  const Mesh mesh = triangle_patch(5);
  for (std::uint32_t levels = 1; levels <= 3; ++levels) {
    const Subdivision s = subdivided(mesh, levels);
    const Mesh refined = subdivide(mesh, levels);
    const std::size_t children = std::size_t{1} << (2 * levels);
    for (const Vec3f& p : refined.positions) EXPECT_EQ(p.z, 0);
    // The middle triangle of the patch has only regular neighbours, so its children fill it exactly.
    double area = 0;
    const std::uint32_t middle = s.source[s.source.size() / 2];
    for (std::size_t t = 0; t < refined.triangles.size(); ++t) {
      EXPECT_EQ(s.source[t], t / children);
      if (s.source[t] != middle) continue;
      const auto& [a, b, c] = refined.triangles[t];
      area += cross(to_double(refined.positions[b] - refined.positions[a]),
                    to_double(refined.positions[c] - refined.positions[a]))
                  .z /
              2;
    }
    EXPECT_NEAR(area, 0.5, 0.1);
  }
}

TEST(Subdivide, DoesNotOpenSeams) {
  // An icosphere in which every triangle has its own vertices.
  const Mesh mesh = icosphere_mesh(1);
  Mesh cut;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(cut.positions.size());
    for (const std::uint32_t v : t) cut.positions.push_back(mesh.positions[v]);
    cut.triangles.push_back({first, first + 1, first + 2});
  }
  const Subdivision s = subdivided(cut, 2);
  EXPECT_EQ(s.vertices(), subdivided(mesh, 2).vertices());
  expect_sound(cut, s);
}

TEST(Subdivide, SeparatesATriangleOnAnEdgeOfAClosedMesh) {
  // A tetrahedron and a triangle on one of its edges.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, -1, -1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 1, 4}};
  const Subdivision s = subdivided(mesh, 2);
  expect_sound(mesh, s);
  EXPECT_EQ(s.triangles.size(), 80U);
  // The closed tetrahedron has 2 + 64 / 2 vertices, and the separate triangle has 15.
  EXPECT_EQ(s.vertices(), 34U + 15U);
}

TEST(Subdivide, KeepsALeafModelledTwiceAsTwoSheets) {
  // The front and the back of a hexagon have the same positions but different vertices.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {-1, 2, 0}, {-2, 0, 0}, {-1, -2, 0}, {1, -2, 0}};
  for (std::uint32_t k = 0; k < 6; ++k) mesh.triangles.push_back({0, 1 + k, 1 + (k + 1) % 6});
  Mesh back = mesh;
  for (Triangle& t : back.triangles) std::swap(t[1], t[2]);
  append(mesh, back);
  const Subdivision s = subdivided(mesh, 1);
  expect_sound(mesh, s);
  EXPECT_EQ(s.triangles.size(), 48U);
  // If they are joined along the rim, they are a closed surface with V = 2 + F / 2.
  EXPECT_EQ(s.vertices(), 26U);
}

TEST(Subdivide, CutsAStripWhoseFrontAndBackShareBothRims) {
  // All vertices are on the rim, so both sheets have the same inner edges.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}};
  const Subdivision s = subdivided(mesh, 3);
  expect_sound(mesh, s);
  EXPECT_EQ(s.triangles.size(), 4U * 64U);
}

TEST(Subdivide, CutsAMoebiusStrip) {
  Mesh mesh;
  for (int i = 0; i < 5; ++i) {
    const float x = static_cast<float>(i);
    mesh.positions.push_back({x, 0, x * x});
    mesh.positions.push_back({x, 1, x * x});
  }
  for (std::uint32_t i = 0; i < 5; ++i) {
    const std::uint32_t a = 2 * i, b = a + 1;
    const std::uint32_t c = i == 4 ? 1 : a + 2, d = i == 4 ? 0 : a + 3;
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({b, c, d});
  }
  const Subdivision s = subdivided(mesh, 2);
  expect_sound(mesh, s);
  EXPECT_EQ(s.triangles.size(), 160U);
}

TEST(Subdivide, AcceptsDegenerateTrianglesAndEmptyMeshes) {
  EXPECT_EQ(subdivided(Mesh{}, 3).triangles.size(), 0U);
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}};
  mesh.triangles = {{0, 1, 3}, {0, 1, 2}, {2, 2, 1}};
  const Subdivision s = subdivided(mesh, 1);
  EXPECT_EQ(s.source, (std::vector<std::uint32_t>{1, 1, 1, 1}));
  expect_sound(mesh, s);
  // Three collinear corners are three distinct corners.
  mesh.positions[2] = {2, 0, 0};
  EXPECT_EQ(subdivided(mesh, 1).triangles.size(), 4U);
}

TEST(Subdivide, SplitsRandomTrianglesIntoManifoldPieces) {
  // With few vertices and many triangles, every edge has many triangles, some of them repeated or reversed.
  Random random(3);
  for (int round = 0; round < 300; ++round) {
    const std::uint64_t vertices = 3 + random.below(8);
    Mesh mesh;
    for (std::uint64_t v = 0; v < vertices; ++v) mesh.positions.push_back(to_float(random.direction()));
    for (std::uint64_t v = 0; v < 4; ++v) mesh.positions.push_back(mesh.positions[random.below(vertices)]);
    const std::uint64_t triangles = 1 + random.below(30);
    for (std::uint64_t t = 0; t < triangles; ++t) {
      const auto corner = [&] { return static_cast<std::uint32_t>(random.below(mesh.positions.size())); };
      mesh.triangles.push_back({corner(), corner(), corner()});
    }
    const auto levels = static_cast<std::uint32_t>(random.below(3));
    const Subdivision s = subdivided(mesh, levels);
    expect_sound(mesh, s);
    const std::vector<std::uint32_t> weld = weld_by_position(mesh.positions);
    const auto distinct = std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
      return weld[t[0]] != weld[t[1]] && weld[t[1]] != weld[t[2]] && weld[t[2]] != weld[t[0]];
    });
    EXPECT_EQ(s.triangles.size(), static_cast<std::size_t>(distinct) << (2 * levels));
  }
}

TEST(Subdivide, RejectsTooManyLevelsOrTriangles) {
  const Mesh mesh = icosphere_mesh(0);
  EXPECT_THROW(subdivided(mesh, 4), Error);
  const std::vector<Triangle> many((std::size_t{1} << 22U) + 1, Triangle{0, 0, 0});
  const std::vector<std::uint32_t> weld{0};
  EXPECT_THROW(subdivide_loop(many, weld, 3), Error);
}

}  // namespace
}  // namespace pellucid::testing
