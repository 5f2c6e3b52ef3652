// Tests damaged and hostile PLY, OBJ, STL and OFF files: every error message with its place, and thousands of
// files that are damaged at random.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foreign_files.h"

namespace pellucid {
namespace {

const std::string kPlyVertices =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kPlyFaces = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string kTriangle = "0 0 0\n1 0 0\n0 1 0\n";

TEST(HostilePly, NamesTheLineOfABadHeader) {
  EXPECT_EQ(complaint("a.ply", ""), ": the file is empty");
  EXPECT_EQ(complaint("a.ply", "plywood\n"), ": not a PLY file");
  EXPECT_EQ(complaint("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"),
            ": the PLY header has no end (end_header is missing)");
  EXPECT_EQ(complaint("a.ply", "ply\nelement vertex 0\nend_header\n"),
            ": line 3: the PLY header has no format line");
  EXPECT_EQ(complaint("a.ply", "ply\nformat middle_endian 1.0\n"),
            ": line 2: unknown PLY format 'middle_endian'");
  EXPECT_EQ(complaint("a.ply", "ply\nformat ascii 1.0\nelement vertex -3\n"),
            ": line 3: bad element count '-3'");
  EXPECT_EQ(complaint("a.ply", "ply\nformat ascii 1.0\nelement vertex 99999999999999999999\n"),
            ": line 3: bad element count '99999999999999999999'");
  EXPECT_EQ(complaint("a.ply", "ply\nformat ascii 1.0\nproperty float x\n"),
            ": line 3: the property stands before any element");
  EXPECT_EQ(complaint("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty quaternion x\n"),
            ": line 4: unknown property type 'quaternion'");
  EXPECT_EQ(complaint("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty list float int x\n"),
            ": line 4: a list's count must be an integer type");
  EXPECT_EQ(complaint("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float\n"),
            ": line 4: the property has no name");
  EXPECT_EQ(complaint("a.ply", "ply\nformat ascii 1.0\n\x01\x02garbage\n"),
            ": line 3: unknown word '\?\?garbage' in the PLY header");
  EXPECT_EQ(complaint("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n"),
            ": the vertices have no property y");
  EXPECT_EQ(complaint("a.ply", "ply\nformat ascii 1.0\nend_header\n"), ": there is no element 'vertex'");
  EXPECT_EQ(complaint("a.ply", kPlyVertices + "element face 1\nproperty int material\nend_header\n" +
                                   kTriangle + "1\n"),
            ": the element 'face' has no list vertex_indices or vertex_index");
}

TEST(HostilePly, RefusesCountsThatTheFileCannotHold) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n";
  EXPECT_EQ(complaint("a.ply", header + "property float z\nend_header\n" + kTriangle),
            ": the header declares 4000000000 vertices, but the file has room for at most 3");
  EXPECT_EQ(
      complaint("a.ply", kPlyVertices +
                             "element face 123456789012345678\nproperty list uchar int vertex_indices\n" +
                             "end_header\n" + kTriangle + "3 0 1 2\n"),
      ": the header declares 123456789012345678 faces, but the file has room for at most 5");
  EXPECT_EQ(complaint("a.ply", kPlyVertices + kPlyFaces + "end_header\n" + kTriangle + "4000000000 0 1 2\n"),
            ": face 1 of 1 is cut off (the file ends at line 13)");
  EXPECT_EQ(complaint("a.ply", kPlyVertices + kPlyFaces + "end_header\n" + kTriangle + "-3 0 1 2\n"),
            ": line 13: the length of the list is not a whole number");
  EXPECT_EQ(complaint("a.ply", kPlyVertices + kPlyFaces + "end_header\n" + kTriangle + "3 0 1 2\n",
                      {.max_elements = 2}),
            ": 3 vertices; the limit is 2");
  // Elements without properties take no memory and no time.
  EXPECT_EQ(mesh_of("a.ply", kPlyVertices + "element nothing 9000000000000000000\n" + kPlyFaces +
                                 "end_header\n" + kTriangle + "3 0 1 2\n")
                .triangles.size(),
            1U);
}

TEST(HostilePly, NamesElementAndPlaceInTheBody) {
  EXPECT_EQ(complaint("a.ply", kPlyVertices + "end_header\n0.123 0.123 0.123\n1 0 0\n0 1\n"),
            ": vertex 3 of 3 is cut off (the file ends at line 11)");
  EXPECT_EQ(complaint("a.ply", kPlyVertices + "end_header\n0 0 0\n1 zero 0\n0 1 0\n"),
            ": line 9: vertex 2 of 3: expected a number, found 'zero'");
  EXPECT_EQ(complaint("a.ply", kPlyVertices + kPlyFaces + "end_header\n" + kTriangle + "3 0 1 3\n"),
            ": face 1 of 1: index 3 is out of range (there are 3 positions)");
  EXPECT_EQ(complaint("a.ply", kPlyVertices + kPlyFaces + "end_header\n" + kTriangle + "3 0 -1 2\n"),
            ": face 1 of 1: index -1 is out of range (there are 3 positions)");
  ByteWriter out(false);
  for (int i = 0; i < 35; ++i) out.put(1.0F);
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 10\nproperty float x\nproperty float y\n"
      "property list uchar float weights\nproperty float z\nend_header\n";
  EXPECT_THAT(complaint("a.ply", header + out.bytes()),
              testing::HasSubstr("of 10 is cut off (the file ends at byte "));
}

TEST(HostileObj, NamesTheLine) {
  EXPECT_EQ(complaint("a.obj", ""), ": the file is empty");
  EXPECT_EQ(complaint("a.obj",
                      "\x7f"
                      "ELF\x01\x02\nwhatever\n"),
            ": not an OBJ file, or one without vertices");
  EXPECT_EQ(complaint("a.obj", "v 0 0\n"), ": line 1: the line ends where a coordinate should be");
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(complaint("a.obj", vertices + "f 1 2 3\nf 1 2 4\nf 1 2 3\n"),
            ": line 5: index 4 is out of range (there are 3 positions)");
  EXPECT_EQ(complaint("a.obj", vertices + "f 1//1 2//1 3//1\n"),
            ": line 4: index 1 is out of range (there are 0 normals)");
  EXPECT_EQ(complaint("a.obj", vertices + "f 1 2 -4\n"), ": line 4: index -4 in '-4' is out of range");
  EXPECT_EQ(complaint("a.obj", vertices + "f 1 2 0\n"), ": line 4: index 0 in '0': indices begin at 1");
  EXPECT_EQ(complaint("a.obj", vertices + "f 1 2 9999999999\n"),
            ": line 4: index 9999999999 in '9999999999' is out of range");
  EXPECT_EQ(complaint("a.obj", vertices + "f 1 two/2 3\n"),
            ": line 4: expected a face's corner, found 'two/2'");
  EXPECT_EQ(complaint("a.obj", vertices + "f 1 2 3\n", {.max_elements = 2}), ": 3 vertices; the limit is 2");
  std::string materials = vertices;
  for (int i = 0; i < 65537; ++i) materials += "usemtl " + std::to_string(i) + "\nf 1 2 3\n";
  EXPECT_THAT(complaint("a.obj", materials), testing::HasSubstr("more than 65536 materials"));
}

TEST(HostileStl, SaysWhatIsMissing) {
  EXPECT_EQ(complaint("a.stl", ""), ": the file is empty");
  EXPECT_EQ(complaint("a.stl", "just text"), ": not an STL file");
  EXPECT_EQ(complaint("a.stl", std::string(300, 'x')), ": not an STL file");
  EXPECT_EQ(complaint("a.stl", binary_stl("cut", 3, 2)),
            ": the header declares 3 triangles in 234 bytes, but the file has 184");
  EXPECT_EQ(complaint("a.stl", binary_stl("solid but binary", 4000000000U, 1)),
            ": the header declares 4000000000 triangles in 200000000084 bytes, but the file has 134");
  EXPECT_EQ(complaint("a.stl", binary_stl("many", 2, 2), {.max_elements = 5}), ": 6 corners; the limit is 5");
  const std::string facet = "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
  EXPECT_EQ(complaint("a.stl", facet), ": line 6: the file ends where 'vertex' or 'endloop' should be");
  EXPECT_EQ(complaint("a.stl", facet + "vertex 0 one 0\n"), ": line 6: expected a coordinate, found 'one'");
  EXPECT_EQ(complaint("a.stl", facet + "endfacet\n"), ": line 6: expected 'end loop', found 'endfacet'");
  EXPECT_EQ(complaint("a.stl", "solid x\nfacet abnormal\n"),
            ": line 3: the file ends where 'outer loop' should be");
  EXPECT_EQ(complaint("a.stl", "solid x\n"), ": line 2: the file ends where 'facet' or 'endsolid' should be");
  EXPECT_EQ(complaint("a.stl", "solid x\nendsolid\nmore\n"), ": line 3: expected 'solid', found 'more'");
}

TEST(HostileOff, NamesTheLine) {
  EXPECT_EQ(complaint("a.off", ""), ": the file is empty");
  EXPECT_EQ(complaint("a.off", "# only a comment\n"), ": not an OFF file");
  EXPECT_EQ(complaint("a.off", "BOFF\n1 1 1\n"), ": not an OFF file");
  EXPECT_EQ(complaint("a.off", "4OFF\n1 1 1\n"),
            ": line 1: OFF files with more than three dimensions are not supported");
  EXPECT_EQ(complaint("a.off", "OFF BINARY\n"),
            ": line 1: binary OFF files are not supported; convert to PLY");
  EXPECT_EQ(complaint("a.off", "OFF\n3 x 0\n"), ": line 2: expected the number of faces, found 'x'");
  EXPECT_EQ(complaint("a.off", "OFF\n3 -1 0\n"), ": line 2: the number of faces is negative");
  EXPECT_EQ(complaint("a.off", "OFF\n4000000000 1 0\n" + kTriangle + "3 0 1 2\n"),
            ": the header declares 4000000000 vertices, but the file has room for at most 4");
  EXPECT_EQ(complaint("a.off", "OFF\n3 4000000000 0\n" + kTriangle + "3 0 1 2\n"),
            ": the header declares 4000000000 faces, but the file has room for at most 13");
  EXPECT_EQ(complaint("a.off", "OFF\n3 1 0\n0.00 0.00 0.00\n1 0 0\n"),
            ": vertex 3 of 3 is cut off (the file ends)");
  EXPECT_EQ(complaint("a.off", "OFF\n3 2 0\n" + kTriangle + "3 0 1 2\n"),
            ": face 2 of 2 is cut off (the file ends)");
  EXPECT_EQ(complaint("a.off", "OFF\n3 1 0\n" + kTriangle + "3 0 1 3\n"),
            ": line 6: face 1 of 1: index 3 is out of range (there are 3 positions)");
  EXPECT_EQ(complaint("a.off", "OFF\n3 1 0\n" + kTriangle + "99999 0 1 3\n"),
            ": the header declares 99999 corners of face 1, but the file has room for at most 4");
  EXPECT_EQ(complaint("a.off", "OFF\n3 1 0\n0 0 0\n1 0 zero\n0 1 0\n3 0 1 2\n"),
            ": line 4: expected a coordinate, found 'zero'");
}

// ------------------------------------------------------------------------------------------------ damage

std::string damaged(std::string content, Random& random) {
  if (random.below(4) == 0) content.resize(random.below(content.size()));
  const std::uint64_t flips = random.below(6);
  for (std::uint64_t i = 0; i < flips && !content.empty(); ++i) {
    char& c = content[random.below(content.size())];
    // Half of the damage stays text, so that it gets past the first word.
    constexpr std::string_view kText = "0123456789-+./# \n\\eEinf";
    c = random.below(2) == 0 ? static_cast<char>(random.below(256)) : kText[random.below(kText.size())];
  }
  return content;
}

class Damage : public testing::TestWithParam<std::pair<std::string, std::string>> {};

// Reads, or throws Error; never anything else. Every index of what was read is in range.
TEST_P(Damage, IsReadOrRefused) {
  const auto& [name, content] = GetParam();
  const TemporaryModel file("damage-" + name, content);
  ASSERT_EQ(read_model(file.path()).primitives.size(), 1U);
  Random random(2026);
  int refused = 0;
  constexpr int kRounds = 3000;
  for (int round = 0; round < kRounds; ++round) {
    file.write(damaged(content, random));
    try {
      for (const Primitive& primitive : read_model(file.path()).primitives) {
        ASSERT_EQ(check(primitive.mesh).out_of_range, 0U);
        ASSERT_TRUE(primitive.mesh.normals.empty() ||
                    primitive.mesh.normals.size() == primitive.mesh.positions.size());
      }
    } catch (const Error& error) {
      ASSERT_EQ(error.kind(), ErrorKind::bad_input);
      ++refused;
    }
  }
  EXPECT_GT(refused, kRounds / 20);
  EXPECT_LT(refused, kRounds * 19 / 20);
}

std::string binary_ply(bool big_endian) {
  ByteWriter out(big_endian);
  for (int i = 0; i < 8; ++i)
    out.put(static_cast<float>(i % 3))
        .put(static_cast<float>(i % 2))
        .put(1.0F / (1.0F + static_cast<float>(i)));
  for (int f = 0; f < 6; ++f)
    out.put(std::uint8_t{4}).put(f % 8).put((f + 1) % 8).put((f + 2) % 8).put((f + 3) % 8);
  return std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
         "_endian 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face "
         "6\n"
         "property list uchar int vertex_indices\nend_header\n" +
         out.bytes();
}

INSTANTIATE_TEST_SUITE_P(
    Formats, Damage,
    testing::Values(
        std::pair{"ascii.ply", kPlyVertices + "property float nx\nproperty float ny\nproperty float nz\n" +
                                   kPlyFaces +
                                   "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
                                   "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 1 0 0\n3 0 1 2\n7 0 1 2 -1 2 1 0\n"},
        std::pair{"little.ply", binary_ply(false)}, std::pair{"big.ply", binary_ply(true)},
        std::pair{"a.obj",
                  "mtllib none.mtl\no box\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 2 0\nvn 0 0 1\nvt 0 0\n"
                  "usemtl a\nf 1//1 2//1 3//1 4//1\nf -1/1/1 -2/1/1 \\\n -3/1/1 2/1/1 1/1/1\n"},
        std::pair{"ascii.stl",
                  "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1e-3 0\n"
                  "endloop\nendfacet\nendsolid x\n"},
        std::pair{"binary.stl", binary_stl("x", 4, 4)},
        std::pair{"a.off",
                  "NOFF\n5 2 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n.2 .5 0 0 0 1\n"
                  "5 0 1 2 3 4 # concave\n3 0 1 2 255 0 0\n"}));

}  // namespace
}  // namespace pellucid
