// Runs the program on inputs that other programs of this kind got wrong, one test for each row of the README
// beside them. They are found by PELLUCID_CASES; a test whose input is missing is skipped. The modules have
// tests of the same kinds over all readers and techniques.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "command_line.h"
#include "pellucid/asset.h"
#include "pellucid/material.h"

namespace pellucid::testing {
namespace {

namespace fs = std::filesystem;

class FieldCases : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::is_directory(PELLUCID_CASES)) GTEST_SKIP() << "field cases missing: " << PELLUCID_CASES;
  }
  [[nodiscard]] static std::string input(const std::string& name) {
    return std::string(PELLUCID_CASES) + "/" + name;
  }
  // Runs a command that must succeed, and returns what it said.
  static std::string said(const Arguments& arguments) {
    const Finished done = run_pellucid(arguments);
    EXPECT_EQ(done.code, 0) << arguments[0] << " " << arguments[1] << "\n" << done.err;
    return done.out + done.err;
  }
  // Writes the model with orders to a file of the test's folder and returns the name of that file.
  std::string ordered(const std::string& name, const std::string& output, const Arguments& more = {}) {
    said(quick_order(input(name), folder_.file(output), more));
    return folder_.file(output);
  }
  // Returns a small image of the model by the technique.
  std::string drawn(const std::string& name, const std::string& technique, const Arguments& more = {}) {
    const std::string png = folder_.file("image.png");
    Arguments arguments{"render", input(name), "-o", png, "--technique", technique, "--size", "160x120"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    fs::remove(png);
    said(arguments);
    return slurp(png);
  }
  // Expects the same image of both models by techniques of every family.
  void expect_same_images(const std::string& name, const std::string& reference, const Arguments& more = {}) {
    for (const std::string& technique : techniques()) {
      const std::string image = drawn(name, technique, more);
      EXPECT_FALSE(image.empty());
      EXPECT_TRUE(image == drawn(reference, technique, more)) << name << " by " << technique;
    }
  }
  static std::vector<std::string> techniques() {
#ifdef PELLUCID_WITH_RENDERER
    return {"cpu", "f2b-2p", "bun-ll", "sb", "k-plus", "verified"};
#else
    return {"cpu"};
#endif
  }
  static std::uint64_t triangles_of(const std::string& name) {
    std::uint64_t count = 0;
    for (const Primitive& primitive : read_model(input(name)).primitives)
      count += primitive.mesh.triangles.size();
    return count;
  }

  TemporaryFolder folder_;
};

double area_of(const Mesh& mesh) {
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = to_double(mesh.positions[t[0]]);
    area += 0.5 * length(cross(to_double(mesh.positions[t[1]]) - a, to_double(mesh.positions[t[2]]) - a));
  }
  return area;
}

TEST_F(FieldCases, AByteOrderMarkIsSkipped) {
  EXPECT_EQ(triangles_of("obj-byte-order-mark.obj"), 2U);
  const Model model = read_model(input("obj-byte-order-mark-silent.obj"));
  ASSERT_EQ(model.primitives.size(), 1U);
  EXPECT_EQ(model.primitives[0].mesh.positions[0].x, 0);
}

TEST_F(FieldCases, ACarriageReturnAloneEndsALine) {
  EXPECT_GT(triangles_of("obj-cr-line-ends.obj"), 0U);
  EXPECT_GT(triangles_of("obj-cr-in-comment.obj"), 0U);
}

TEST_F(FieldCases, AQuotedMaterialFileIsFound) {
  const Model model = read_model(input("mtllib-quoted.obj"));
  EXPECT_FLOAT_EQ(model.primitives.at(0).base_color[3], 0.25F);
}

TEST_F(FieldCases, OddStlKeywordsAndUnusedNormalsAreRead) {
  for (const char* name : {"stl-endsolid-glued.stl", "stl-end-loop.stl", "stl-nan-normal.stl"})
    EXPECT_GT(triangles_of(name), 0U) << name;
}

TEST_F(FieldCases, APolygonOf4097CornersKeepsItsArea) {
  const Model model = read_model(input("polygon-4097-corners.obj"));
  EXPECT_EQ(model.primitives.at(0).mesh.triangles.size(), 4095U);
  EXPECT_NEAR(area_of(model.primitives[0].mesh), 3.80, 0.01);
}

TEST_F(FieldCases, VertexColoursWithAlphaArriveInTheWrittenFile) {
  const Model model = read_model(ordered("ply-vertex-rgba.ply", "rgba.glb"));
  const Materials materials = read_materials(model);
  ASSERT_EQ(materials.primitives.size(), 1U);
  EXPECT_EQ(materials.primitives[0].alpha_mode, AlphaMode::blend);
  const auto& colors = materials.primitives[0].colors;
  ASSERT_EQ(colors.size(), 4U);
  constexpr std::array kAlphas{255, 128, 0, 64};
  for (std::size_t v = 0; v < colors.size(); ++v) EXPECT_NEAR(colors[v][3], kAlphas[v] / 255.0, 1e-5);
}

TEST_F(FieldCases, ABodyStaysOpaqueBesideAWindow) {
  const Model by_order = read_model(ordered("car.obj", "car.glb"));
  said({"overdraw", input("car.obj"), "-o", folder_.file("car-overdraw.glb"), "--check-views", "2"});
  const Model by_overdraw = read_model(folder_.file("car-overdraw.glb"));
  for (const Model* model : {&by_order, &by_overdraw}) {
    ASSERT_EQ(model->primitives.size(), 2U);
    for (const Primitive& primitive : model->primitives) {
      const bool window = primitive.material_name == "window";
      EXPECT_EQ(primitive.alpha_mode, window ? AlphaMode::blend : AlphaMode::opaque) << primitive.name;
      EXPECT_EQ(primitive.orders.has_value(), window == (model == &by_order)) << primitive.name;
    }
  }
}

TEST_F(FieldCases, ARawPercentSignInANameIsRead) {
  EXPECT_GT(triangles_of("pct_raw.gltf"), 0U);
}

TEST_F(FieldCases, TexturesBesideAModelArriveInAnotherFolder) {
  const std::string output = ordered("textures-in-folder/pane.gltf", "pane.gltf");
  const Materials materials = read_materials(read_model(output));
  EXPECT_EQ(materials.images.size(), 1U);
  EXPECT_TRUE(materials.notes.empty()) << materials.notes.front();
}

TEST_F(FieldCases, AModelFarFromTheOriginLooksAsNearIt) {
  expect_same_images("far-node-utm.glb", "far-node-near.glb");
}

TEST_F(FieldCases, TheCapturedShareOfDistantVerticesIsAtMostOne) {
  for (const std::string& technique : techniques()) {
    if (technique == "cpu") continue;
    const std::string json = folder_.file("far.json");
    for (const char* camera : {"30,20,3", "200,-70,1.5", "90,0,8"}) {
      drawn("far-million.gltf", technique, {"--json", json, "--camera", camera});
      EXPECT_LE(parse_json_file(json)["r_h"].get<double>(), 1.0) << technique << " " << camera;
    }
  }
}

TEST_F(FieldCases, AnInstanceThatIsScaledToNothingIsSkipped) {
  expect_same_images("scale-zero.glb", "scale-zero-reference.glb");
}

TEST_F(FieldCases, TheTransformOfASkinnedNodeHasNoEffect) {
  expect_same_images("skinned-node-moved.glb", "skinned-node-reference.glb");
}

TEST_F(FieldCases, MorphWeightsOfANodeAreApplied) {
  expect_same_images("morph-node-weights.glb", "morph-node-weights-reference.glb");
}

TEST_F(FieldCases, InstancesOfTheGpuAreDrawn) {
  expect_same_images("gpu-instancing.glb", "gpu-instancing-reference.glb");
}

TEST_F(FieldCases, CoincidentFacesKeepTheOrderOfTheFile) {
  const Model model = read_model(ordered("painted-layers.glb", "painted.glb"));
  const auto& orders = model.primitives.at(0).orders;
  ASSERT_TRUE(orders.has_value());
  const std::size_t count = model.primitives[0].mesh.triangles.size();
  for (const std::vector<NodeId>& order : orders->orders) {
    for (const unsigned side : {0U, 1U}) {
      std::vector<NodeId> nodes;
      for (const NodeId node : order)
        if ((node & 1U) == side) nodes.push_back(node);
      // Orders are stored from front to back, and what the file draws last lies in front.
      EXPECT_TRUE(std::is_sorted(nodes.rbegin(), nodes.rend())) << "side " << side << " of " << count;
    }
  }
}

TEST_F(FieldCases, SolidsAreCutTheSameWhateverTheirSides) {
  for (const char* effect : {"csg", "self-collision", "thickness"})
    for (const char* technique : {"cpu", techniques().size() > 1 ? "f2b-2p" : "cpu"})
      EXPECT_TRUE(drawn("csg-single-sided.gltf", technique, {"--effect", effect}) ==
                  drawn("csg-double-sided.gltf", technique, {"--effect", effect}))
          << effect << " by " << technique;
}

TEST_F(FieldCases, PrimitivesWhoseFacesNeverOverlapNeedNoSearch) {
  const std::string json = folder_.file("many.json");
  said({"order", input("many-500-tiny-primitives.glb"), "-o", folder_.file("many.glb"), "--json", json});
  const Model model = read_model(folder_.file("many.glb"));
  ASSERT_EQ(model.primitives.size(), 500U);
  for (const Primitive& primitive : model.primitives) {
    ASSERT_TRUE(primitive.orders.has_value());
    EXPECT_EQ(primitive.orders->orders.size(), 1U);
  }
  EXPECT_EQ(parse_json_file(json)["primitives"][0]["viewpoints"], 0);
}

TEST_F(FieldCases, MaterialsAreDrawnOrNoted) {
  const std::string notes =
      said({"render", input("materials.gltf"), "-o", folder_.file("m.png"), "--surfaces", "file"});
  for (const char* what : {"metal", "roughness"}) EXPECT_NE(notes.find(what), std::string::npos) << notes;
  for (const char* what : {"unlit", "emissive", "texture_transform"})
    EXPECT_EQ(notes.find(what), std::string::npos) << notes;
}

}  // namespace
}  // namespace pellucid::testing
