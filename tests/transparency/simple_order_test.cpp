// Tests meshes that need no search: their one order is right from everywhere, which rasterised fragments
// show, and meshes that need one are not taken for them.
#include "transparency/simple_order.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "meshes.h"
#include "pellucid/metric.h"
#include "pellucid/raster.h"
#include "pellucid/shading.h"
#include "pellucid/transparency.h"

namespace pellucid {
namespace {

Mesh box() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back(
        {static_cast<float>(i & 1), static_cast<float>((i >> 1) & 1), static_cast<float>(i >> 2)});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

// `layers` squares in one plane, each within the one before.
Mesh painted(int layers) {
  Mesh mesh;
  for (int i = 0; i < layers; ++i) {
    const float side = 1 - 0.1F * static_cast<float>(i);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const auto& [x, y] : {std::pair{-side, -side}, {side, -side}, {side, side}, {-side, side}})
      mesh.positions.push_back({x, y, 0.5F});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  return mesh;
}

// Returns the share of wrong pixels over many viewpoints.
double wrong_pixels(const Mesh& mesh, const NodeSequence& order, Facing facing) {
  Random random(5);
  double wrong = 0, covered = 0;
  for (int view = 0; view < 40; ++view) {
    const Vec3d direction =
        normalized(Vec3d{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)});
    const double distance = view % 4 == 0 ? kInfiniteDistance : random.uniform(1.05, 4.0);
    FragmentBuffer fragments;
    rasterize(mesh, look_at_sphere(bounding_sphere(mesh), {direction, distance}, 64, 64),
              {facing == Facing::single ? Culling::back : Culling::none}, fragments);
    const PixelCount count = count_incorrect_pixels(fragments, ranks_of(order, mesh.triangles.size()));
    wrong += static_cast<double>(count.incorrect);
    covered += static_cast<double>(count.foreground);
  }
  return wrong / covered;
}

TEST(SimpleOrder, OfAHullIsRightFromEverywhere) {
  Mesh inside_out = box();
  for (Triangle& t : inside_out.triangles) std::swap(t[1], t[2]);
  Mesh open = box();
  open.triangles.resize(7);
  for (const Mesh& mesh : {box(), inside_out, open, testing::tetrahedron()}) {
    for (const Facing facing : {Facing::single, Facing::duplicated}) {
      const auto simple = find_simple_order(mesh, bounding_sphere(mesh), facing);
      ASSERT_TRUE(simple);
      EXPECT_EQ(simple->front_to_back.size(), mesh.triangles.size() * (facing == Facing::single ? 1 : 2));
      // Where corners snap to the raster at the outline, a far side may come before the near one.
      EXPECT_LT(wrong_pixels(mesh, simple->front_to_back, facing), 2e-4);
    }
  }
}

TEST(SimpleOrder, PaintedLayersStayPaintedFromBothSides) {
  Mesh mesh = painted(5);
  std::swap(mesh.triangles[3][1], mesh.triangles[3][2]);  // one that shows its other side
  const auto simple = find_simple_order(mesh, bounding_sphere(mesh), Facing::duplicated);
  ASSERT_TRUE(simple);
  const std::vector<std::uint32_t> ranks = ranks_of(simple->front_to_back, mesh.triangles.size());
  for (std::uint32_t t = 0; t + 1 < mesh.triangles.size(); ++t) {
    for (const bool flipped : {false, true})
      EXPECT_GT(ranks[node_of(t, flipped)], ranks[node_of(t + 1, flipped)]) << "the later face lies in front";
    EXPECT_EQ(simple->base[t], t) << "the base order is drawn back to front";
  }
}

TEST(SimpleOrder, OtherMeshesNeedASearch) {
  Mesh two = box();
  for (const Triangle& t : box().triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  for (const Vec3f& p : box().positions) two.positions.push_back(p + Vec3f{2, 0, 0});
  EXPECT_FALSE(find_simple_order(two, bounding_sphere(two), Facing::duplicated));
  // A decal on a face of the box.
  Mesh decal = box();
  for (const Vec3f& p : {Vec3f{0.2F, 0.2F, 1}, {0.8F, 0.2F, 1}, {0.5F, 0.8F, 1}})
    decal.positions.push_back(p);
  decal.triangles.push_back({8, 9, 10});
  EXPECT_FALSE(find_simple_order(decal, bounding_sphere(decal), Facing::duplicated));
  Mesh dented = box();
  dented.positions[7] = {0.3F, 0.3F, 0.3F};
  EXPECT_FALSE(find_simple_order(dented, bounding_sphere(dented), Facing::single));
}

TEST(SimpleOrder, IsWhatOrderMeshReturns) {
  const OrderResult result = order_mesh(box(), {});
  EXPECT_TRUE(result.statistics.simple);
  ASSERT_EQ(result.orders.orders.size(), 1U);
  EXPECT_EQ(result.orders.cell_orders.size(), make_partition(OrderOptions{}.partition).cell_count());
}

}  // namespace
}  // namespace pellucid
