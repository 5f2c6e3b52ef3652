// Tests the C++ interface for files: reading a model, ordering it, writing it, and reading its orders again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>

#include "meshes.h"
#include "pellucid/pellucid.h"

namespace pellucid {
namespace {

using ::testing::ElementsAre;

OrderOptions few_views() {
  OrderOptions options;
  options.method = OrderMethod::acyclic;
  options.partition = parse_partition("S0,1");
  return options;
}

// An opaque sphere and a translucent one.
Model two_spheres() {
  Model model = make_model({{"opaque", testing::icosphere_mesh(1), {1, 1, 1, 1}},
                            {"translucent", testing::icosphere_mesh(1, 0.5), {1, 1, 1, 0.5F}}},
                           "spheres");
  model.primitives[0].alpha_mode = AlphaMode::opaque;
  model.primitives[1].alpha_mode = AlphaMode::blend;
  return model;
}

std::string file_named(const std::string& name) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "pellucid_api";
  std::filesystem::create_directories(folder);
  return (folder / name).string();
}

ErrorKind kind_of_file_error(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::internal;
}

TEST(ModelFiles, KeepOrdersOfTranslucentPrimitives) {
  Model model = two_spheres();
  EXPECT_THAT(order(model, few_views()), ElementsAre(1U));
  EXPECT_FALSE(model.primitives[0].orders.has_value());
  const OrderedMesh made = orders_of(model, 1);
  const std::string path = file_named("ordered.glb");
  WriteOptions as_is;
  as_is.bake_base = false;  // triangles keep their numbers
  EXPECT_GT(write(model, path, as_is).order_bytes, 0U);

  const Model again = read(path);
  const OrderedMesh stored = orders_of(again, 1);
  EXPECT_EQ(stored.orders().orders, made.orders().orders);
  EXPECT_EQ(stored.orders().cell_orders, made.orders().cell_orders);
  EXPECT_EQ(stored.triangles(), made.triangles());
  EXPECT_EQ(stored.select({}, {2, 3, 4}), made.select({}, {2, 3, 4}));
  EXPECT_EQ(kind_of_file_error([&] { orders_of(again, 0); }), ErrorKind::nothing_to_do);
}

TEST(ModelFiles, StayAsTheyWereWhenAPrimitiveDrawsNothing) {
  Model model = make_model({{"sphere", testing::icosphere_mesh(1), {1, 1, 1, 0.5F}},
                            {"nothing", Mesh{{{0, 0, 0}}, {}, {{0, 0, 0}}}, {1, 1, 1, 0.5F}}},
                           "sphere and nothing");
  for (Primitive& primitive : model.primitives) primitive.alpha_mode = AlphaMode::blend;
  EXPECT_EQ(kind_of_file_error([&] { order(model, few_views()); }), ErrorKind::nothing_to_do);
  EXPECT_FALSE(model.primitives[0].orders.has_value());
}

TEST(ModelFiles, TakeFacingFromTheMaterial) {
  Model model = two_spheres();
  write(model, file_named("plain.glb"));
  model = read(file_named("plain.glb"));
  model.primitives[0].double_sided = false;
  model.primitives[1].double_sided = true;
  EXPECT_EQ(order_primitive(model, 0, few_views()).orders().facing, Facing::single);
  EXPECT_EQ(order_primitive(model, 1, few_views()).orders().facing, Facing::duplicated);
}

TEST(ModelFiles, RefuseWhatCannotBeOrdered) {
  Model model = two_spheres();
  model.primitives[1].deforms = true;
  EXPECT_EQ(kind_of_file_error([&] { order(model, few_views()); }), ErrorKind::nothing_to_do);
  EXPECT_EQ(kind_of_file_error([&] { order_primitive(model, 1, few_views()); }), ErrorKind::bad_argument);
  EXPECT_EQ(kind_of_file_error([&] { order_primitive(model, 2, few_views()); }), ErrorKind::bad_argument);
  EXPECT_EQ(kind_of_file_error([] { read("/nowhere/at.all.glb"); }), ErrorKind::bad_input);
}

TEST(ModelFiles, TakeOrdersOfTheirOwnMeshOnly) {
  Model model = two_spheres();
  const OrderedMesh ordered = order_primitive(model, 1, few_views());
  set_orders(model, 0, ordered);  // as many triangles, with the same indices
  EXPECT_TRUE(model.primitives[0].orders.has_value());
  model.primitives[0].mesh.triangles.pop_back();
  EXPECT_EQ(kind_of_file_error([&] { set_orders(model, 0, ordered); }), ErrorKind::bad_argument);
  const Mesh& mesh = model.primitives[1].mesh;
  const OrderedMesh opaque = reduce_overdraw({mesh.positions, mesh.triangles}, {.view_level = 0, .size = 32});
  EXPECT_EQ(kind_of_file_error([&] { set_orders(model, 1, opaque); }), ErrorKind::bad_argument);
}

}  // namespace
}  // namespace pellucid
