// Tests what every text reader accepts: byte order marks, all line ends, words that other programs write,
// quoted names; and the attributes that PLY, OBJ and OFF keep.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>

#include "foreign_files.h"
#include "pellucid/material.h"

namespace pellucid {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// ------------------------------------------------------------------------------- all formats, all line ends

struct TextFile {
  std::string name, content;  // with LF
};

// Two triangles in every format that has text.
const std::vector<TextFile>& text_files() {
  static const std::vector<TextFile> kFiles{
      {"a.obj", "# two faces\nv 0 0 0\nv 1 0 0 # first\nv 1 1 0\nv 0 1 0\nf 1 2 \\\n3\n# last\nf 1 3 4\n"},
      {"a.off", "OFF\n# two faces\n4 2 0\n0 0 0\n1 0 0\n1 1 0 # end\n0 1 0\n3 0 1 2\n3 0 2 3\n"},
      {"a.stl",
       "solid two faces\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\n"
       "endfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 "
       "0\nendloop\nendfacet\n"
       "endsolid two faces\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\ncomment two faces\nelement vertex 4\nproperty float x\nproperty float y\n"
       "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
       "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"}};
  return kFiles;
}

std::string with_line_ends(const std::string& text, const std::function<std::string(int line)>& end) {
  std::string result;
  int line = 0;
  for (const char c : text) result += c == '\n' ? end(line++) : std::string(1, c);
  return result;
}

TEST(OddText, EveryLineEndAndAByteOrderMarkGiveTheSameMesh) {
  const std::vector<std::function<std::string(int)>> ends{
      [](int) { return "\n"; }, [](int) { return "\r\n"; }, [](int) { return "\r"; },
      [](int line) { return line % 3 == 0   ? "\r"
                            : line % 3 == 1 ? "\n"
                                            : "\r\n"; }};
  for (const TextFile& file : text_files()) {
    const Mesh expected = mesh_of(file.name, file.content);
    ASSERT_EQ(expected.triangles.size(), 2U) << file.name;
    for (std::size_t e = 0; e < ends.size(); ++e) {
      for (const char* mark : {"", "\xEF\xBB\xBF"}) {
        const Mesh mesh = mesh_of(file.name, mark + with_line_ends(file.content, ends[e]));
        EXPECT_EQ(mesh.positions, expected.positions) << file.name << " line ends " << e;
        EXPECT_EQ(mesh.triangles, expected.triangles) << file.name << " line ends " << e;
      }
    }
  }
}

TEST(OddText, Utf16IsRefusedByName) {
  for (const TextFile& file : text_files()) {
    if (file.name == "a.ply" || file.name == "a.stl") continue;  // not recognised as text at all
    EXPECT_THAT(complaint(file.name, "\xFF\xFE" + file.content), HasSubstr("UTF-16")) << file.name;
  }
}

TEST(OddText, LineNumbersCountEveryLineEnd) {
  EXPECT_THAT(complaint("a.obj", "v 0 0 0\rv 1 0 0\r\nv 1 x 0\n"), HasSubstr("line 3"));
}

TEST(OddText, ABinaryBodyBeginsAfterTheLineEndOfItsHeader) {
  // The first byte of the body is a line feed: the low byte of 10.
  for (const char* end : {"\n", "\r\n", "\r"}) {
    const std::string header = with_line_ends(
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty short x\nproperty short y\n"
        "property short z\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n",
        [&](int) { return end; });
    ByteWriter body(false);
    for (const int coordinate : {10, 0, 0, 0, 1, 0, 0, 0, 1}) body.put(static_cast<std::int16_t>(coordinate));
    for (const int byte : {3, 0, 1, 2}) body.put(static_cast<std::uint8_t>(byte));
    const Mesh mesh = mesh_of("b.ply", header + body.bytes());
    ASSERT_EQ(mesh.positions.size(), 3U);
    EXPECT_EQ(mesh.positions[0], (Vec3f{10, 0, 0})) << static_cast<int>(*end);
  }
}

TEST(OddText, WordsOfOldWindowsProgramsAreNumbers) {
  for (const char* word :
       {"1.#INF", "-1.#INF00", "1.#IND", "-1.#IND", "1.#QNAN", "1.#SNAN0", "1.#J", "nan(ind)"}) {
    const Mesh mesh = mesh_of("n.obj", std::string("v ") + word + " 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
    EXPECT_FALSE(std::isfinite(mesh.positions.at(0).x)) << word;
  }
  EXPECT_THAT(complaint("n.obj", "v 1.#X 0 0\n"), HasSubstr("expected a coordinate"));
}

TEST(OddText, ValuesThatNobodyUsesMayBeAnything) {
  const auto count = [](const std::string& name, const std::string& content) {
    return mesh_of(name, content).triangles.size();
  };
  EXPECT_EQ(count("u.stl",
                  "solid\nfacet normal ? - 1.#X\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                  "vertex 0 1 0\nendloop\nendfacet\nendsolid\n"),
            1U);
  EXPECT_EQ(count("u.obj", "v 0 0 0 weight\nv 1 0 0\nv 0 1 0\nvt a b\nvn ? ? ?\nf 1/1/1 2/1/1 3/1/1\n"), 1U);
  EXPECT_EQ(count("u.ply",
                  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                  "property float z\nproperty float quality\nelement face 1\n"
                  "property list uchar int vertex_indices\nproperty list uchar float wear\nend_header\n"
                  "0 0 0 -1.#IND\n1 0 0 none\n0 1 0 ?\n3 0 1 2 2 x y\n"),
            1U);
  EXPECT_EQ(count("u.off", "OFF\n3 1 0\n0 0 0 x\n1 0 0\n0 1 0\n3 0 1 2 red\n"), 1U);
}

TEST(OddText, StlKeywordsMayBeGluedOrApart) {
  for (const char* text : {"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
                           "0\nendloop\nendfacet\n"
                           "endsolida\n",
                           "SOLIDa\nFACETNORMAL 0 0 1\nOUTERLOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 "
                           "0\nEND LOOP\nEND FACET\n"
                           "END SOLID a\n"}) {
    EXPECT_EQ(mesh_of("k.stl", text).triangles.size(), 1U) << text;
  }
  EXPECT_THAT(complaint("k.stl", "solid\nfacet normal 0 0 1\nvertex 0 0 0\n"), HasSubstr("'outer loop'"));
  EXPECT_THAT(complaint("k.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendsolid\n"),
              HasSubstr("'end loop'"));
}

// ------------------------------------------------------------------------------------------ names of files

TEST(OddText, QuotedNamesAndNamesOfWindowsAreFound) {
  const TemporaryModel materials("my Glass.mtl", "newmtl \"clear glass\"\rKd 0 0.5 1\rd 0.25\r");
  const std::string name = std::filesystem::path(materials.path()).filename().string();
  std::string upper = name;
  for (char& c : upper) c = c == 'G' ? 'g' : c;
  for (const std::string& written :
       {"\"" + name + "\"", name, "C:\\models\\" + name, "other.mtl \"" + upper + "\""}) {
    const Model model = read_text(
        "q.obj", "mtllib " + written + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl clear glass\nf 1 2 3\n");
    EXPECT_FLOAT_EQ(model.primitives.at(0).base_color[3], 0.25F) << written;
    EXPECT_EQ(model.primitives[0].alpha_mode, AlphaMode::blend);
  }
}

TEST(OddText, AMaterialThatNoFileDescribesIsNoted) {
  const Model model = read_text("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl steel\nf 1 2 3\n");
  EXPECT_THAT(model.notes, ElementsAre(HasSubstr("no material file describes 'steel'")));
}

// ---------------------------------------------------------------------------------------------- attributes

constexpr float kMiddleGrey = 0.2158605F;  // linear, of 0.5 = 128 / 255 sRGB

TEST(Attributes, VertexColoursOfEveryFormatBecomeLinear) {
  const std::string faces = "3 0 1 2\n";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string ply_end = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::vector<TextFile> files{
      {"c.ply", ply +
                    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n" +
                    ply_end + "0 0 0 255 128 0 51\n1 0 0 255 128 0 51\n0 1 0 255 128 0 51\n" + faces},
      {"c.ply",
       ply + "property float red\nproperty float green\nproperty float blue\nproperty float alpha\n" +
           ply_end + "0 0 0 1 0.50196 0 0.2\n1 0 0 1 0.50196 0 0.2\n0 1 0 1 0.50196 0 0.2\n" + faces},
      {"c.obj", "v 0 0 0 255 128 0 51\nv 1 0 0 255 128 0 51\nv 0 1 0 255 128 0 51\nf 1 2 3\n"},
      {"c.obj", "v 0 0 0 1 0.50196 0 0.2\nv 1 0 0 1 0.50196 0 0.2\nv 0 1 0 1 0.50196 0 0.2\nf 1 2 3\n"},
      {"c.off", "COFF\n3 1 0\n0 0 0 255 128 0 51\n1 0 0 255 128 0 51\n0 1 0 255 128 0 51\n" + faces},
      {"c.off",
       "COFF\n3 1 0\n0 0 0 1 0.50196 0 0.2\n1 0 0 1 0.50196 0 0.2\n0 1 0 1 0.50196 0 0.2\n" + faces}};
  for (const TextFile& file : files) {
    const Model model = read_text(file.name, file.content);
    const Primitive& primitive = model.primitives.at(0);
    ASSERT_EQ(primitive.colors.size(), 3U) << file.content;
    for (const auto& color : primitive.colors) {
      EXPECT_NEAR(color[0], 1, 1e-6) << file.content;
      EXPECT_NEAR(color[1], kMiddleGrey, 1e-4) << file.content;
      EXPECT_NEAR(color[2], 0, 1e-6) << file.content;
      EXPECT_NEAR(color[3], 0.2, 1e-5) << file.content;
    }
    EXPECT_EQ(primitive.alpha_mode, AlphaMode::blend);
    EXPECT_TRUE(is_known_translucent(model, primitive));
  }
}

TEST(Attributes, ColoursThatAreIntegersAreBytes) {
  const Model model = read_text(
      "i.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property int red\nproperty int green\nproperty int blue\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0 255 128 0\n1 0 0 255 128 0\n"
      "0 1 0 255 128 0\n3 0 1 2\n");
  EXPECT_NEAR(model.primitives.at(0).colors.at(0)[0], 1, 1e-6);
  EXPECT_NEAR(model.primitives[0].colors[0][1], kMiddleGrey, 1e-4);
  EXPECT_EQ(model.primitives[0].colors[0][3], 1);
  // A vertex without a colour beside others is white.
  const Model partly = read_text("p.obj", "v 0 0 0\nv 1 0 0 255 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(partly.primitives.at(0).colors.at(0), (std::array<float, 4>{1, 1, 1, 1}));
  EXPECT_EQ(partly.primitives[0].colors[2], (std::array<float, 4>{1, 1, 1, 1}));
}

TEST(Attributes, TextureCoordinatesArriveInTheWrittenFile) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::vector<TextFile> files{
      {"t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0.25\nvt 0.5 1\nf 1/1 2/2 3/3\n"},
      {"t.off", "STOFF\n3 1 0\n0 0 0 0 0\n1 0 0 1 0.25\n0 1 0 0.5 1\n3 0 1 2\n"},
      {"t.ply",
       ply + "property float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\n"
             "end_header\n0 0 0 0 0\n1 0 0 1 0.25\n0 1 0 0.5 1\n3 0 1 2\n"},
      {"t.ply",
       ply + "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
             "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0.25 0.5 1\n"}};
  for (const TextFile& file : files) {
    const Model model = read_text(file.name, file.content);
    EXPECT_THAT(model.primitives.at(0).texcoords,
                ElementsAre(std::array<float, 2>{0, 1}, std::array<float, 2>{1, 0.75F},
                            std::array<float, 2>{0.5F, 0}))
        << file.content;
  }
}

TEST(Attributes, ASeamGivesACornerOfEachSideItsOwnVertex) {
  const Model model = read_text(
      "s.obj",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0.5 0\nf 1/1 2/2 3/3\nf 1/4 3/3 4/1\n");
  EXPECT_EQ(model.primitives.at(0).mesh.positions.size(), 5U);
}

TEST(Attributes, WhatIsLeftOutIsNoted) {
  EXPECT_THAT(read_text("f.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n").notes,
              ElementsAre("colours of faces left out"));
  EXPECT_THAT(
      read_text("f.ply",
                "ply\nformat ascii 1.0\ncomment TextureFile none.png\nelement vertex 3\nproperty float x\n"
                "property float y\nproperty float z\nproperty float s\nproperty float t\nelement face 1\n"
                "property list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
                "property uchar blue\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2 9 9 9\n")
          .notes,
      ElementsAre(HasSubstr("'none.png' is missing"), "colours of faces left out"));
}

TEST(Attributes, OpacityDecidesTheAlphaMode) {
  const TemporaryModel materials("modes.mtl", "newmtl body\nd 1\nnewmtl window\nTr 0.7\n");
  const Model model =
      read_text("m.obj", "mtllib " + std::filesystem::path(materials.path()).filename().string() +
                             "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl body\nf 1 2 3\nusemtl window\nf 3 2 1\n");
  ASSERT_EQ(model.primitives.size(), 2U);
  EXPECT_EQ(model.primitives[0].alpha_mode, AlphaMode::opaque);
  EXPECT_EQ(model.primitives[1].alpha_mode, AlphaMode::blend);
  EXPECT_FALSE(is_known_translucent(model, model.primitives[0]));
  EXPECT_TRUE(is_known_translucent(model, model.primitives[1]));
  // A mesh without a material says nothing: it is a translucent sheet for `order`, and opaque for `overdraw`.
  const Model plain = read_text("p.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(plain.primitives.at(0).alpha_mode, AlphaMode::blend);
  EXPECT_FALSE(is_known_translucent(plain, plain.primitives[0]));
}

// ------------------------------------------------------------------------------------------------ polygons

using Outline = std::vector<std::array<float, 2>>;

// Reads a polygon whose corners are vertices of their own, and expects that its triangles cover its area
// exactly: none is turned over, and their areas add up.
void expect_exact_cover(const Outline& points, const std::string& what) {
  std::string text = "OFF\n" + std::to_string(points.size()) + " 1 0\n";
  double expected = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    char line[64];
    std::snprintf(line, sizeof line, "%.9g %.9g 0\n", static_cast<double>(points[i][0]),
                  static_cast<double>(points[i][1]));
    text += line;
    const auto& q = points[(i + 1) % points.size()];
    expected += (static_cast<double>(points[i][0]) * q[1] - static_cast<double>(q[0]) * points[i][1]) / 2;
  }
  text += std::to_string(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) text += " " + std::to_string(i);
  const Mesh mesh = mesh_of("p.off", text + "\n");
  ASSERT_EQ(mesh.triangles.size(), points.size() - 2) << what;
  double area = 0, absolute = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = to_double(mesh.positions[t[0]]);
    const double part = cross(to_double(mesh.positions[t[1]]) - a, to_double(mesh.positions[t[2]]) - a).z / 2;
    area += part;
    absolute += std::fabs(part);
  }
  EXPECT_NEAR(area, expected, 1e-9 * std::fabs(expected)) << what;
  EXPECT_NEAR(absolute, std::fabs(expected), 1e-9 * std::fabs(expected)) << what;
}

TEST(Polygon, CombsAndSpiralsOfAnySizeAreCoveredExactly) {
  for (const int teeth : {3, 50, 3000, 20000}) {
    Outline comb{{static_cast<float>(teeth), -1}, {static_cast<float>(teeth), 0}};
    for (int i = teeth - 1; i >= 0; --i) {
      comb.push_back({static_cast<float>(i) + 0.5F, 5});
      comb.push_back({static_cast<float>(i), 0});
    }
    comb.push_back({0, -1});
    expect_exact_cover(comb, "comb of " + std::to_string(teeth));
  }
  Outline spiral;
  constexpr int kTurns = 400;
  for (int i = 0; i < kTurns; ++i) {
    const double angle = 0.3 * i, radius = 1 + 0.1 * i;
    spiral.push_back(
        {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle))});
  }
  for (int i = kTurns - 1; i >= 0; --i) {
    const double angle = 0.3 * i, radius = 0.9 + 0.1 * i;
    spiral.push_back(
        {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle))});
  }
  expect_exact_cover(spiral, "spiral");
}

TEST(Polygon, DoubledCornersHideNoTurn) {
  Outline dart{{0, 0}, {3, 0}, {1, 1}, {1, 1}, {0, 3}};
  for (std::size_t first = 0; first < dart.size(); ++first) {
    expect_exact_cover(dart, "rotation " + std::to_string(first));
    std::rotate(dart.begin(), dart.begin() + 1, dart.end());
  }
}

TEST(Polygon, HolesJoinedByBridgesAreCoveredExactly) {
  // A square with a row of square holes; each is joined to the one before by an edge that is walked twice.
  for (const int holes : {1, 2, 7, 60}) {
    const auto width = static_cast<float>(2 * holes + 1);
    Outline simple{{0, 0}, {width, 0}, {width, 3}, {0, 3}, {0, 0}};
    simple.push_back({1, 1});
    for (const auto& p : {std::array<float, 2>{1, 2}, {2, 2}, {2, 1}, {1, 1}}) simple.push_back(p);
    expect_exact_cover(simple, "one hole");
    // Several holes, each joined to the lower edge of the outline by a bridge of its own.
    Outline many{{0, 0}};
    for (int h = 0; h < holes; ++h) {
      const auto x = static_cast<float>(2 * h + 1);
      for (const auto& p :
           {std::array<float, 2>{x, 0}, {x, 1}, {x, 2}, {x + 1, 2}, {x + 1, 1}, {x, 1}, {x, 0}})
        many.push_back(p);
    }
    many.push_back({width, 0});
    many.push_back({width, 3});
    many.push_back({0, 3});
    expect_exact_cover(many, std::to_string(holes) + " holes");
  }
}

}  // namespace
}  // namespace pellucid
