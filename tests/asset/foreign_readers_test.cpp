// Tests reading of PLY, OBJ, STL and OFF: every feature on small files, and the triangle counts of the
// development models.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "foreign_files.h"

namespace pellucid {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::vector<Vec3f> kSquare{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

// --------------------------------------------------------------------------------------------------- PLY

TEST(Ply, ReadsTextWithQuadsNormalsAndOtherProperties) {
  const Model model =
      read_text("a.ply",
                "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nobj_info none\r\n"
                "element vertex 4\r\nproperty uchar red\r\nproperty float x\r\nproperty double y\r\n"
                "property float z\r\nproperty list uchar int rings\r\nproperty float nx\r\n"
                "property float ny\r\nproperty float nz\r\n"
                "element face 1\r\nproperty list uchar int vertex_indices\r\nproperty int flags\r\n"
                "element edge 1\r\nproperty int vertex1\r\nend_header\r\n"
                "255 0 0 0 2 7 7 0 0 2\r\n255 1 0 0 0 0 0 1\r\n0 1 1 0 1 5 0 0 0\r\n0 0 1 0 0 nan 0 1\r\n"
                "4 0 1 2 3 9\r\n5\r\n");
  EXPECT_EQ(model.format, "ply");
  EXPECT_THAT(model.notes, IsEmpty());
  ASSERT_EQ(model.primitives.size(), 1U);
  EXPECT_EQ(model.primitives[0].alpha_mode, AlphaMode::blend);
  EXPECT_TRUE(model.primitives[0].double_sided);
  const Mesh& mesh = model.primitives[0].mesh;
  EXPECT_EQ(mesh.positions, kSquare);
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  // Too long, right, zero and NaN: all become the unit normal.
  EXPECT_THAT(mesh.normals, testing::Each(Vec3f{0, 0, 1}));
}

template <class Coordinate, class Count, class Index>
std::string binary_square(const std::string& types, bool big_endian) {
  ByteWriter out(big_endian);
  for (const Vec3f& p : kSquare) {
    out.put(static_cast<Coordinate>(p.x)).put(static_cast<Coordinate>(p.y)).put(static_cast<Coordinate>(p.z));
    out.put(std::int16_t{-2});
  }
  out.put(Count{3}).put(Index{0}).put(Index{1}).put(Index{2});
  out.put(Count{3}).put(Index{0}).put(Index{2}).put(Index{3});
  const std::string coordinate = types.substr(0, types.find(' '));
  return std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
         "_endian 1.0\nelement vertex 4\nproperty " + coordinate + " x\nproperty " + coordinate +
         " y\nproperty " + coordinate + " z\nproperty short temperature\nelement face 2\nproperty list" +
         types.substr(types.find(' ')) + " vertex_index\nend_header\n" + out.bytes();
}

TEST(Ply, ReadsBinaryOfBothByteOrdersAndAllTypes) {
  for (const bool big_endian : {false, true}) {
    for (const std::string& content :
         {binary_square<float, std::uint8_t, std::int32_t>("float uchar int", big_endian),
          binary_square<double, std::uint8_t, std::uint32_t>("double uint8 uint", big_endian),
          binary_square<std::int8_t, std::int8_t, std::int8_t>("char int8 int8", big_endian),
          binary_square<std::uint8_t, std::uint16_t, std::uint16_t>("uchar ushort uint16", big_endian),
          binary_square<std::int16_t, std::int32_t, std::int16_t>("short int32 short", big_endian),
          binary_square<std::int32_t, std::uint32_t, float>("int uint float", big_endian)}) {
      const Mesh mesh = mesh_of("b.ply", content);
      EXPECT_EQ(mesh.positions, kSquare);
      EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
      EXPECT_THAT(mesh.normals, IsEmpty());
    }
  }
}

TEST(Ply, TriangleStripsTurnEverySecondTriangle) {
  const Mesh mesh =
      mesh_of("s.ply",
              "ply\nformat ascii 1.0\nelement tristrips 1\nproperty list int int vertex_indices\n"
              "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
              "9 0 1 3 2 -1 3 2 1 1\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n");
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 3}, Triangle{1, 2, 3}, Triangle{3, 2, 1}));
}

TEST(Ply, PointsShortFacesAndTrailingDataAreNoted) {
  const std::string points =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  EXPECT_THAT(mesh_of("p.ply", points + "end_header\n1 2 3\n").triangles, IsEmpty());
  const Model model = read_text(
      "p.ply",
      points + "element face 2\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n2 0 0\n0\nmore\n");
  EXPECT_THAT(model.notes, ElementsAre("data after the last element left out",
                                       "2 faces with fewer than 3 corners left out"));
}

TEST(Ply, RoundsNumbersToTheNearestFloatAndKeepsNonFiniteOnes) {
  const Mesh mesh =
      mesh_of("n.ply",
              "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
              "property float z\nend_header\n+0.1 1e999 -1e99\n-inf nan 1e-999\n16777217 1e-46 .5\n");
  EXPECT_EQ(mesh.positions[0], (Vec3f{0.1F, INFINITY, -INFINITY}));
  EXPECT_EQ(mesh.positions[1].x, -INFINITY);
  EXPECT_TRUE(std::isnan(mesh.positions[1].y));
  EXPECT_EQ(mesh.positions[1].z, 0.0F);
  EXPECT_EQ(mesh.positions[2], (Vec3f{16777216.0F, 0.0F, 0.5F}));
}

// --------------------------------------------------------------------------------------------------- OBJ

TEST(Obj, ReadsAllFormsOfCorners) {
  const Mesh mesh = mesh_of("f.obj",
                            "# square\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0 0.5 0.5 0.5\nv 0 1 0\nvt 0 0\nvn 0 0 3\n"
                            "f 1//1 2//1 3/1/1 # trailing\ns 1\nf 1//-1 -2/-1/-1 \\\n 4//1\n");
  EXPECT_EQ(mesh.positions, kSquare);
  EXPECT_EQ(mesh.normals, (std::vector<Vec3f>(4, {0, 0, 1})));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
}

TEST(Obj, WithoutNormalsVerticesKeepTheirNumbers) {
  const Mesh mesh = mesh_of("k.obj", "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 4 2/ 3/\n");
  EXPECT_EQ(mesh.positions.size(), 4U);
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{3, 1, 2}));
}

TEST(Obj, DifferentNormalsSplitAVertexAndMissingOnesAreMade) {
  const Mesh mesh = mesh_of("n.obj",
                            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvn 1 0 0\n"
                            "f 1//1 2//1 3//1\nf 1//2 3//2 4//2\nf 4 1 2\n");
  // Vertices: three, three again with the other normal, and 4, 1, 2 without any.
  EXPECT_EQ(mesh.positions.size(), 9U);
  EXPECT_EQ(mesh.normals[0], (Vec3f{0, 0, 1}));
  EXPECT_EQ(mesh.normals[3], (Vec3f{1, 0, 0}));
  EXPECT_EQ(mesh.normals[8], (Vec3f{0, -1, 0}));
}

TEST(Obj, FacesMayComeBeforeTheirVertices) {
  EXPECT_THAT(mesh_of("b.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0").triangles,
              ElementsAre(Triangle{0, 1, 2}));
}

TEST(Obj, MakesOnePrimitivePerMaterialWithItsOpacity) {
  const TemporaryModel materials(
      "m.mtl",
      "newmtl glass green\nKd 0.1 0.8 0.2\nd 0.25\nTr 0\nnewmtl meshlab\nTr 1.0\n"
      "newmtl tr\nKd 0.5\nTr 0.75\nd nonsense\nnewmtl halo\nTr 0.5\nd -halo 0.9\n");
  const std::string library = std::filesystem::path(materials.path()).filename().string();
  const Model model =
      read_text("m.obj", "mtllib " + library + " missing.mtl\no one\nv 0 0 0\nv 1 0 0\nv 0 1 0\n" +
                             "f 1 2 3\nusemtl glass green\nf 1 2 3\ng g\nusemtl meshlab\nf 2 3 1\n" +
                             "usemtl unused\nusemtl glass green\nf 3 1 2\nusemtl tr\nf 1 2 3\n" +
                             "usemtl halo\nf 1 2 3\n");
  std::vector<std::string> names;
  std::vector<float> opacities;
  std::vector<std::size_t> sizes;
  for (const Primitive& primitive : model.primitives) {
    names.push_back(primitive.material_name);
    opacities.push_back(primitive.base_color[3]);
    sizes.push_back(primitive.mesh.triangles.size());
  }
  EXPECT_THAT(names, ElementsAre("", "glass green", "meshlab", "tr", "halo"));
  EXPECT_THAT(opacities, ElementsAre(1.0F, 0.25F, 1.0F, 0.25F, 0.9F));
  EXPECT_THAT(sizes, ElementsAre(1, 2, 1, 1, 1));
  EXPECT_THAT(model.primitives[1].base_color, ElementsAre(0.1F, 0.8F, 0.2F, 0.25F));
  EXPECT_THAT(model.primitives[3].base_color, ElementsAre(0.5F, 0.5F, 0.5F, 0.25F));
  EXPECT_EQ(model.primitives[1].name, "one#1");
  EXPECT_EQ(model.instances[1].node_name, "one#1");
  EXPECT_EQ(model.instances[4].primitive, 4U);
  EXPECT_THAT(model.notes,
              ElementsAre("material file 'missing.mtl' cannot be read; default colours are used"));
}

TEST(Obj, IgnoresDevicesAsMaterialFiles) {
  const Model model = read_text("d.obj", "mtllib /dev/zero\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(model.notes, ElementsAre(HasSubstr("'/dev/zero' cannot be read")));
}

TEST(Obj, WhatIsNotDrawnIsNoted) {
  const Model model = read_text("l.obj", "v 0 0 0\nv 1 0 0\nl 1 2\np 1\nf 1 2\nsurf 0 1 0 1 1\n");
  EXPECT_TRUE(model.primitives.at(0).mesh.triangles.empty());
  EXPECT_THAT(model.notes,
              ElementsAre("1 face with fewer than 3 corners left out", "2 line or point statements left out",
                          "1 free-form curve or surface left out"));
}

// --------------------------------------------------------------------------------------------------- STL

constexpr std::string_view kAsciiStl =
    "solid my part\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 1 1 0\n "
    "endloop\nendfacet\n"
    "FACET NORMAL 0 0 1\n OUTER LOOP\n  VERTEX -0 0 0\n  VERTEX 1 1 0\n  VERTEX 0 1 0\n ENDLOOP\nENDFACET\n"
    "endsolid my part\nsolid two\nendsolid\n";

TEST(Stl, WeldsCornersOfTextAndKeepsItsName) {
  const Model model = read_text("a.stl", kAsciiStl);
  EXPECT_EQ(model.format, "stl");
  EXPECT_EQ(model.primitives.at(0).name, "my part");
  EXPECT_EQ(model.primitives[0].mesh.positions, kSquare);
  EXPECT_THAT(model.primitives[0].mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
}

TEST(Stl, RecognisesBinaryThatBeginsWithSolid) {
  for (const char* header : {"exported", "solid thing", "solid\n facet"}) {
    const Mesh mesh = mesh_of("b.stl", binary_stl(header, 2, 2));
    EXPECT_EQ(mesh.triangles.size(), 2U) << header;
    EXPECT_EQ(mesh.positions.size(), 4U) << header;
  }
  EXPECT_TRUE(mesh_of("e.stl", binary_stl("empty", 0, 0)).triangles.empty());
}

TEST(Stl, TrailingBytesAreNoted) {
  const Model model = read_text("t.stl", binary_stl("x", 1, 2));
  EXPECT_EQ(model.primitives.at(0).mesh.triangles.size(), 1U);
  EXPECT_THAT(model.notes, ElementsAre("data after the last triangle left out"));
}

// --------------------------------------------------------------------------------------------------- OFF

TEST(Off, ReadsHeadersCommentsColoursAndNormals) {
  const std::string faces = "# faces\n4 0 1 2 3 255 0 0\n";
  for (const std::string& content :
       {"OFF\n4 1 0\n0 0 0\n1 0 0 # corner\n\n1 1 0\n0 1 0\n" + faces,
        "OFF 4 1\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n" + faces, "OFF4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n" + faces,
        "# first\n4 1 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n" + faces,
        "COFF\n4 1 0\n0 0 0 255 0 0 255\n1 0 0 1 1 1\n1 1 0\n0 1 0 0.5 0.5 0.5 1\n" + faces,
        "STOFF\n4 1 0\n0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n" + faces}) {
    const Mesh mesh = mesh_of("o.off", content);
    EXPECT_EQ(mesh.positions, kSquare) << content;
    EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3})) << content;
    EXPECT_THAT(mesh.normals, IsEmpty());
  }
  const Mesh with_normals =
      mesh_of("n.off", "CNOFF\n3 1 0\n0 0 0 0 0 2 255 0 0\n1 0 0 0 1 0 0 0 0\n0 1 0 0 0 0 1 1 1\n3 0 1 2\n");
  EXPECT_THAT(with_normals.normals, ElementsAre(Vec3f{0, 0, 1}, Vec3f{0, 1, 0}, Vec3f{0, 0, 1}));
}

// ---------------------------------------------------------------------------------------------- polygons

std::string off_polygon(const std::vector<std::array<float, 2>>& points) {
  std::string text = "OFF\n" + std::to_string(points.size()) + " 1 0\n";
  for (const auto& p : points) text += "0.25 " + std::to_string(p[0]) + " " + std::to_string(p[1]) + "\n";
  text += std::to_string(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) text.append(1, ' ').append(std::to_string(i));
  return text + "\n";
}

double area_of(const Mesh& mesh, bool absolute) {
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = to_double(mesh.positions[t[0]]);
    const double part = cross(to_double(mesh.positions[t[1]]) - a, to_double(mesh.positions[t[2]]) - a).x / 2;
    area += absolute ? std::fabs(part) : part;
  }
  return area;
}

TEST(Polygon, ConcaveQuadIsSplitWhereBothHalvesAgree) {
  // The fan from the first corner would cover ground outside the dart.
  const Mesh dart = mesh_of("q.off", off_polygon({{0, 0}, {-1, -1}, {2, 0}, {-1, 1}}));
  EXPECT_EQ(dart.triangles.size(), 2U);
  EXPECT_DOUBLE_EQ(area_of(dart, false), area_of(dart, true));
  const Mesh other = mesh_of("q.off", off_polygon({{-1, 1}, {0, 0}, {-1, -1}, {2, 0}}));
  EXPECT_DOUBLE_EQ(area_of(other, false), area_of(other, true));
}

// Star-shaped random polygons: no triangle of a right triangulation is turned over, and the areas add up.
TEST(Polygon, EarClippingCoversConcavePolygonsExactly) {
  Random random(31);
  for (int round = 0; round < 60; ++round) {
    const std::size_t corners = 5 + random.below(40);
    std::vector<std::array<float, 2>> points;
    double expected = 0;
    for (std::size_t i = 0; i < corners; ++i) {
      const double angle = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(corners);
      const double radius = random.uniform(0.2, 1.0);
      points.push_back(
          {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle))});
    }
    for (std::size_t i = 0; i < corners; ++i) {
      const auto& p = points[i];
      const auto& q = points[(i + 1) % corners];
      expected += (static_cast<double>(p[0]) * q[1] - static_cast<double>(q[0]) * p[1]) / 2;
    }
    const Mesh mesh = mesh_of("p.off", off_polygon(points));
    ASSERT_EQ(mesh.triangles.size(), corners - 2);
    ASSERT_NEAR(area_of(mesh, false), expected, 1e-4);
    ASSERT_NEAR(area_of(mesh, true), expected, 1e-4);
  }
}

TEST(Polygon, AlwaysHasTwoTrianglesLessThanCorners) {
  // Cutting itself, without area, with NaN, and too large for ear clipping.
  EXPECT_EQ(
      mesh_of("p.off", off_polygon({{0, 0}, {1, 1}, {1, 0}, {0, 1}, {0.5F, 3}, {0.4F, -3}})).triangles.size(),
      4U);
  EXPECT_EQ(mesh_of("p.off", off_polygon({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}})).triangles.size(), 3U);
  EXPECT_EQ(mesh_of("p.off", off_polygon({{0, 0}, {1, 0}, {NAN, 0}, {3, 0}, {4, 0}})).triangles.size(), 3U);
  std::vector<std::array<float, 2>> comb;
  for (int i = 0; i < 5000; ++i) comb.push_back({static_cast<float>(i), i % 2 == 0 ? 1.0F : 0.5F});
  EXPECT_EQ(mesh_of("p.off", off_polygon(comb)).triangles.size(), 4998U);
}

// -------------------------------------------------------------------------------------------- dev models

struct DevModel {
  std::string file;
  std::uint64_t triangles;
};

void PrintTo(const DevModel& model, std::ostream* out) {
  *out << model.file;
}

class DevModels : public testing::TestWithParam<DevModel> {};

TEST_P(DevModels, HasTheTrianglesItsTableStates) {
  const std::string path = std::string(PELLUCID_MODELS) + "/" + GetParam().file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "development model missing: " << path;
  std::uint64_t triangles = 0;
  for (const Primitive& primitive : read_model(path).primitives) {
    EXPECT_EQ(check(primitive.mesh).out_of_range, 0U);
    triangles += primitive.mesh.triangles.size();
  }
  EXPECT_EQ(triangles, GetParam().triangles);
}

INSTANTIATE_TEST_SUITE_P(
    Files, DevModels,
    testing::Values(
        DevModel{"static/stanford_bunny_69k.obj", 69451}, DevModel{"static/bunny_10k.obj", 10000},
        DevModel{"static/dragon_11k.ply", 11102}, DevModel{"static/dragon_20k.obj", 20000},
        DevModel{"static/dragon_48k.ply", 47794}, DevModel{"static/dragon_871k.ply", 871414},
        DevModel{"static/feline_10k.obj", 10000}, DevModel{"static/fandisk_13k.obj", 12946},
        DevModel{"static/fandisk_32k.obj", 31682}, DevModel{"static/armadillo_52k.obj", 52000},
        DevModel{"static/rocker_arm_20k.obj", 20088}, DevModel{"static/anchor_8k.obj", 7598},
        DevModel{"static/turbine_18k.obj", 18460}, DevModel{"static/mech_holes_shark_10k.obj", 10192},
        DevModel{"static/camelhead_23k.obj", 22704}, DevModel{"static/lilium_7k.obj", 6590},
        DevModel{"static/teapot_6k.obj", 6320}, DevModel{"static/fuze_bottle_1k.obj", 1000},
        DevModel{"static/motorbike_332k.ply", 331653}, DevModel{"scenes/chandelier-lamp.obj", 133112},
        DevModel{"scenes/kitchenblender.obj", 108232}, DevModel{"scenes/flacon.obj", 10648},
        DevModel{"scenes/beerGlass.obj", 9836}, DevModel{"scenes/red-wine-bottle-01.obj", 6668},
        DevModel{"scenes/concept-sedan-02.obj", 124188}, DevModel{"scenes/copperBeech.obj", 187308}),
    [](const testing::TestParamInfo<DevModel>& model) {
      std::string name = std::filesystem::path(model.param.file).stem().string();
      std::replace(name.begin(), name.end(), '-', '_');
      return name;
    });

TEST(DevModels, TakesTheTransparencyOfOneOfMeshlabAsOpaque) {
  const std::string path = std::string(PELLUCID_MODELS) + "/static/fuze_bottle_1k.obj";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "development model missing: " << path;
  EXPECT_EQ(read_model(path).primitives.at(0).base_color[3], 1.0F);
}

}  // namespace
}  // namespace pellucid
