// Tests whole files as one mesh: clean primitives with their orders, instances, draw orders, fragments.
#include "pellucid/scene.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "meshes.h"

namespace pellucid {
namespace {

using testing::tetrahedron;

Primitive blend_primitive(const std::string& name) {
  Primitive primitive;
  primitive.name = name;
  primitive.mesh = tetrahedron();
  return primitive;
}

TEST(CleanPrimitive, LiftAndRestrictAreInverse) {
  OrderSet orders;
  orders.orders = {{node_of(0, false), node_of(1, true), node_of(2, false)}};
  orders.base_sequence = {2, 0, 1};
  const std::vector<std::uint32_t> source{1, 4, 5};  // the file has 6 triangles
  const OrderSet lifted = lift_orders(orders, source);
  EXPECT_EQ(lifted.orders[0], (NodeSequence{node_of(1, false), node_of(4, true), node_of(5, false)}));
  EXPECT_EQ(lifted.base_sequence, (std::vector<std::uint32_t>{5, 1, 4}));
  const OrderSet back = restrict_orders(lifted, source, 6);
  EXPECT_EQ(back.orders, orders.orders);
  EXPECT_EQ(back.base_sequence, orders.base_sequence);
  // Triangle 4 is gone: so are its nodes.
  const OrderSet fewer = restrict_orders(lifted, std::vector<std::uint32_t>{1, 5}, 6);
  EXPECT_EQ(fewer.orders[0], (NodeSequence{node_of(0, false), node_of(1, false)}));
}

TEST(CleanPrimitive, PatchesShrinkWithTheirTriangles) {
  OrderSet orders;
  orders.purpose = OrderPurpose::overdraw;
  orders.base_sequence = {2, 0, 1, 3};
  orders.patch_offsets = {0, 1, 3, 4};
  const OrderSet all = restrict_orders(orders, std::vector<std::uint32_t>{0, 1, 2, 3}, 4);
  EXPECT_EQ(all.patch_offsets, orders.patch_offsets);
  const OrderSet fewer = restrict_orders(orders, std::vector<std::uint32_t>{0, 1, 3}, 4);
  EXPECT_EQ(fewer.base_sequence, (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(fewer.patch_offsets, (std::vector<std::uint32_t>{0, 2, 3}));
  EXPECT_EQ(lift_orders(orders, std::vector<std::uint32_t>{7, 5, 3, 1}).patch_offsets, orders.patch_offsets);
}

TEST(CleanPrimitive, OverdrawOrdersAreNotTransparencyOrders) {
  Primitive primitive = blend_primitive("car");
  EXPECT_FALSE(has_transparency_orders(primitive));
  primitive.orders.emplace();
  EXPECT_TRUE(has_transparency_orders(primitive));
  EXPECT_TRUE(clean_primitive(primitive).orders);
  primitive.orders->purpose = OrderPurpose::overdraw;
  EXPECT_FALSE(has_transparency_orders(primitive));
  EXPECT_FALSE(clean_primitive(primitive).orders);
}

// World matrix: a diagonal and a shift.
Mat4 placed(double sx, double sy, double sz, const Vec3d& shift) {
  Mat4 m;
  m.m = {sx, 0, 0, 0, 0, sy, 0, 0, 0, 0, sz, 0, shift.x, shift.y, shift.z, 1};
  return m;
}

TEST(Scene, MirroredInstancesKeepTheirOutside) {
  Model model;
  model.format = "obj";
  model.primitives = {blend_primitive("tetrahedron")};
  model.instances = {{"a", 0, placed(1, 1, 1, {})}, {"b", 0, placed(-2, 1, 1, {5, 0, 0})}};
  const Scene scene = make_scene(model);
  ASSERT_EQ(scene.mesh.triangles.size(), 8U);
  // Outward normals point away from the middle of their object.
  for (std::uint32_t t = 0; t < 8; ++t) {
    Vec3d middle;
    const std::uint32_t first = t < 4 ? 0 : 4;
    for (std::uint32_t v = first; v < first + 4; ++v) middle += to_double(scene.mesh.positions[v]) / 4.0;
    const Vec3d corner = to_double(scene.mesh.positions[scene.mesh.triangles[t][0]]);
    EXPECT_GT(dot(triangle_normal(scene.mesh, t), corner - middle), 0.0) << t;
  }
}

TEST(Scene, NearerObjectsComeFirst) {
  Model model;
  model.format = "obj";
  model.primitives = {blend_primitive("tetrahedron")};
  model.instances = {{"far", 0, placed(1, 1, 1, {0, 0, -8})}, {"near", 0, placed(1, 1, 1, {0, 0, 8})}};
  const Scene scene = make_scene(model);
  for (const double distance : {4.0, kInfiniteDistance}) {
    const Viewpoint view{{0, 0, 1}, distance};
    const Camera camera = look_at_sphere(scene.sphere, view, 32, 32);
    const std::vector<std::uint32_t> ranks = scene_ranks(scene, SceneOrder::original, camera, view);
    for (std::uint32_t near_node = 8; near_node < 16; ++near_node) {
      for (std::uint32_t far_node = 0; far_node < 8; ++far_node) EXPECT_LT(ranks[near_node], ranks[far_node]);
    }
  }
}

TEST(Scene, EveryInstanceChoosesItsOrderInItsOwnSpace) {
  Model model;
  model.format = "obj";
  Primitive primitive = blend_primitive("tetrahedron");
  OrderSet orders;
  orders.partition = parse_partition("S0,0");
  orders.sphere = bounding_sphere(primitive.mesh);
  for (std::uint32_t cell = 0; cell < 20; ++cell) {
    NodeSequence sequence{0, 1, 2, 3, 4, 5, 6, 7};
    std::rotate(sequence.begin(), sequence.begin() + cell % 8, sequence.end());
    orders.orders.push_back(sequence);
    orders.cell_orders.push_back(cell);
  }
  primitive.orders = orders;
  model.primitives = {primitive};
  // Half a turn about Y, twice as large.
  Mat4 turned = placed(-2, 2, -2, {1, 2, 3});
  model.instances = {{"turned", 0, turned}};
  const Scene scene = make_scene(model);
  const Viewpoint view{normalized(Vec3d{0.3, 0.2, 0.9}), kInfiniteDistance};
  const Camera camera = look_at_sphere(scene.sphere, view, 32, 32);
  const std::uint32_t expected =
      select_order(orders, {-view.direction.x, view.direction.y, -view.direction.z});
  EXPECT_EQ(scene_ranks(scene, SceneOrder::buffers, camera, view), ranks_of(orders.orders[expected], 4));
}

TEST(Scene, SingleSidedPrimitivesHaveNoBackFaces) {
  Model model;
  model.format = "glb";
  model.primitives = {blend_primitive("tetrahedron")};
  model.instances = {{"a", 0, {}}};
  const Camera camera = look_at_sphere(make_scene(model).sphere, {{0, 0, 1}, 3}, 64, 64);
  const std::size_t both = scene_fragments(make_scene(model), camera).fragments.size();
  model.primitives[0].double_sided = false;
  const FragmentBuffer front = scene_fragments(make_scene(model), camera);
  EXPECT_LT(front.fragments.size(), both);
  EXPECT_EQ(front.offsets.back(), front.fragments.size());
  for (const Fragment& fragment : front.fragments) EXPECT_EQ(fragment.node % 2, 0U);
}

TEST(Scene, SkipsWhatIsSmallerThanAPlaneAndDrawsWhatIsFlat) {
  Model model;
  model.format = "glb";
  model.primitives = {blend_primitive("tetrahedron")};
  model.instances = {{"flat", 0, placed(1, 0, 1, {})}, {"whole", 0, placed(1, 1, 1, {3, 0, 0})}};
  const Scene scene = make_scene(model);
  ASSERT_EQ(scene.objects.size(), 2U);
  EXPECT_FALSE(scene.objects[0].has_inverse);
  for (std::uint32_t v = 0; v < scene.objects[1].first_vertex; ++v) {
    EXPECT_EQ(scene.mesh.positions[v].y, 0);
    // A normal in the plane has no direction left.
    const Vec3f& normal = scene.mesh.normals[v];
    EXPECT_TRUE(std::fabs(normal.y) == 1 || length(normal) == 0);
  }
  for (const Mat4& nothing : {placed(0, 0, 0, {}), placed(1, 0, 0, {})}) {
    model.instances[0].world = nothing;
    EXPECT_EQ(make_scene(model).objects.size(), 1U);
  }
  // A line below a rotation, where zeros are rounding.
  Mat4 turned = placed(1, 1, 1, {});
  turned.m = {0.6, 0.8, 0, 0, 0.8e-17, -0.6e-17, 1e-17, 0, 1e-18, 0, 1e-17, 0, 0, 0, 0, 1};
  model.instances[0].world = turned;
  EXPECT_EQ(make_scene(model).objects.size(), 1U);
  model.instances[0].world.m[12] = std::nan("");
  EXPECT_THROW(make_scene(model), Error);
  model.instances.clear();
  EXPECT_THROW(make_scene(model), Error);
}

}  // namespace
}  // namespace pellucid
