// Tests reading of glTF: every legal form of geometry gives the triangles that a viewer draws, and all other
// files are refused with a clear message.
#include <meshoptimizer.h>

#include "gltf_helpers.h"

namespace pellucid::test {
namespace {

using ::testing::Test;

Mesh read_mesh(const std::string& path) {
  return read_model(path).primitives.at(0).mesh;
}

std::vector<Triangle> triangles(std::initializer_list<Triangle> list) {
  return list;
}

// ------------------------------------------------------------------------------------------------ geometry

template <class Index>
class IndexTypes : public Test {};
using AllIndexTypes = ::testing::Types<std::uint8_t, std::uint16_t, std::uint32_t>;
TYPED_TEST_SUITE(IndexTypes, AllIndexTypes);

TYPED_TEST(IndexTypes, AreRead) {
  const TempFolder folder;
  HandMade file;
  file.set_positions(five_points());
  file.set_indices(std::vector<TypeParam>{0, 1, 2, 4, 3, 1});
  const Mesh mesh = read_mesh(file.save(folder / "a.glb"));
  EXPECT_EQ(mesh.triangles, triangles({{0, 1, 2}, {4, 3, 1}}));
  EXPECT_EQ(mesh.positions.at(3), (Vec3f{1, 1, 0.5F}));
}

TEST(GltfTopology, AssemblesStripsFansAndPlainVertices) {
  const TempFolder folder;
  HandMade file;
  file.set_positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0});
  EXPECT_EQ(read_mesh(file.save(folder / "list.glb")).triangles, triangles({{0, 1, 2}, {3, 4, 5}}));

  // The strip of the OpenGL specification: every second triangle swaps its last two corners.
  file.primitive()["mode"] = 5;
  EXPECT_EQ(read_mesh(file.save(folder / "strip.glb")).triangles,
            triangles({{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 5, 4}}));
  file.primitive()["mode"] = 6;
  EXPECT_EQ(read_mesh(file.save(folder / "fan.glb")).triangles,
            triangles({{1, 2, 0}, {2, 3, 0}, {3, 4, 0}, {4, 5, 0}}));
  for (const int mode : {0, 1, 2, 3}) {
    file.primitive()["mode"] = mode;
    EXPECT_FALSE(read_model(file.save(folder / "points.glb")).primitives.at(0).triangles);
  }
}

TEST(GltfAccessors, DecodesStridedAndNormalisedPositions) {
  const TempFolder folder;
  HandMade file;
  // Elements of 3 x int16, one int16 of padding: stride 8, first element at offset 8.
  file.set_indices(std::vector<std::uint16_t>{0, 1, 2});
  const std::size_t view =
      file.view(std::vector<std::int16_t>{9, 9, 9, 9, 32767, 0, -32768, 7, 1, 2, 3, 7, -5, 0, 16384, 7});
  file.json["bufferViews"][view]["byteStride"] = 8;
  const std::size_t accessor = file.accessor(view, 5122, 3, "VEC3");
  file.json["accessors"][accessor]["byteOffset"] = 8;
  file.primitive()["attributes"]["POSITION"] = accessor;
  EXPECT_EQ(read_mesh(file.save(folder / "raw.glb")).positions,
            (std::vector<Vec3f>{{32767, 0, -32768}, {1, 2, 3}, {-5, 0, 16384}}));
  file.json["accessors"][accessor]["normalized"] = true;
  const Mesh mesh = read_mesh(file.save(folder / "normalized.glb"));
  EXPECT_EQ(mesh.positions[0], (Vec3f{1, 0, -1}));
  EXPECT_FLOAT_EQ(mesh.positions[2].z, 16384.0F / 32767.0F);

  HandMade bytes;
  bytes.set_indices(std::vector<std::uint8_t>{0, 1, 2});
  const std::size_t byte_view = bytes.view(std::vector<std::int8_t>{-128, 127, 0, 0, 1, 2, 3, 0, 4, 5, 6, 0});
  bytes.json["bufferViews"][byte_view]["byteStride"] = 4;
  const std::size_t byte_accessor = bytes.accessor(byte_view, 5120, 3, "VEC3");
  bytes.json["accessors"][byte_accessor]["normalized"] = true;
  bytes.primitive()["attributes"]["POSITION"] = byte_accessor;
  EXPECT_EQ(read_mesh(bytes.save(folder / "bytes.glb")).positions[0], (Vec3f{-1, 1, 0}));
}

TEST(GltfAccessors, AppliesSparseValuesToDataAndToZeros) {
  const TempFolder folder;
  HandMade file = pyramid();
  Json sparse;
  sparse["count"] = 2;
  sparse["indices"] = {{"bufferView", file.view(std::vector<std::uint8_t>{1, 4})}, {"componentType", 5121}};
  sparse["values"] = {{"bufferView", file.view(std::vector<float>{7, 8, 9, -1, -2, -3})}};
  file.json["accessors"][0]["sparse"] = sparse;
  Mesh mesh = read_mesh(file.save(folder / "a.glb"));
  EXPECT_EQ(mesh.positions[0], (Vec3f{0, 0, 0}));
  EXPECT_EQ(mesh.positions[1], (Vec3f{7, 8, 9}));
  EXPECT_EQ(mesh.positions[3], (Vec3f{1, 1, 0.5F}));
  EXPECT_EQ(mesh.positions[4], (Vec3f{-1, -2, -3}));

  file.json["accessors"][0].erase("bufferView");
  mesh = read_mesh(file.save(folder / "b.glb"));
  EXPECT_EQ(mesh.positions[3], (Vec3f{0, 0, 0}));
  EXPECT_EQ(mesh.positions[4], (Vec3f{-1, -2, -3}));
}

// Compress both views of the pyramid as gltfpack does, the uncompressed buffer being a placeholder.
HandMade compressed_pyramid(const char* extension) {
  HandMade file = pyramid();
  const std::vector<float> positions = five_points();
  const std::vector<unsigned> indices{0, 1, 2, 1, 3, 2, 0, 2, 4, 2, 3, 4, 3, 1, 4, 1, 0, 4};
  Bytes vertices(meshopt_encodeVertexBufferBound(5, 12));
  vertices.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(vertices.data()),
                                             vertices.size(), positions.data(), 5, 12));
  Bytes sequence(meshopt_encodeIndexSequenceBound(indices.size(), 5));
  sequence.resize(meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(sequence.data()),
                                              sequence.size(), indices.data(), indices.size()));
  const std::size_t placeholder = file.buffer.size();
  file.buffer.clear();
  const auto compress = [&](std::size_t view, const Bytes& data, int stride, std::size_t count,
                            const char* mode) {
    Json& json = file.json["bufferViews"][view];
    json["buffer"] = 1;
    json["extensions"][extension] = {{"buffer", 0},
                                     {"byteOffset", file.buffer.size()},
                                     {"byteLength", data.size()},
                                     {"byteStride", stride},
                                     {"count", count},
                                     {"mode", mode}};
    file.buffer.insert(file.buffer.end(), data.begin(), data.end());
  };
  compress(0, vertices, 12, 5, "ATTRIBUTES");
  compress(1, sequence, 2, 18, "INDICES");
  while (file.buffer.size() % 4 != 0) file.buffer.push_back(std::byte{0});
  file.json["buffers"] = {{{"byteLength", file.buffer.size()}}, {{"byteLength", placeholder + 4}}};
  return file;
}

TEST(GltfMeshopt, CompressedViewsGiveTheSameMesh) {
  const TempFolder folder;
  const Mesh plain = read_mesh(pyramid().save(folder / "plain.glb"));
  for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    const Mesh mesh = read_mesh(compressed_pyramid(extension).save(folder / "packed.glb"));
    EXPECT_EQ(mesh.positions, plain.positions);
    EXPECT_EQ(mesh.triangles, plain.triangles);
  }
}

TEST(GltfMeshopt, DamageAndUnknownFormsAreRefused) {
  const TempFolder folder;
  const auto refusal = [&](const std::function<void(HandMade&, Json&)>& damage) {
    HandMade file = compressed_pyramid("EXT_meshopt_compression");
    damage(file, file.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]);
    const std::string path = file.save(folder / "bad.glb");
    return error_of([&] { read_model(path); });
  };
  EXPECT_THAT(refusal([](HandMade& file, Json&) { file.buffer[0] = std::byte{0xA7}; }),
              ::testing::HasSubstr("damaged or in a newer format"));
  EXPECT_THAT(refusal([](HandMade&, Json& view) { view["mode"] = "COLOR"; }),
              ::testing::HasSubstr("mode COLOR"));
  EXPECT_THAT(refusal([](HandMade&, Json& view) { view["filter"] = "COLOR"; }),
              ::testing::HasSubstr("filter COLOR"));
  EXPECT_THAT(refusal([](HandMade&, Json& view) { view["byteStride"] = 10; }),
              ::testing::HasSubstr("byteStride 10"));
  EXPECT_THAT(refusal([](HandMade&, Json& view) { view["count"] = 6; }), ::testing::HasSubstr("byteLength"));
  EXPECT_THAT(refusal([](HandMade& file, Json& view) {
                view["count"] = 100000000;
                file.json["bufferViews"][0]["byteLength"] = 1200000000;
              }),
              ::testing::HasSubstr("too short"));
}

// The uncompressed copy is never read: its name may be one that no file can have.
TEST(GltfMeshopt, FallbackMayHaveAnyName) {
  const TempFolder folder;
  HandMade file = compressed_pyramid("EXT_meshopt_compression");
  file.json["buffers"].push_back({{"byteLength", 4},
                                  {"uri", std::string(300, 'x')},
                                  {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  EXPECT_EQ(read_model(file.save(folder / "packed.glb")).primitives.size(), 1U);
}

// ---------------------------------------------------------------------------------------- nodes and
// materials

TEST(GltfScene, WorldMatricesFollowTheHierarchy) {
  const TempFolder folder;
  HandMade file = pyramid();
  file.json["nodes"] = Json::parse(R"([
    {"name":"root","translation":[10,0,0],"rotation":[0,0,0.7071067811865476,0.7071067811865476],"children":[1,2]},
    {"name":"scaled","scale":[2,3,4],"mesh":0},
    {"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1],"mesh":0},
    {"mesh":0,"name":"not in the scene"}])");
  const Model model = read_model(file.save(folder / "a.glb"));
  ASSERT_EQ(model.instances.size(), 2U);
  EXPECT_EQ(model.instances[0].node_name, "scaled");
  // A quarter turn about z takes the scaled x axis to y and y to -x.
  const auto& scaled = model.instances[0].world.m;
  EXPECT_NEAR(scaled[1], 2, 1e-12);
  EXPECT_NEAR(scaled[4], -3, 1e-12);
  EXPECT_NEAR(scaled[10], 4, 1e-12);
  EXPECT_NEAR(scaled[12], 10, 1e-12);
  // and (5, 6, 7) to (-6, 5, 7).
  const auto& moved = model.instances[1].world.m;
  EXPECT_NEAR(moved[12], 4, 1e-12);
  EXPECT_NEAR(moved[13], 5, 1e-12);
  EXPECT_NEAR(moved[14], 7, 1e-12);

  file.json.erase("scenes");
  file.json.erase("scene");
  EXPECT_EQ(read_model(file.save(folder / "b.glb")).instances.size(), 3U)
      << "without scenes all roots are drawn";
}

TEST(GltfScene, DeepHierarchiesNeedNoStack) {
  const TempFolder folder;
  HandMade file = pyramid();
  constexpr int kDepth = 200000;
  file.json["nodes"] = Json::array();
  for (int i = 0; i < kDepth; ++i) file.json["nodes"].push_back({{"children", Json::array({i + 1})}});
  file.json["nodes"].push_back({{"mesh", 0}});
  EXPECT_EQ(read_model(file.save(folder / "a.glb")).instances.size(), 1U);
}

TEST(GltfScene, BrokenHierarchiesAreRefused) {
  const TempFolder folder;
  const auto refusal = [&](const char* nodes) {
    HandMade file = pyramid();
    file.json["nodes"] = Json::parse(nodes);
    const std::string path = file.save(folder / "bad.glb");
    return error_of([&] { read_model(path); });
  };
  EXPECT_THAT(refusal(R"([{"mesh":0},{"children":[2]},{"children":[1]}])"),
              ::testing::HasSubstr("own ancestor"));
  EXPECT_THAT(refusal(R"([{"mesh":0},{"children":[1]}])"), ::testing::HasSubstr("own ancestor"));
  EXPECT_THAT(refusal(R"([{"children":[2]},{"children":[2]},{"mesh":0}])"),
              ::testing::HasSubstr("two parents"));
  EXPECT_THAT(refusal(R"([{"children":[7]}])"), ::testing::HasSubstr("child 7 does not exist"));
  EXPECT_THAT(refusal(R"([{"mesh":5}])"), ::testing::HasSubstr("mesh 5 does not exist"));
  EXPECT_THAT(refusal(R"([{"mesh":-1}])"), ::testing::HasSubstr("not a non-negative integer"));
  EXPECT_THAT(refusal(R"([{"mesh":0,"matrix":[1,2]}])"), ::testing::HasSubstr("16 numbers"));
  EXPECT_THAT(refusal(R"([])"), ::testing::HasSubstr("node 0 does not exist"));
}

TEST(GltfMaterials, ReadsColourAlphaModeAndFlags) {
  const TempFolder folder;
  HandMade file = pyramid();
  EXPECT_EQ(read_model(file.save(folder / "none.glb")).primitives[0].alpha_mode, AlphaMode::opaque);
  EXPECT_FALSE(read_model(folder / "none.glb").primitives[0].double_sided);

  file.json["materials"] = Json::parse(R"([{"name":"glass","alphaMode":"BLEND","doubleSided":true,
      "pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.3,0.4]},"extensions":{"KHR_materials_transmission":{}}}])");
  file.json["extensionsUsed"] = {"KHR_materials_transmission", "VENDOR_unheard_of"};
  file.primitive()["material"] = 0;
  file.primitive()["targets"] = {{{"POSITION", 0}}};
  file.json["animations"] = Json::parse(R"([{"name":"spin","channels":[],"samplers":[]}])");
  const Model model = read_model(file.save(folder / "glass.glb"));
  const Primitive& primitive = model.primitives[0];
  EXPECT_EQ(primitive.alpha_mode, AlphaMode::blend);
  EXPECT_TRUE(primitive.double_sided);
  EXPECT_TRUE(primitive.deforms);
  EXPECT_EQ(primitive.material_name, "glass");
  EXPECT_EQ(primitive.base_color, (std::array{0.1F, 0.2F, 0.3F, 0.4F}));
  EXPECT_EQ(model.animation_names, std::vector<std::string>{"spin"});
  EXPECT_THAT(model.notes, ::testing::Contains("1 animation"));
  EXPECT_THAT(model.notes, ::testing::Contains("VENDOR_unheard_of kept, not read"));
  EXPECT_THAT(model.notes, ::testing::Contains(::testing::HasSubstr("KHR_materials_transmission")));
}

// ---------------------------------------------------------------------------------------------- buffers

TEST(GltfBuffers, ReadsExternalFilesWithEscapesAndAboveTheFolder) {
  const TempFolder folder;
  HandMade file = pyramid();
  fs::create_directory(folder / "sub");
  const Mesh expected = read_mesh(file.save(folder / "plain.glb"));
  fs::create_directory(folder / "d \xC3\xA4");
  write_file_atomically(folder / "d \xC3\xA4/b#1.bin", file.buffer);
  file.json["buffers"][0]["uri"] = "../d%20%c3%a4/b%231.bin";
  EXPECT_EQ(read_mesh(file.save(folder / "sub/a.gltf")).triangles, expected.triangles);
}

TEST(GltfBuffers, DecodesDataUris) {
  const TempFolder folder;
  HandMade file = pyramid();
  const Mesh expected = read_mesh(file.save(folder / "plain.glb"));
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t bit = 0; bit < 8 * file.buffer.size(); bit += 6) {
    unsigned digit = 0;
    for (std::size_t k = bit; k < bit + 6; ++k) {
      const unsigned byte = k / 8 < file.buffer.size() ? std::to_integer<unsigned>(file.buffer[k / 8]) : 0;
      digit = 2 * digit + ((byte >> (7 - k % 8)) & 1U);
    }
    text.push_back(kDigits[digit]);
  }
  while (text.size() % 4 != 0) text.push_back('=');
  file.json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + text;
  EXPECT_EQ(read_mesh(file.save(folder / "a.gltf")).triangles, expected.triangles);
  file.json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + text.substr(0, 40);
  EXPECT_THAT(error_of([&] { read_model(file.save(folder / "short.gltf")); }),
              ::testing::HasSubstr("buffers[0]: it is cut off"));
  file.json["buffers"][0]["uri"] = "data:;base64,!!!!";
  EXPECT_THAT(error_of([&] { read_model(file.save(folder / "bad.gltf")); }),
              ::testing::HasSubstr("malformed"));
  // Percent-encoding, alone and around base64, with upper case and a parameter.
  std::string escaped = "DATA:application/octet-stream;charset=x,";
  for (const std::byte byte : file.buffer) {
    constexpr std::string_view kHex = "0123456789abcdef";
    escaped += {'%', kHex[std::to_integer<unsigned>(byte) / 16], kHex[std::to_integer<unsigned>(byte) % 16]};
  }
  file.json["buffers"][0]["uri"] = escaped;
  EXPECT_EQ(read_mesh(file.save(folder / "escaped.gltf")).triangles, expected.triangles);
  std::string padded = text;
  while (padded.ends_with('=')) padded.replace(padded.size() - 1, 1, "");
  file.json["buffers"][0]["uri"] = "data:;Base64," + padded + "%3D%3D";
  EXPECT_EQ(read_mesh(file.save(folder / "both.gltf")).triangles, expected.triangles);
}

TEST(GltfBuffers, OtherUrisAreRefused) {
  const TempFolder folder;
  HandMade file = pyramid();
  const Mesh expected = read_mesh(file.save(folder / "plain.glb"));
  for (const char* uri : {"http://example.org/a.bin", "file:///etc/passwd", "/etc/passwd", "//host/a.bin",
                          "%2Fetc/passwd", "a%00b", ""}) {
    file.save(folder / "a.gltf");
    file.json["buffers"][0]["uri"] = uri;
    EXPECT_THAT(error_of([&] { read_model(file.save(folder / "a.gltf")); }),
                ::testing::HasSubstr("not a relative path"))
        << uri;
  }
  // A '%' that is no escape is part of the name, and so is an escape if a file is called that.
  for (const char* name : {"example 10%.bin", "a%zz", "b%20c.bin"}) {
    write_file_atomically(folder / name, file.buffer);
    file.json["buffers"][0]["uri"] = name;
    EXPECT_EQ(read_mesh(file.save(folder / "a.gltf")).triangles.size(), expected.triangles.size()) << name;
  }
  file.json["buffers"][0]["uri"] = "missing.bin";
  EXPECT_THAT(error_of([&] { read_model(file.save(folder / "a.gltf")); }),
              ::testing::HasSubstr("missing.bin"));
  file.json["buffers"][0]["uri"] = ".";
  EXPECT_THAT(error_of([&] { read_model(file.save(folder / "a.gltf")); }),
              ::testing::HasSubstr("not a regular file"));
}

// --------------------------------------------------------------------------------------------- bad input

struct BadCase {
  const char* name;
  std::function<void(HandMade&)> damage;
  const char* message;
};

class BadGltf : public ::testing::TestWithParam<BadCase> {};

TEST_P(BadGltf, IsRefusedWithItsReason) {
  const TempFolder folder;
  HandMade file = pyramid();
  GetParam().damage(file);
  const std::string path = file.save(folder / "bad.glb");
  const std::string message = error_of([&] { read_model(path); });
  EXPECT_THAT(message, ::testing::StartsWith(path + ": "));
  EXPECT_THAT(message, ::testing::HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    All, BadGltf,
    ::testing::Values(
        BadCase{"IndexOutOfRange",
                [](HandMade& f) {
                  f.set_indices(std::vector<std::uint16_t>{0, 1, 5});
                },
                "accessors[2]: index 5 of meshes[0].primitives[0] is out of range"},
        BadCase{"Restart",
                [](HandMade& f) {
                  f.set_indices(std::vector<std::uint8_t>{0, 1, 255});
                },
                "primitive restart"},
        BadCase{"NotTriples",
                [](HandMade& f) {
                  f.set_indices(std::vector<std::uint16_t>{0, 1, 2, 3});
                },
                "multiple of 3"},
        BadCase{"MissingAccessor", [](HandMade& f) { f.primitive()["indices"] = 17; }, "accessors[17]"},
        BadCase{"HugeCount", [](HandMade& f) { f.json["accessors"][0]["count"] = 4000000000U; }, "elements"},
        BadCase{"HugeCountNoView",
                [](HandMade& f) {
                  f.json["accessors"][0]["count"] = 18446744073709551615U;
                  f.json["accessors"][0].erase("bufferView");
                },
                "asks for"},
        BadCase{"BeyondView", [](HandMade& f) { f.json["accessors"][0]["count"] = 6; },
                "do not fit into bufferViews[0]"},
        BadCase{"OffsetOverflow",
                [](HandMade& f) { f.json["accessors"][0]["byteOffset"] = 18446744073709551612U; },
                "do not fit"},
        BadCase{"ViewBeyondBuffer", [](HandMade& f) { f.json["bufferViews"][0]["byteLength"] = 1000; },
                "outside buffers[0]"},
        BadCase{"ViewOverflow",
                [](HandMade& f) { f.json["bufferViews"][0]["byteOffset"] = 18446744073709551612U; },
                "outside buffers[0]"},
        BadCase{"BufferMissing", [](HandMade& f) { f.json["bufferViews"][0]["buffer"] = 3; },
                "buffer 3 does not exist"},
        BadCase{"FloatIndices", [](HandMade& f) { f.json["accessors"][1]["componentType"] = 5126; },
                "unsigned integers"},
        BadCase{"VectorIndices", [](HandMade& f) { f.json["accessors"][1]["type"] = "VEC3"; }, "not SCALAR"},
        BadCase{"ScalarPositions", [](HandMade& f) { f.json["accessors"][0]["type"] = "SCALAR"; },
                "not VEC3"},
        BadCase{"UnknownComponent", [](HandMade& f) { f.json["accessors"][0]["componentType"] = 5130; },
                "5130"},
        BadCase{"StrideTooSmall", [](HandMade& f) { f.json["bufferViews"][0]["byteStride"] = 4; },
                "byteStride 4"},
        BadCase{"Mode", [](HandMade& f) { f.primitive()["mode"] = 9; }, "mode 9"},
        BadCase{"NormalCount",
                [](HandMade& f) {
                  f.primitive()["attributes"]["NORMAL"] =
                      f.accessor(f.view(std::vector<float>{0, 0, 1}), 5126, 1, "VEC3");
                },
                "1 normals for 5 positions"},
        BadCase{
            "Draco",
            [](HandMade& f) { f.primitive()["extensions"]["KHR_draco_mesh_compression"] = Json::object(); },
            "KHR_draco_mesh_compression"},
        BadCase{"Version1", [](HandMade& f) { f.json["asset"]["version"] = "1.0"; }, "version '1.0'"},
        BadCase{"MinVersion", [](HandMade& f) { f.json["asset"]["minVersion"] = "2.1"; }, "minVersion"},
        BadCase{"NoAsset", [](HandMade& f) { f.json.erase("asset"); }, "asset is missing"},
        BadCase{"MeshesNotArray", [](HandMade& f) { f.json["meshes"] = 5; }, "meshes is not an array"},
        BadCase{"PrimitiveNotObject", [](HandMade& f) { f.primitive() = 7; }, "not a JSON object"},
        BadCase{"AlphaMode",
                [](HandMade& f) {
                  f.json["materials"] = {{{"alphaMode", "GLASS"}}};
                  f.primitive()["material"] = 0;
                },
                "alphaMode GLASS"},
        BadCase{"SparseOrder",
                [](HandMade& f) {
                  Json& sparse = f.json["accessors"][0]["sparse"];
                  sparse["count"] = 2;
                  sparse["indices"] = {{"bufferView", f.view(std::vector<std::uint8_t>{4, 1})},
                                       {"componentType", 5121}};
                  sparse["values"] = {{"bufferView", f.view(std::vector<float>{0, 0, 0, 0, 0, 0})}};
                },
                "out of range or order"}),
    [](const auto& bad_case) { return bad_case.param.name; });

TEST(BadContainer, TruncatedAnywhereIsRefused) {
  const TempFolder folder;
  const std::string good = pyramid().save(folder / "good.glb");
  const Bytes bytes = read_file(good);
  const std::string cut = folder / "cut.glb";
  for (std::size_t size = 4; size < bytes.size(); ++size) {
    write_file_atomically(cut, std::span(bytes).first(size));
    EXPECT_NE(error_of([&] { read_model(cut); }), "") << size;
  }
}

TEST(BadContainer, MessagesSayWhatIsWrong) {
  const TempFolder folder;
  const auto refusal = [&](const std::string& name, const std::string& content) {
    write_file_atomically(folder / name, content);
    return error_of([&] { read_model(folder / name); });
  };
  EXPECT_THAT(refusal("empty.glb", ""), ::testing::HasSubstr("bad JSON"));
  EXPECT_THAT(refusal("garbage.gltf", "\x01\x02\x03"), ::testing::HasSubstr("bad JSON"));
  EXPECT_THAT(refusal("open.gltf", "{\"asset\":"), ::testing::HasSubstr("bad JSON"));
  EXPECT_THAT(refusal("array.gltf", "[]"), ::testing::HasSubstr("not an object"));
  EXPECT_THAT(refusal("huge_number.gltf", "{\"a\":1e999}"), ::testing::HasSubstr("bad JSON"));
  EXPECT_THAT(refusal("deep.gltf", "{\"a\":" + std::string(100000, '[') + std::string(100000, ']') + "}"),
              ::testing::HasSubstr("nests deeper"));
  std::string keys = "{";
  for (int i = 0; i < 20000; ++i) keys += "\"k" + std::to_string(i) + "\":0,";
  EXPECT_THAT(refusal("keys.gltf", keys + "\"z\":0}"), ::testing::HasSubstr("10000 keys"));
  EXPECT_THAT(refusal("v1.glb", std::string("glTF\x01\0\0\0\x0C\0\0\0", 12)),
              ::testing::HasSubstr("version 1"));
  EXPECT_THAT(refusal("unknown.xyz", "hello"), ::testing::HasSubstr(".glb .gltf .ply"));
  EXPECT_THAT(error_of([&] { read_model(folder / "none.glb"); }), ::testing::HasSubstr("cannot read"));
  EXPECT_THAT(error_of([&] { read_model(folder / "none.xyz"); }), ::testing::HasSubstr("cannot read"));
  fs::create_directory(folder / "dir.glb");
  EXPECT_THAT(error_of([&] { read_model(folder / "dir.glb"); }), ::testing::HasSubstr("directory"));
}

TEST(GltfLimits, TheSumOfAllPrimitivesCounts) {
  const TempFolder folder;
  HandMade file = pyramid();
  const Json one = file.primitive();
  for (int i = 0; i < 100; ++i) file.json["meshes"][0]["primitives"].push_back(one);
  const std::string path = file.save(folder / "many.glb");
  EXPECT_EQ(read_model(path).primitives.size(), 101U);
  ReadOptions options;
  options.max_elements = 20;  // enough for one of them
  EXPECT_THAT(error_of([&] { read_model(path, options); }), ::testing::HasSubstr("the limit is 20"));
}

TEST(GltfDispatch, ContentWinsOverTheName) {
  const TempFolder folder;
  pyramid().save(folder / "a.glb");
  fs::copy_file(folder / "a.glb", folder / "a.ply");
  const Model model = read_model(folder / "a.ply");
  EXPECT_EQ(model.format, "glb");
  EXPECT_EQ(model.primitives.at(0).mesh.triangles.size(), 6U);
  EXPECT_EQ(model.primitives.at(0).name, "m");
}

TEST(GltfDispatch, RefusesNamesThatNoFileCanHave) {
  const std::string name(300, 'x');
  EXPECT_THAT(error_of([&] { read_model(name); }), ::testing::HasSubstr("File name too long"));
}

}  // namespace
}  // namespace pellucid::test
