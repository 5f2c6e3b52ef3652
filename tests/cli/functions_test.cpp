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
  EXPECT_EQ(parse_camera("0,0,0.5").distance, 0.5);
  EXPECT_TRUE(fits("30,20"));
  EXPECT_FALSE(fits("30,20,3"));
  EXPECT_FALSE(fits("file:a,b"));
  for (const char* bad : {"", "1", "1,x", "1,2,x", "1,2,3,4", "nan,0,3", "1,inf,3", "1,2,0", "1,2,nan"}) {
    EXPECT_THROW(parse_camera(bad), Error) << bad;
  }
}

// ------------------------------------------------------------------------------------------ lenses of
// cameras

Scene scene_of(const std::string& sample) {
  return make_scene(make_model(make_sample(sample, 0.1), sample));
}

// The part of the image that the scene's vertices span, of its width and of its height: 1 is all of it.
std::array<double, 2> spanned(const Scene& scene, const Camera& camera) {
  double x = 0, y = 0;
  for (const Vec3f& position : scene.mesh.positions) {
    const Vec3d offset = to_double(position) - camera.eye;
    const double depth = camera.perspective ? dot(offset, camera.forward) : 1;
    x = std::max(x, std::abs(dot(offset, camera.right) / depth));
    y = std::max(y, std::abs(dot(offset, camera.up) / depth));
  }
  return {x * camera.height / (camera.width * camera.half_height), y / camera.half_height};
}

TEST(CameraLens, WithoutADistanceTheSceneFillsTheImage) {
  for (const char* sample : {"goblet", "torus-knot", "coplanar-stack"}) {
    const Scene scene = scene_of(sample);
    for (const auto& [width, height] : {std::array{640U, 480U}, {300U, 900U}, {1200U, 200U}}) {
      for (const char* view : {"30,20", "0,0", "120,-85"}) {
        const auto [x, y] = spanned(scene, camera_from(view, {}, {}, scene, width, height));
        EXPECT_LE(std::max(x, y), 1) << sample << " " << view << " " << width;
        EXPECT_GE(std::max(x, y), 0.95) << sample << " " << view << " " << width;
      }
    }
  }
}

TEST(CameraLens, OptionsSayTargetAngleZoomAndNearPlane) {
  const Scene scene = scene_of("goblet");
  const Camera plain = camera_from("30,20,3", {}, {}, scene, 640, 480);
  LensOptions lens;
  lens.zoom = 2;
  EXPECT_DOUBLE_EQ(camera_from("30,20,3", lens, {}, scene, 640, 480).half_height, plain.half_height / 2);
  lens = {};
  lens.fov = 60;
  EXPECT_NEAR(camera_from("30,20,3", lens, {}, scene, 640, 480).half_height, std::tan(0.5235987755982988),
              1e-12);
  EXPECT_THROW(camera_from("30,20,inf", lens, {}, scene, 640, 480), Error);
  lens = {};
  lens.near_plane = 0.25;
  EXPECT_EQ(camera_from("30,20,3", lens, {}, scene, 640, 480).near_plane, 0.25);
  lens.near_plane = 1e9;
  EXPECT_THROW(camera_from("30,20,3", lens, {}, scene, 640, 480), Error);
  lens = {};
  lens.target = "1,-2,0.5";
  const Camera moved = camera_from("30,20,3", lens, {}, scene, 640, 480);
  // The ray through the middle of the image meets the target.
  const Vec3d to_target = Vec3d{1, -2, 0.5} - scene.origin - moved.eye;
  EXPECT_NEAR(dot(normalized(to_target), moved.forward), 1, 1e-12);
  for (const char* bad : {"1,2", "1,2,x", "1,2,3,4", "nan,0,0"}) {
    lens.target = bad;
    EXPECT_THROW(camera_from("30,20,3", lens, {}, scene, 640, 480), Error) << bad;
  }
  lens.target = "0,0,0";
  EXPECT_THROW(camera_from("file:0", lens, {}, scene, 640, 480), Error);
}

}  // namespace
}  // namespace pellucid::cli
