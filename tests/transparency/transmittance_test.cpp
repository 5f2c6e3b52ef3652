// Tests the light that reaches faces against stacks of squares with known answers.
#include <gtest/gtest.h>

#include <cmath>

#include "order_helpers.h"
#include "transparency/graph/viewpoint_edges.h"

namespace pellucid {
namespace {

using testing::EdgeMap;

constexpr double kAlpha = 0.4;

// A square [-half, half]^2 at height z, facing +z, its diagonal turned a little from step to step so that no
// two diagonals coincide. Four triangles around the middle.
void add_square(Mesh& mesh, double half, double z, double x = 0, double y = 0) {
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  const auto put = [&](double px, double py) { mesh.positions.push_back(to_float(Vec3d{px, py, z})); };
  put(x - half, y - half);
  put(x + half, y - half);
  put(x + half, y + half);
  put(x - half, y + half);
  put(x + 0.1 * half, y + 0.05 * half);
  for (std::uint32_t k = 0; k < 4; ++k) mesh.triangles.push_back({base + k, base + (k + 1) % 4, base + 4});
}

double area_of(const Mesh& mesh, std::uint32_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3d a = to_double(mesh.positions[t[0]]);
  return 0.5 * length(cross(to_double(mesh.positions[t[1]]) - a, to_double(mesh.positions[t[2]]) - a));
}

OcclusionScene faint_scene_of(const Mesh& mesh, double alpha) {
  OcclusionScene scene{mesh, bounding_sphere(mesh), {}, false, 0, 512, alpha};
  scene.positions = unit_positions(mesh, scene.sphere);
  return scene;
}

using EdgeFinder = void (*)(const OcclusionScene&, const Viewpoint&, OcclusionScratch&, ViewpointEdges&);

EdgeMap edges_of(const Mesh& mesh, double alpha, const Viewpoint& viewpoint, EdgeFinder find) {
  const OcclusionScene scene = faint_scene_of(mesh, alpha);
  OcclusionScratch scratch;
  ViewpointEdges edges;
  find(scene, viewpoint, scratch, edges);
  EdgeMap map;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::uint32_t i = edges.offsets[t]; i < edges.offsets[t + 1]; ++i)
      map[{node_of(t, edges.front_flipped[t] != 0), edges.backs[i]}] = static_cast<double>(edges.areas[i]);
  }
  return map;
}

TEST(Transmittance, AStackWeighsEveryLayerByWhatIsInFront) {
  // Five equal squares behind each other: from +z the sheet n from the top has n in front.
  Mesh mesh;
  for (int sheet = 0; sheet < 5; ++sheet) add_square(mesh, 0.6, 0.3 - 0.15 * sheet);
  for (const EdgeFinder find : {&find_edges_exactly, &find_edges_by_raster}) {
    const Viewpoint above{{0, 0, 1}, kInfiniteDistance};
    const EdgeMap areas = edges_of(mesh, 0, above, find);
    const EdgeMap visible = edges_of(mesh, kAlpha, above, find);
    ASSERT_EQ(areas.size(), visible.size());
    ASSERT_GE(areas.size(), 16U);
    for (const auto& [pair, area] : areas) {
      const auto layers_in_front = static_cast<int>(triangle_of(pair.first) / 4);
      EXPECT_NEAR(visible.at(pair) / area, std::pow(1 - kAlpha, layers_in_front), 1e-5) << layers_in_front;
    }
  }
}

TEST(Transmittance, TheOtherSideSeesTheStackFromBelow) {
  Mesh mesh;
  for (int sheet = 0; sheet < 4; ++sheet) add_square(mesh, 0.6, 0.3 - 0.15 * sheet);
  // In perspective the sheets differ in size: what the nearer ones do not cover gets more light, never less.
  const Viewpoint below{{0, 0, -1}, 3};
  const EdgeMap areas = edges_of(mesh, 0, below, &find_edges_exactly);
  const EdgeMap visible = edges_of(mesh, kAlpha, below, &find_edges_exactly);
  for (const auto& [pair, area] : areas) {
    EXPECT_TRUE(is_flipped(pair.first));
    const int layers_in_front = 3 - static_cast<int>(triangle_of(pair.first) / 4);
    EXPECT_NEAR(visible.at(pair) / area, std::pow(1 - kAlpha, layers_in_front), 0.02) << layers_in_front;
  }
}

TEST(Transmittance, HalfCoveredIsTheMeanOfBoth) {
  // A tile covers a quarter of the square below it, [0, 0.6]^2 of [-0.6, 0.6]^2, and so a known share of each
  // of its triangles.
  Mesh mesh;
  add_square(mesh, 0.6, 0.0);
  add_square(mesh, 0.3, 0.3, 0.3, 0.3);
  add_square(mesh, 0.6, -0.3);
  const EdgeMap areas = edges_of(mesh, 0, {{0, 0, 1}, kInfiniteDistance}, &find_edges_exactly);
  const EdgeMap visible = edges_of(mesh, kAlpha, {{0, 0, 1}, kInfiniteDistance}, &find_edges_exactly);
  const double radius = bounding_sphere(mesh).radius;
  for (std::uint32_t t = 0; t < 4; ++t) {
    // Exact overlaps say which share of triangle t of the middle square lies below the tile.
    double covered = 0;
    for (std::uint32_t tile = 4; tile < 8; ++tile) {
      const auto edge = areas.find({node_of(tile, false), node_of(t, false)});
      if (edge != areas.end()) covered += edge->second;
    }
    const double share = covered / (area_of(mesh, t) / (radius * radius));
    for (const auto& [pair, area] : areas) {
      if (pair.first != node_of(t, false)) continue;
      EXPECT_NEAR(visible.at(pair) / area, 1 - share * kAlpha, 0.02) << "triangle " << t;
    }
  }
}

TEST(Transmittance, TrianglesBetweenPixelsLookAtTheirPlace) {
  // Squares far smaller than a pixel, in front of all, between the sheets, and behind all.
  Mesh mesh;
  add_square(mesh, 0.6, 0.2);
  add_square(mesh, 0.6, -0.2);
  const double size = 1e-4;
  add_square(mesh, size, 0.4, 0.11, 0.07);
  add_square(mesh, size, 0.0, 0.11, 0.07);
  add_square(mesh, size, -0.4, 0.11, 0.07);
  const OcclusionScene scene = faint_scene_of(mesh, kAlpha);
  const Viewpoint above{{0, 0, 1}, 4};
  ScreenTriangles screen;
  project_triangles(scene.positions, mesh.triangles, above, false, screen);
  FragmentBuffer fragments;
  std::vector<float> light;
  find_light(scene, above, screen, fragments, light);
  for (std::uint32_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(light[8 + k], 1, 1e-6);
    EXPECT_NEAR(light[12 + k], 1 - kAlpha, 1e-6);
    EXPECT_NEAR(light[16 + k], (1 - kAlpha) * (1 - kAlpha), 1e-6);
  }
}

TEST(Transmittance, IsWithinBoundsOnAnyMesh) {
  const Mesh mesh = testing::random_soup(150, 0.4, 8);
  const Viewpoint viewpoint{normalized(Vec3d{0.3, 0.8, -0.4}), 2};
  const EdgeMap areas = edges_of(mesh, 0, viewpoint, &find_edges_exactly);
  const EdgeMap visible = edges_of(mesh, kAlpha, viewpoint, &find_edges_exactly);
  ASSERT_EQ(areas.size(), visible.size());
  bool some_less = false;
  for (const auto& [pair, area] : areas) {
    EXPECT_GT(visible.at(pair), 0);
    EXPECT_LE(visible.at(pair), area * (1 + 1e-6));
    some_less = some_less || visible.at(pair) < 0.7 * area;
  }
  EXPECT_TRUE(some_less);
}

TEST(Transmittance, OpaqueFacesHideAllErrorsBehindThem) {
  Mesh mesh;
  for (int sheet = 0; sheet < 3; ++sheet) add_square(mesh, 0.6, 0.3 - 0.2 * sheet);
  const EdgeMap visible = edges_of(mesh, 1, {{0, 0, 1}, kInfiniteDistance}, &find_edges_exactly);
  for (const auto& [pair, weight] : visible) {
    if (triangle_of(pair.first) < 4) {
      EXPECT_GT(weight, 0);
    } else {
      EXPECT_EQ(weight, 0);
    }
  }
}

}  // namespace
}  // namespace pellucid
