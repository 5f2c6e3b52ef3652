// Tests the functions of the command line: compacted meshes, selections, cameras as text.
#include <gtest/gtest.h>

#include "camera_options.h"
#include "cleaned.h"
#include "meshes.h"
#include "selection.h"

namespace pellucid::cli {
namespace {

using pellucid::testing::tetrahedron;

Primitive blend_primitive(const std::string& name) {
  Primitive primitive;
  primitive.name = name;
  primitive.mesh = tetrahedron();
  return primitive;
}

TEST(Cleaned, CompactedKeepsCornersAndNormals) {
  Mesh mesh = tetrahedron();
  mesh.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}};
  mesh.triangles = {{3, 1, 2}};
  const Mesh compact = compacted(mesh);
  ASSERT_EQ(compact.positions.size(), 3U);
  for (int corner = 0; corner < 3; ++corner) {
    const auto c = static_cast<std::size_t>(corner);
    EXPECT_EQ(compact.positions[compact.triangles[0][c]], mesh.positions[mesh.triangles[0][c]]);
    EXPECT_EQ(compact.normals[compact.triangles[0][c]], mesh.normals[mesh.triangles[0][c]]);
  }
}

TEST(Selection, BlendPrimitivesOfAGltfUnlessAskedForMore) {
  Model model;
  model.path = "m.glb";
  model.format = "glb";
  model.primitives = {blend_primitive("glass"), blend_primitive("table"), blend_primitive("flag"),
                      blend_primitive("lines")};
  model.primitives[1].alpha_mode = AlphaMode::opaque;
  model.primitives[1].material_name = "wood";
  model.primitives[2].deforms = true;
  model.primitives[3].triangles = false;
  const Selection blend = select_primitives(model, {});
  EXPECT_EQ(blend.primitives, (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(blend.notes.size(), 3U);
  EXPECT_EQ(select_primitives(model, {true, ""}).primitives, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(select_primitives(model, {false, "wood"}).primitives, (std::vector<std::uint32_t>{1}));
  EXPECT_THROW(select_primitives(model, {false, "steel"}), Error);
}

TEST(Selection, AllWhenNothingIsBlend) {
  Model model;
  model.format = "gltf";
  model.primitives = {blend_primitive("a"), blend_primitive("b")};
  for (Primitive& primitive : model.primitives) primitive.alpha_mode = AlphaMode::mask;
  const Selection all = select_primitives(model, {});
  EXPECT_EQ(all.primitives.size(), 2U);
  EXPECT_EQ(all.notes.size(), 1U);
}

TEST(Selection, NamesTheReasonWhenNothingCanBeOrdered) {
  Model model;
  model.format = "glb";
  model.primitives = {blend_primitive("flag")};
  model.primitives[0].deforms = true;
  try {
    select_primitives(model, {});
    FAIL() << "nothing can be ordered";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::nothing_to_do);
    EXPECT_NE(std::string(error.what()).find("skinned"), std::string::npos);
  }
}

TEST(CameraText, IsAzimuthElevationAndDistance) {
  const Viewpoint front = parse_camera("0,0,3");
  EXPECT_NEAR(front.direction.z, 1, 1e-12);
  EXPECT_EQ(front.distance, 3);
  EXPECT_NEAR(parse_camera("orbit:90,0,2").direction.x, 1, 1e-12);
  EXPECT_NEAR(parse_camera("0,90,inf").direction.y, 1, 1e-12);
  EXPECT_TRUE(std::isinf(parse_camera("0,90,inf").distance));
  for (const char* bad : {"", "1,2", "1,2,x", "1,2,3,4", "nan,0,3", "1,inf,3", "1,2,1", "1,2,nan"}) {
    EXPECT_THROW(parse_camera(bad), Error) << bad;
  }
}

}  // namespace
}  // namespace pellucid::cli
