// Tests select.h: the descent against brute force, the table against the descent, and cameras against
// matrices.
#include "pellucid/runtime/select.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "pellucid/view.h"
#include "runtime_helpers.h"

namespace pellucid {
namespace {

using testing::Direction;
using testing::kInfinity;
using testing::kNaN;
using testing::to_array;

// The inward edge normals of all triangles of a level, from make_icosphere(). This reference shares no code
// with the descent.
class BruteForce {
 public:
  explicit BruteForce(std::uint32_t level) : sphere_(make_icosphere(level)) {
    for (const auto& triangle : sphere_.triangles) {
      std::array<Vec3d, 3> planes;
      for (std::size_t k = 0; k < 3; ++k) {
        planes[k] = normalized(cross(sphere_.vertices[triangle[k]], sphere_.vertices[triangle[(k + 1) % 3]]));
      }
      planes_.push_back(planes);
    }
  }
  // Returns how far a unit direction is inside triangle t, as the sine of the angle to the nearest border.
  [[nodiscard]] double depth(std::uint32_t t, const Vec3d& d) const {
    return std::min({dot(planes_[t][0], d), dot(planes_[t][1], d), dot(planes_[t][2], d)});
  }
  // Returns the triangle with the lowest id that contains d within 1e-12.
  [[nodiscard]] std::uint32_t find(const Vec3d& d) const {
    for (std::uint32_t t = 0; t < planes_.size(); ++t) {
      if (depth(t, d) >= -PELLUCID_BORDER) return t;
    }
    return 0;
  }
  [[nodiscard]] const Icosphere& sphere() const { return sphere_; }

 private:
  Icosphere sphere_;
  std::vector<std::array<Vec3d, 3>> planes_;
};

// A table that owns its memory.
struct OwnedTable {
  std::vector<PellucidTableCell> cells;
  std::vector<std::uint32_t> grid;
  PellucidTable table{};

  OwnedTable(std::uint32_t level, std::uint32_t theta_steps, std::uint32_t phi_steps)
      : cells(pellucid_triangle_count(level)), grid(std::size_t{theta_steps} * phi_steps) {
    table = {level, theta_steps, phi_steps, cells.data(), grid.data()};
    pellucid_table_build(&table);
  }
  [[nodiscard]] std::uint32_t find(const Vec3d& d) const {
    return pellucid_table_find(&table, to_array(d).data());
  }
};

std::uint32_t descend(std::uint32_t level, const Vec3d& d) {
  return pellucid_find_triangle(level, to_array(d).data());
}

TEST(Descent, AgreesWithBruteForceOnAMillionDirections) {
  const BruteForce reference(2);
  Random random(1);
  for (int i = 0; i < 1000000; ++i) {
    const Vec3d d = random.direction();
    ASSERT_EQ(descend(2, d), reference.find(d)) << d.x << ' ' << d.y << ' ' << d.z;
  }
}

TEST(Descent, AgreesWithFindCellBruteForce) {
  for (std::uint32_t level = 0; level <= 3; ++level) {
    const ViewPartition partition = make_partition({PartitionKind::sampled_triangles, level, 0});
    Random random(level);
    for (int i = 0; i < 5000; ++i) {
      const Vec3d d = random.direction() * random.uniform(1e-3, 1e3);
      ASSERT_EQ(descend(level, d), find_cell_brute_force(partition, d));
    }
  }
}

// At every level, the found triangle contains the direction and has the corners of make_icosphere().
TEST(Descent, ContainsTheDirectionOnEveryLevel) {
  for (std::uint32_t level = 0; level <= PELLUCID_MAX_LEVEL; ++level) {
    const BruteForce reference(level);
    Random random(level + 100);
    for (int i = 0; i < 20000; ++i) {
      const Vec3d d = random.direction();
      const std::uint32_t found = descend(level, d);
      ASSERT_LT(found, pellucid_triangle_count(level));
      ASSERT_GE(reference.depth(found, d), -2 * PELLUCID_BORDER);
    }
  }
}

TEST(Descent, HasExactlyTheCornersOfTheIcosphere) {
  for (std::uint32_t level = 0; level <= 5; ++level) {
    const Icosphere sphere = make_icosphere(level);
    for (std::uint32_t t = 0; t < sphere.triangles.size(); ++t) {
      double corners[3][3];
      pellucid_triangle_corners(level, t, corners);
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d corner{corners[k][0], corners[k][1], corners[k][2]};
        ASSERT_EQ(corner, sphere.vertices[sphere.triangles[t][k]]);
      }
    }
  }
}

// Vertices, edge middles and directions within rounding of them belong to the adjacent triangle with the
// lowest id.
TEST(Descent, GivesBordersToTheLowestId) {
  constexpr std::uint32_t kLevel = 2;
  const BruteForce reference(kLevel);
  const Icosphere finer = make_icosphere(kLevel + 1);
  for (const Vec3d& v : finer.vertices) {
    ASSERT_EQ(descend(kLevel, v), reference.find(v));
    for (const double wiggle : {1e-16, -1e-16, 3e-16}) {
      const Vec3d moved = normalized(v + Vec3d{wiggle, -wiggle, wiggle});
      ASSERT_EQ(descend(kLevel, moved), reference.find(v));
    }
  }
  // Points along all edges, computed independently of the subdivision.
  const Icosphere& sphere = reference.sphere();
  for (const auto& [a, b, c] : sphere.triangles) {
    for (const double u : {0.1, 0.37, 0.5, 0.93}) {
      const Vec3d d = normalized(sphere.vertices[a] * u + sphere.vertices[b] * (1 - u));
      ASSERT_EQ(descend(kLevel, d), reference.find(d));
    }
  }
}

TEST(Descent, AcceptsAnyLengthAndInvalidDirections) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d d = random.direction();
    const std::uint32_t expected = descend(4, d);
    for (const double scale : {1e-300, 1e-30, 7.0, 1e30, 1e300}) EXPECT_EQ(descend(4, d * scale), expected);
  }
  EXPECT_LT(descend(8, {5e-324, 0, 0}), pellucid_triangle_count(8));
  EXPECT_LT(descend(8, {1.7e308, 1.7e308, 1.7e308}), pellucid_triangle_count(8));
  for (const Vec3d& d :
       {Vec3d{0, 0, 0}, Vec3d{-0.0, 0, 0}, Vec3d{kNaN, 1, 1}, Vec3d{1, kNaN, 1}, Vec3d{1, 1, kNaN},
        Vec3d{kInfinity, 0, 0}, Vec3d{0, -kInfinity, 1}, Vec3d{kNaN, kNaN, kNaN}}) {
    EXPECT_EQ(descend(3, d), 0U);
    EXPECT_EQ(pellucid_find_corner(3, to_array(d).data()), 0U);
  }
}

TEST(Corners, AreTheNearestVertexOfTheWholeSphere) {
  for (std::uint32_t level = 0; level <= 3; ++level) {
    const ViewPartition partition = make_partition({PartitionKind::viewpoints, level, 0});
    Random random(level + 7);
    for (int i = 0; i < 20000; ++i) {
      const Vec3d d = random.direction();
      const std::uint32_t corner = pellucid_find_corner(level, to_array(d).data());
      ASSERT_LT(corner, partition.corner_cells.size());
      ASSERT_EQ(partition.corner_cells[corner], find_cell_brute_force(partition, d));
    }
  }
}

class TableOfSize : public ::testing::TestWithParam<std::array<std::uint32_t, 3>> {};
INSTANTIATE_TEST_SUITE_P(
    Sizes, TableOfSize,
    ::testing::Values(std::array<std::uint32_t, 3>{0, 4, 8}, std::array<std::uint32_t, 3>{2, 16, 32},
                      std::array<std::uint32_t, 3>{2, 1, 1},  // too coarse for the one-ring
                      std::array<std::uint32_t, 3>{3, 100, 37}, std::array<std::uint32_t, 3>{4, 64, 128}));

TEST_P(TableOfSize, AgreesWithTheDescent) {
  const auto& [level, theta_steps, phi_steps] = GetParam();
  const OwnedTable owned(level, theta_steps, phi_steps);
  Random random(9);
  for (int i = 0; i < 200000; ++i) {
    const Vec3d d = random.direction();
    ASSERT_EQ(owned.find(d), descend(level, d));
  }
  for (const Vec3d& v : make_icosphere(level + 1).vertices) ASSERT_EQ(owned.find(v), descend(level, v));
  for (const Vec3d& axis : {Vec3d{0, 0, 1}, Vec3d{0, 0, -1}, Vec3d{-1, 0, 0}, Vec3d{-1, -0.0, 0},
                            Vec3d{0, 0, 0}, Vec3d{kNaN, 0, 0}}) {
    EXPECT_EQ(owned.find(axis), descend(level, axis));
  }
}

TEST(Table, RingsContainAllTrianglesThatShareACorner) {
  constexpr std::uint32_t kLevel = 3;
  const OwnedTable owned(kLevel, 8, 16);
  const Icosphere sphere = make_icosphere(kLevel);
  std::vector<std::vector<std::uint32_t>> around(sphere.vertices.size());
  for (std::uint32_t t = 0; t < sphere.triangles.size(); ++t) {
    for (const std::uint32_t v : sphere.triangles[t]) around[v].push_back(t);
  }
  for (std::uint32_t t = 0; t < sphere.triangles.size(); ++t) {
    std::vector<std::uint32_t> expected;
    for (const std::uint32_t v : sphere.triangles[t]) {
      expected.insert(expected.end(), around[v].begin(), around[v].end());
    }
    std::vector<std::uint32_t> ring(std::begin(owned.cells[t].ring), std::end(owned.cells[t].ring));
    ring.push_back(t);
    for (auto* list : {&expected, &ring}) {
      std::sort(list->begin(), list->end());
      list->erase(std::unique(list->begin(), list->end()), list->end());
    }
    ASSERT_EQ(ring, expected);
  }
}

// ------------------------------------------------------------------------------------------------- cameras

using Matrix = std::array<double, 16>;

Vec3d transform(const Matrix& m, const Vec3d& p, double w) {
  return {m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12] * w, m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13] * w,
          m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14] * w};
}

Matrix random_affine(Random& random) {
  Matrix m{};
  for (double& element : m) element = random.uniform(-2, 2);
  m[3] = m[7] = m[11] = 0;
  m[15] = 1;
  return m;
}

double determinant(const Matrix& m) {
  return dot(Vec3d{m[0], m[1], m[2]}, cross(Vec3d{m[4], m[5], m[6]}, Vec3d{m[8], m[9], m[10]}));
}

PellucidOrders orders_around(const Vec3d& center, double radius) {
  PellucidOrders orders{};
  orders.level = 2;
  orders.center[0] = center.x;
  orders.center[1] = center.y;
  orders.center[2] = center.z;
  orders.radius = radius;
  orders.min_distance = 1.5;
  orders.max_distance = 10;
  orders.fallback_order = PELLUCID_NO_ORDER;
  return orders;
}

void expect_near(const double (&actual)[3], const Vec3d& expected, double tolerance) {
  EXPECT_NEAR(actual[0], expected.x, tolerance);
  EXPECT_NEAR(actual[1], expected.y, tolerance);
  EXPECT_NEAR(actual[2], expected.z, tolerance);
}

TEST(Camera, IsTransformedToLocalSpaceByAnyAffineMatrix) {
  Random random(21);
  int mirrored = 0;
  for (int i = 0; i < 2000; ++i) {
    const Matrix world = random_affine(random);
    if (std::fabs(determinant(world)) < 0.1) continue;
    mirrored += determinant(world) < 0 ? 1 : 0;
    const Vec3d center = random.direction() * 3;
    const Vec3d local = random.direction();
    const double distance = random.uniform(0.5, 12);
    const double radius = random.uniform(0.1, 4);
    const PellucidOrders orders = orders_around(center, radius);

    const Vec3d camera = transform(world, center + local * (distance * radius), 1);
    const PellucidView view = pellucid_perspective_view(&orders, world.data(), to_array(camera).data());
    EXPECT_TRUE(view.valid);
    EXPECT_NEAR(view.distance, distance, 1e-9);
    expect_near(view.direction, local * (distance * radius), 1e-9);
    EXPECT_EQ(pellucid_in_range(&orders, &view) != 0, distance >= 1.5 && distance <= 10);

    const Vec3d forward = transform(world, -local, 0);
    const PellucidView flat = pellucid_orthographic_view(world.data(), to_array(forward).data());
    EXPECT_TRUE(flat.valid);
    EXPECT_EQ(flat.distance, HUGE_VAL);
    expect_near(flat.direction, local, 1e-9);
  }
  EXPECT_GT(mirrored, 300);
}

TEST(Camera, UsesTheFallbackWithoutADirection) {
  const Matrix identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const Matrix flat{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
  PellucidOrders orders = orders_around({1, 2, 3}, 2);
  const std::vector<std::uint8_t> cell_orders(320, 5);
  orders.cell_orders = cell_orders.data();
  orders.cell_order_bytes = 1;
  orders.fallback_order = 9;

  const Direction good{1, 2, 12};
  EXPECT_EQ(pellucid_select_perspective(&orders, identity.data(), good.data()), 5U);
  EXPECT_EQ(pellucid_select_perspective(&orders, flat.data(), good.data()), 9U);
  const Direction at_center{1, 2, 3};
  EXPECT_EQ(pellucid_select_perspective(&orders, identity.data(), at_center.data()), 9U);
  const Direction too_near{1, 2, 5};
  EXPECT_EQ(pellucid_select_perspective(&orders, identity.data(), too_near.data()), 9U);
  const Direction too_far{1, 2, 40};
  EXPECT_EQ(pellucid_select_perspective(&orders, identity.data(), too_far.data()), 9U);
  const Direction broken{1, kNaN, 12};
  EXPECT_EQ(pellucid_select_perspective(&orders, identity.data(), broken.data()), 9U);

  // Orthographic cameras are infinitely far away, so only orders without an upper limit are valid.
  const Direction forward{0, 0, -1};
  EXPECT_EQ(pellucid_select_orthographic(&orders, identity.data(), forward.data()), 9U);
  orders.max_distance = HUGE_VAL;
  EXPECT_EQ(pellucid_select_orthographic(&orders, identity.data(), forward.data()), 5U);
  const Direction nowhere{0, 0, 0};
  EXPECT_EQ(pellucid_select_orthographic(&orders, identity.data(), nowhere.data()), 9U);
}

TEST(Camera, SelectsTheOrderOfItsCellForBothKindsOfCells) {
  const Matrix identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const ViewPartition triangles = make_partition({PartitionKind::sampled_triangles, 2, 0});
  const ViewPartition points = make_partition({PartitionKind::viewpoints, 2, 0});
  std::vector<std::uint16_t> by_triangle(triangles.cell_count());
  for (std::size_t i = 0; i < by_triangle.size(); ++i) by_triangle[i] = static_cast<std::uint16_t>(3 * i);

  PellucidOrders orders = orders_around({0, 0, 0}, 1);
  Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const Vec3d d = random.direction();
    const Direction camera = to_array(d * 4);
    orders.cells = pellucid_cells_triangles;
    orders.cell_orders = by_triangle.data();
    orders.cell_order_bytes = 2;
    EXPECT_EQ(pellucid_select_perspective(&orders, identity.data(), camera.data()),
              3 * find_cell_brute_force(triangles, d));
    orders.cells = pellucid_cells_corners;
    orders.cell_orders = points.corner_cells.data();
    orders.cell_order_bytes = 4;
    EXPECT_EQ(pellucid_select_perspective(&orders, identity.data(), camera.data()),
              find_cell_brute_force(points, d));
  }
}

}  // namespace
}  // namespace pellucid
