// Tests rasterize(): fragment lists against brute force, shared edges, closed meshes, clipping, culling and
// determinism.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "raster/spans.h"
#include "raster_helpers.h"

namespace pellucid {
namespace {

using testing::fragments_of;
using testing::front_camera;
using testing::random_soup;
using testing::same_bytes;
using testing::wrinkled_sphere;

Camera perspective_camera(const Vec3d& direction, double distance, std::uint32_t size) {
  return look_at_sphere({{0, 0, 0}, 1.0}, {normalized(direction), distance}, size, size);
}

void expect_well_formed(const FragmentBuffer& buffer) {
  ASSERT_EQ(buffer.offsets.size(), std::size_t{buffer.width} * buffer.height + 1);
  ASSERT_EQ(buffer.offsets.front(), 0U);
  ASSERT_EQ(buffer.offsets.back(), buffer.fragments.size());
  for (std::size_t p = 0; p + 1 < buffer.offsets.size(); ++p) {
    ASSERT_LE(buffer.offsets[p], buffer.offsets[p + 1]);
    const std::span<const Fragment> list = buffer.pixel(p);
    for (std::size_t i = 0; i < list.size(); ++i) {
      ASSERT_GE(list[i].depth, 0.0F);
      ASSERT_LE(list[i].depth, 1.0F);
      if (i == 0) continue;
      ASSERT_TRUE(list[i - 1].depth < list[i].depth ||
                  (list[i - 1].depth == list[i].depth && list[i - 1].node < list[i].node))
          << "pixel " << p;
    }
  }
}

// The reference tests every triangle at every pixel centre, with its own projection, snapping and barycentric
// depth.
struct BruteFragment {
  double depth;
  std::uint32_t node;
};
std::vector<std::vector<BruteFragment>> brute_force(const Mesh& mesh, const Camera& camera) {
  std::vector<std::vector<BruteFragment>> pixels(std::size_t{camera.width} * camera.height);
  struct Corner {
    double x, y, depth;
    std::int64_t fx, fy;
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Corner, 3> c{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d p = to_double(mesh.positions[mesh.triangles[t][k]]) - camera.eye;
      const double z = dot(p, camera.forward);
      const double w = camera.perspective ? z : 1.0;
      const double pixels_per_unit = camera.height / (2.0 * camera.half_height);
      c[k].x = camera.width / 2.0 + dot(p, camera.right) / w * pixels_per_unit;
      c[k].y = camera.height / 2.0 - dot(p, camera.up) / w * pixels_per_unit;
      c[k].depth = camera.perspective
                       ? (1 / camera.near_plane - 1 / z) / (1 / camera.near_plane - 1 / camera.far_plane)
                       : (z - camera.near_plane) / (camera.far_plane - camera.near_plane);
      c[k].fx = std::llround(std::floor(c[k].x * 256 + 0.5));
      c[k].fy = std::llround(std::floor(c[k].y * 256 + 0.5));
    }
    const auto side = [](const Corner& a, const Corner& b, std::int64_t x, std::int64_t y) {
      return (b.fx - a.fx) * (y - a.fy) - (x - a.fx) * (b.fy - a.fy);
    };
    const std::int64_t area = side(c[0], c[1], c[2].fx, c[2].fy);
    if (area == 0) continue;
    const std::uint32_t node = 2 * static_cast<std::uint32_t>(t) + (area > 0 ? 1 : 0);
    if (area < 0) std::swap(c[1], c[2]);
    const double exact_area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (c[1].y - c[0].y);
    const auto [low, high] = std::minmax({c[0].depth, c[1].depth, c[2].depth});
    for (std::uint32_t py = 0; py < camera.height; ++py) {
      for (std::uint32_t px = 0; px < camera.width; ++px) {
        bool inside = true;
        for (std::size_t k = 0; k < 3 && inside; ++k) {
          const Corner& a = c[k];
          const Corner& b = c[(k + 1) % 3];
          const std::int64_t e = side(a, b, 256 * std::int64_t{px} + 128, 256 * std::int64_t{py} + 128);
          inside = e > 0 || (e == 0 && (b.fy < a.fy || (b.fy == a.fy && b.fx > a.fx)));
        }
        if (!inside) continue;
        const double x = px + 0.5, y = py + 0.5;
        const double w1 = ((x - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (y - c[0].y)) / exact_area;
        const double w2 = ((c[1].x - c[0].x) * (y - c[0].y) - (x - c[0].x) * (c[1].y - c[0].y)) / exact_area;
        const double depth = c[0].depth + w1 * (c[1].depth - c[0].depth) + w2 * (c[2].depth - c[0].depth);
        pixels[std::size_t{py} * camera.width + px].push_back({std::clamp(depth, low, high), node});
      }
    }
  }
  for (auto& list : pixels) {
    std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.node < b.node; });
  }
  return pixels;
}

void expect_equals_brute_force(const Mesh& mesh, const Camera& camera) {
  const FragmentBuffer buffer = fragments_of(mesh, camera);
  expect_well_formed(buffer);
  const auto expected = brute_force(mesh, camera);
  for (std::size_t p = 0; p < expected.size(); ++p) {
    std::vector<Fragment> actual(buffer.pixel(p).begin(), buffer.pixel(p).end());
    std::sort(actual.begin(), actual.end(), [](const auto& a, const auto& b) { return a.node < b.node; });
    ASSERT_EQ(actual.size(), expected[p].size()) << "pixel " << p;
    for (std::size_t i = 0; i < actual.size(); ++i) {
      ASSERT_EQ(actual[i].node, expected[p][i].node) << "pixel " << p;
      ASSERT_NEAR(actual[i].depth, expected[p][i].depth, 1e-7) << "pixel " << p;
    }
  }
}

TEST(Rasterize, LeavesEveryPixelOfAnEmptyMeshEmpty) {
  const FragmentBuffer buffer = fragments_of({}, front_camera(5, 3));
  expect_well_formed(buffer);
  EXPECT_EQ(buffer.fragments.size(), 0U);
  EXPECT_EQ(buffer.covered_pixels(), 0U);
}

TEST(Rasterize, MatchesOneTriangleByHand) {
  // The triangle covers the lower left half of a 4 x 4 image without the diagonal.
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0.5F}, {-1, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const FragmentBuffer buffer = fragments_of(mesh, front_camera(4, 4));
  expect_well_formed(buffer);
  const std::vector<std::uint64_t> expected{0, 0, 0, 0,  //
                                            1, 0, 0, 0,  //
                                            1, 1, 0, 0,  //
                                            1, 1, 1, 0};
  for (std::size_t p = 0; p < 16; ++p) EXPECT_EQ(buffer.pixel(p).size(), expected[p]) << p;
  EXPECT_EQ(buffer.covered_pixels(), 6U);
  // The depth is (1 - z) / 2 with z = (x + 1) / 4.
  EXPECT_FLOAT_EQ(buffer.pixel(12)[0].depth, 0.5F - 0.25F * 0.125F);
  EXPECT_FLOAT_EQ(buffer.pixel(14)[0].depth, 0.5F - 0.25F * 0.625F);
  EXPECT_EQ(buffer.pixel(12)[0].node, 0U);

  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
  EXPECT_EQ(fragments_of(mesh, front_camera(4, 4)).pixel(12)[0].node, 1U);
}

TEST(Rasterize, EqualsBruteForceOnRandomTriangles) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const double size = seed % 2 == 0 ? 0.1 : 0.6;
    const Mesh mesh = random_soup(150, size / std::sqrt(3.0) * 0.9, seed, 0.4);
    Random random(seed);
    expect_equals_brute_force(
        mesh, perspective_camera(random.direction(), 2.0 + 0.5 * static_cast<double>(seed), 61));
    expect_equals_brute_force(mesh, perspective_camera(random.direction(), kInfiniteDistance, 48));
  }
  // These triangles are larger than the 32-bit kernel accepts.
  expect_equals_brute_force(random_soup(12, 0.4, 99, 0.3), perspective_camera({1, 2, 3}, 3, 300));
}

// Moves the vertices of a square grid at random without reversing any triangle.
Mesh jittered_plane(std::uint32_t cells, std::uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  for (std::uint32_t j = 0; j <= cells; ++j) {
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const double jitter = i == 0 || j == 0 || i == cells || j == cells ? 0.0 : 0.3 / cells;
      mesh.positions.push_back(
          to_float(Vec3d{2.0 * i / cells - 1 + random.uniform(-jitter, jitter),
                         2.0 * j / cells - 1 + random.uniform(-jitter, jitter), random.uniform(-0.2, 0.2)}));
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return j * (cells + 1) + i; };
  for (std::uint32_t j = 0; j < cells; ++j) {
    for (std::uint32_t i = 0; i < cells; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

TEST(Rasterize, CoversEveryPixelOfATriangulatedPlaneOnce) {
  // The sizes range from a few huge triangles to triangles smaller than a pixel.
  for (const std::uint32_t cells : {1U, 3U, 16U, 64U, 200U}) {
    const FragmentBuffer buffer = fragments_of(jittered_plane(cells, cells), front_camera(128, 128));
    expect_well_formed(buffer);
    for (std::size_t p = 0; p < 128 * 128; ++p)
      ASSERT_EQ(buffer.pixel(p).size(), 1U) << cells << " pixel " << p;
  }
}

TEST(Rasterize, LeavesNoCracksInAClippedPlane) {
  // The plane crosses the near plane and extends beyond the guard band on both sides.
  Mesh mesh = jittered_plane(12, 5);
  for (Vec3f& p : mesh.positions) p = {p.x * 1e4F, -0.3F, p.y * 1e4F};
  Camera camera = perspective_camera({0, 0, 1}, 0.5, 128);
  camera.far_plane = 1e9;
  const FragmentBuffer buffer = fragments_of(mesh, camera);
  expect_well_formed(buffer);
  for (std::uint32_t y = 0; y < 128; ++y) {
    for (std::uint32_t x = 0; x < 128; ++x) {
      const std::size_t p = std::size_t{y} * 128 + x;
      // The plane covers centres at least half a pixel below the horizon (height / 2).
      ASSERT_EQ(buffer.pixel(p).size(), y >= 65 ? 1U : (y < 63 ? 0U : buffer.pixel(p).size()))
          << x << "," << y;
      if (y < 65) continue;
      const double slope = (y + 0.5 - 64) / 64 * camera.half_height;
      const double z = 0.3 / slope;
      const double expected =
          (1 / camera.near_plane - 1 / z) / (1 / camera.near_plane - 1 / camera.far_plane);
      ASSERT_NEAR(buffer.pixel(p)[0].depth, expected, 2e-7);
    }
  }
}

TEST(Rasterize, SeesAsManyFrontsAsBacksOfAClosedMesh) {
  const Mesh mesh = wrinkled_sphere(60, 0.2);
  Random random(3);
  for (int i = 0; i < 12; ++i) {
    const double distance = i % 4 == 3 ? kInfiniteDistance : random.uniform(1.5, 5.0);
    const FragmentBuffer buffer = fragments_of(mesh, perspective_camera(random.direction(), distance, 200));
    expect_well_formed(buffer);
    EXPECT_GT(buffer.covered_pixels(), 5000U);
    for (std::size_t p = 0; p < 200 * 200; ++p) {
      std::int64_t fronts = 0;
      for (const Fragment& f : buffer.pixel(p)) fronts += (f.node & 1U) == 0 ? 1 : -1;
      ASSERT_EQ(fronts, 0) << "frame " << i << " pixel " << p;
    }
  }
}

TEST(Rasterize, SeesOneMoreBackFromInsideAClosedMesh) {
  const Mesh mesh = wrinkled_sphere(40, 0.1);
  const Camera camera = perspective_camera({0.3, 0.5, -1}, 0.3, 150);
  const FragmentBuffer buffer = fragments_of(mesh, camera);
  expect_well_formed(buffer);
  for (std::size_t p = 0; p < 150 * 150; ++p) {
    std::int64_t backs = 0;
    for (const Fragment& f : buffer.pixel(p)) backs += (f.node & 1U) == 1 ? 1 : -1;
    ASSERT_EQ(backs, 1) << p;
  }
}

TEST(Rasterize, ClipsAtTheNearAndFarPlanes) {
  // The slope runs from z = 0.9 to z = -0.9. The planes at distances 0.5 and 1.5 keep its middle, |z| <= 0.5.
  Mesh mesh;
  mesh.positions = {{-1, -1, 0.9F}, {1, -1, -0.9F}, {1, 1, -0.9F}, {-1, 1, 0.9F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  Camera camera = front_camera(180, 180);
  camera.near_plane = 0.5;
  camera.far_plane = 1.5;
  const FragmentBuffer buffer = fragments_of(mesh, camera);
  expect_well_formed(buffer);
  for (std::uint32_t y = 0; y < 180; ++y) {
    for (std::uint32_t x = 0; x < 180; ++x) {
      const double z = 0.9 - 0.01 * (x + 0.5);
      ASSERT_EQ(buffer.pixel(std::size_t{y} * 180 + x).size(), std::abs(z) < 0.5 ? 1U : 0U) << x << "," << y;
      if (std::abs(z) >= 0.5) continue;
      ASSERT_NEAR(buffer.pixel(std::size_t{y} * 180 + x)[0].depth, 0.5 - z, 1e-6);
    }
  }
}

TEST(Rasterize, BackCullingKeepsExactlyTheFrontFragments) {
  const Mesh mesh = random_soup(300, 0.3, 21, 0.5);
  const Camera camera = perspective_camera({1, -1, 0.5}, 2.5, 96);
  const FragmentBuffer all = fragments_of(mesh, camera);
  const FragmentBuffer culled = fragments_of(mesh, camera, Culling::back);
  expect_well_formed(culled);
  for (std::size_t p = 0; p < 96 * 96; ++p) {
    std::vector<std::uint32_t> expected;
    for (const Fragment& f : all.pixel(p)) {
      if ((f.node & 1U) == 0) expected.push_back(f.node);
    }
    std::vector<std::uint32_t> actual;
    for (const Fragment& f : culled.pixel(p)) actual.push_back(f.node);
    ASSERT_EQ(actual, expected) << p;
  }
}

TEST(Rasterize, GivesTheSameBytesForAnyThreadsAndReusedBuffers) {
  const Mesh mesh = random_soup(40000, 0.03, 33, 0.8);
  const Camera camera = perspective_camera({0.2, 0.9, 0.4}, 2.2, 333);
  FragmentBuffer reference;
  {
    const ThreadLimit one(1);
    rasterize(mesh, camera, {}, reference);
  }
  expect_well_formed(reference);
  EXPECT_GT(reference.fragments.size(), 100000U);
  FragmentBuffer reused;
  rasterize(wrinkled_sphere(30, 0.3), perspective_camera({1, 0, 0}, 2, 500), {}, reused);
  for (const unsigned threads : {2U, 8U}) {
    const ThreadLimit limit(threads);
    rasterize(mesh, camera, {}, reused);
    EXPECT_TRUE(same_bytes(reference, reused)) << threads;
  }
}

TEST(Rasterize, CopiesOfABufferDoNotShareMemory) {
  const Mesh mesh = wrinkled_sphere(20, 0.2);
  FragmentBuffer first;
  rasterize(mesh, perspective_camera({1, 0, 0}, 3, 64), {}, first);
  FragmentBuffer second = first;
  rasterize(mesh, perspective_camera({0, 1, 0}, 3, 64), {}, second);
  EXPECT_NE(first.memory, second.memory);
  EXPECT_TRUE(same_bytes(first, fragments_of(mesh, perspective_camera({1, 0, 0}, 3, 64))));
}

TEST(Rasterize, DoesNotDependOnTheOrderOfTriangles) {
  Mesh mesh = random_soup(500, 0.3, 77, 0.5);
  const Camera camera = perspective_camera({1, 1, 1}, 3, 80);
  const FragmentBuffer before = fragments_of(mesh, camera);
  std::reverse(mesh.triangles.begin(), mesh.triangles.end());
  const FragmentBuffer after = fragments_of(mesh, camera);
  ASSERT_EQ(before.offsets, after.offsets);
  for (std::size_t i = 0; i < before.fragments.size(); ++i) {
    // Fragments of equal depth may be swapped, because their nodes have other ids now.
    ASSERT_EQ(before.fragments[i].depth, after.fragments[i].depth);
  }
}

TEST(Rasterize, IgnoresInvalidTriangles) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  const float huge = std::numeric_limits<float>::max();
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {nan, 0, 0}, {0, 1, 0}, {1, infinite, 0}, {1, 0, 0}, {0.5F, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 4, 3}, {0, 4, 5}, {0, 0, 2}};
  for (const double distance : {3.0, 0.5, kInfiniteDistance}) {
    const FragmentBuffer buffer = fragments_of(mesh, perspective_camera({0, 0, 1}, distance, 50));
    expect_well_formed(buffer);
    EXPECT_EQ(buffer.fragments.size(), 0U);
  }
  // A huge triangle is valid. It covers the quarter x > 0, y > 0.
  mesh.positions = {{0, 0, 0}, {huge, 0, 0}, {0, huge, 0}};
  mesh.triangles = {{0, 1, 2}};
  const FragmentBuffer buffer = fragments_of(mesh, perspective_camera({0, 0, 1}, 3, 50));
  expect_well_formed(buffer);
  EXPECT_EQ(buffer.covered_pixels(), 25U * 25U);
}

TEST(Rasterize, KeepsDepthsOfGrazingSliversInRange) {
  // The depth gradients of nearly edge-on triangles are huge, but the depths of their fragments must not be.
  Random random(5);
  Mesh mesh;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const double x = random.uniform(-0.7, 0.7);
    const double y = random.uniform(-0.7, 0.7);
    const double z = random.uniform(-0.5, 0.4);
    mesh.positions.push_back(to_float(Vec3d{x, y, z}));
    mesh.positions.push_back(to_float(Vec3d{x + 0.1, y + 0.2, z}));
    mesh.positions.push_back(to_float(Vec3d{x + 0.05 + random.uniform(2e-5, 2e-4), y + 0.1, z + 0.1}));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const FragmentBuffer buffer = fragments_of(mesh, front_camera(256, 256));
  ASSERT_GT(buffer.fragments.size(), 500U);
  for (const Fragment& f : buffer.fragments) {
    const double z = mesh.positions[mesh.triangles[f.node / 2][0]].z;
    EXPECT_LE(f.depth, (1 - z) / 2 + 1e-6);
    EXPECT_GE(f.depth, (1 - z - 0.1) / 2 - 1e-6);
  }
}

TEST(Rasterize, DepthsAgreeOnTheEdgeOfTwoTriangles) {
  // The ridge of a roof runs along a row of pixel centres, with one triangle above and one below.
  // Extrapolating each of them by a pixel must give the depth of the ridge.
  Mesh mesh;
  mesh.positions = {{-0.9F, 0.011F, 0.31F}, {0.83F, 0.013F, -0.22F}, {0.1F, 0.9F, 0.7F}, {0.2F, -0.8F, 0.5F}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
  const Camera camera = perspective_camera({0, 0, 1}, 2.5, 512);
  const FragmentBuffer buffer = fragments_of(mesh, camera);
  std::size_t seen = 0;
  for (std::uint32_t x = 0; x < 512; ++x) {
    for (std::uint32_t y = 3; y + 4 < 512; ++y) {
      const auto at = [&](std::uint32_t row) { return buffer.pixel(std::size_t{row} * 512 + x); };
      bool steep = false;
      for (std::uint32_t row = y - 2; row <= y + 3; ++row) steep = steep || at(row).size() != 1;
      if (steep || at(y)[0].node == at(y + 1)[0].node) continue;
      // The lines through the rows above and below meet at the ridge, between the rows y and y + 1.
      const double above = double{at(y)[0].depth} - double{at(y - 1)[0].depth};
      const double below = double{at(y + 2)[0].depth} - double{at(y + 1)[0].depth};
      const double crossing = (double{at(y + 1)[0].depth} - below - double{at(y)[0].depth}) / (above - below);
      EXPECT_GT(crossing, -0.01) << x;
      EXPECT_LT(crossing, 1.01) << x;
      ++seen;
    }
  }
  EXPECT_GT(seen, 200U);
}

TEST(Rasterize, RejectsInvalidCamerasAndImageSizes) {
  const auto kind_of = [](const Camera& camera) {
    try {
      fragments_of({}, camera);
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::internal;
  };
  EXPECT_EQ(kind_of(front_camera(0, 5)), ErrorKind::bad_argument);
  EXPECT_EQ(kind_of(front_camera(5, 0)), ErrorKind::bad_argument);
  EXPECT_EQ(kind_of(front_camera(1U << 15U, 1U << 14U)), ErrorKind::bad_argument);
  EXPECT_EQ(kind_of(front_camera((1U << 20U) + 1, 1)), ErrorKind::bad_argument);
  Camera behind = front_camera(5, 5);
  behind.perspective = true;
  EXPECT_EQ(kind_of(behind), ErrorKind::bad_argument);
}

TEST(SortFragments, EqualsTheStandardSortForEveryLength) {
  Random random(11);
  for (std::size_t length = 0; length <= 60; ++length) {
    for (int repeat = 0; repeat < 50; ++repeat) {
      std::vector<Fragment> list(length);
      for (Fragment& f : list) {
        f = {static_cast<float>(random.below(8)) / 8.0F, static_cast<std::uint32_t>(random.below(1000000))};
      }
      std::vector<Fragment> expected = list;
      std::sort(expected.begin(), expected.end(), [](const Fragment& a, const Fragment& b) {
        return a.depth != b.depth ? a.depth < b.depth : a.node < b.node;
      });
      raster::sort_fragments(list);
      for (std::size_t i = 0; i < length; ++i) {
        ASSERT_EQ(list[i].depth, expected[i].depth);
        ASSERT_EQ(list[i].node, expected[i].node);
      }
    }
  }
}

}  // namespace
}  // namespace pellucid
