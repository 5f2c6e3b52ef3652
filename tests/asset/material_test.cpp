// Tests materials of glTF and OBJ files, with all forms of textures, damaged images and images of absurd
// sizes, and PNG files.
#include "pellucid/material.h"

#ifdef PELLUCID_WITH_JPEG
#include <jpeglib.h>

#include <cstdio>  // jpeglib.h needs it
#endif

#include <png.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "gltf_helpers.h"
#include "pellucid/asset.h"
#include "pellucid/metric.h"

namespace pellucid::test {
namespace {

using ::testing::HasSubstr;

Bytes png_of(std::uint32_t width, std::uint32_t height) {
  Image image{width, height, {}};
  for (std::size_t i = 0; i < std::size_t{3} * width * height; ++i)
    image.rgb.push_back(static_cast<std::uint8_t>(i % 251));
  return bytes_of(encode_png(image));
}

#ifdef PELLUCID_WITH_JPEG

// One colour.
Bytes jpeg_of(std::uint32_t side, std::array<std::uint8_t, 3> color) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &data, &size);
  jpeg.image_width = jpeg.image_height = side;
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  std::vector<std::uint8_t> row;
  for (std::uint32_t x = 0; x < side; ++x) row.insert(row.end(), color.begin(), color.end());
  JSAMPROW rows = row.data();
  while (jpeg.next_scanline < side) jpeg_write_scanlines(&jpeg, &rows, 1);
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  Bytes bytes(size);
  std::memcpy(bytes.data(), data, size);
  std::free(data);
  return bytes;
}

#endif

// An image of each format that this build reads.
std::vector<Bytes> images_of_all_formats() {
  std::vector<Bytes> images{png_of(40, 40)};
#ifdef PELLUCID_WITH_JPEG
  images.push_back(jpeg_of(40, {9, 99, 199}));
#endif
  return images;
}

// A triangle with texture coordinates, and a material whose texture is images[0].
HandMade textured() {
  HandMade file;
  file.set_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  file.set_indices<std::uint16_t>({0, 1, 2});
  for (const char* name : {"TEXCOORD_0", "TEXCOORD_1"}) {
    const float first = name[9] == '0' ? 0.0F : 0.5F;
    const std::size_t view = file.view<float>({first, 0, 1, 0, 0, 1});
    file.primitive()["attributes"][name] = file.accessor(view, 5126, 3, "VEC2");
  }
  file.primitive()["material"] = 0;
  file.json["materials"] = Json::parse(
      R"([{"alphaMode":"MASK","alphaCutoff":0.25,
          "pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0}}])");
  file.json["textures"] = Json::parse(R"([{"source":0}])");
  return file;
}

Json& texture_info(HandMade& file) {
  return file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
}

void embed(HandMade& file, const Bytes& image) {
  const std::size_t view = file.view(image);
  file.json["images"] = Json::array({{{"bufferView", view}, {"mimeType", "image/png"}}});
}

class MaterialFiles : public ::testing::Test {
 protected:
  Materials read(HandMade& file, const MaterialOptions& options = {}) {
    return read_materials(read_model(file.save(folder_ / "model.glb")), options);
  }
  std::string complaint(HandMade& file, const MaterialOptions& options = {}) {
    try {
      read(file, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_input);
      return error.what();
    }
    return "";
  }
  TempFolder folder_;
};

TEST_F(MaterialFiles, ReadsEmbeddedPng) {
  HandMade file = textured();
  embed(file, png_of(3, 2));
  const Materials materials = read(file);
  ASSERT_EQ(materials.images.size(), 1U);
  EXPECT_EQ(materials.images[0].width, 3U);
  EXPECT_EQ(materials.images[0].height, 2U);
  EXPECT_EQ(materials.images[0].rgba[4], 3);
  EXPECT_EQ(materials.images[0].rgba[7], 255);
  const PrimitiveLook& look = materials.primitives.at(0);
  EXPECT_TRUE(look.known);
  EXPECT_EQ(look.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(look.alpha_cutoff, 0.25F);
  EXPECT_EQ(look.texture, 0U);
  EXPECT_EQ(look.texcoords.at(1), (std::array<float, 2>{1, 0}));
  EXPECT_TRUE(materials.notes.empty());
}

#ifdef PELLUCID_WITH_JPEG

TEST_F(MaterialFiles, ReadsJpegInADataUri) {
  HandMade file = textured();
  // Base64 by hand: six bits a letter.
  const Bytes jpeg = jpeg_of(16, {200, 40, 90});
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string uri = "data:image/jpeg;base64,";
  for (std::size_t bit = 0; bit < 8 * jpeg.size(); bit += 6) {
    unsigned value = 0;
    for (std::size_t b = bit; b < bit + 6; ++b) {
      const unsigned byte = b / 8 < jpeg.size() ? std::to_integer<unsigned>(jpeg[b / 8]) : 0;
      value = 2 * value + (byte >> (7 - b % 8) & 1U);
    }
    uri += kLetters[value];
  }
  file.json["images"] = Json::array({{{"uri", uri}}});
  const Materials materials = read(file);
  ASSERT_EQ(materials.images.size(), 1U);
  EXPECT_EQ(materials.images[0].width, 16U);
  EXPECT_NEAR(materials.images[0].rgba[0], 200, 3);
  EXPECT_NEAR(materials.images[0].rgba[1], 40, 3);
  EXPECT_NEAR(materials.images[0].rgba[2], 90, 3);
}

#else

TEST_F(MaterialFiles, JpegIsLeftOutWithANoteInABuildWithoutIt) {
  HandMade file = textured();
  embed(file, Bytes{std::byte{0xFF}, std::byte{0xD8}, std::byte{0xFF}, std::byte{0xE0}});
  const Materials materials = read(file);
  EXPECT_TRUE(materials.images.empty());
  ASSERT_EQ(materials.notes.size(), 1U);
  EXPECT_THAT(materials.notes[0], HasSubstr("PELLUCID_JPEG"));
}

#endif

TEST_F(MaterialFiles, ReadsFilesBesideTheModel) {
  HandMade file = textured();
  write_file_atomically(folder_ / "a b.png", png_of(4, 4));
  file.json["images"] = Json::array({{{"uri", "a%20b.png"}}});
  EXPECT_EQ(read(file).images.size(), 1U);
  file.json["images"][0]["uri"] = "missing.png";
  const Materials without = read(file);
  EXPECT_TRUE(without.images.empty());
  EXPECT_FALSE(without.primitives.at(0).texture);
  ASSERT_EQ(without.notes.size(), 1U);
  EXPECT_THAT(without.notes[0], HasSubstr("missing.png"));
}

TEST_F(MaterialFiles, ReadsSamplersCoordinatesAndTransforms) {
  HandMade file = textured();
  embed(file, png_of(2, 2));
  file.json["samplers"] = Json::parse(R"([{"wrapS":33071,"wrapT":33648,"magFilter":9728,"minFilter":9985}])");
  file.json["textures"][0]["sampler"] = 0;
  texture_info(file)["texCoord"] = 1;
  Materials materials = read(file);
  EXPECT_EQ(materials.textures.at(0).sampling,
            (TextureSampling{TextureWrap::clamp, TextureWrap::mirror, TextureFilter::nearest,
                             TextureFilter::linear, TextureLevelsUse::nearest}));
  EXPECT_EQ(materials.primitives.at(0).texcoords.at(0), (std::array<float, 2>{0.5F, 0}));
  // A quarter turn takes (1, 0) to (0, -1).
  texture_info(file)["extensions"]["KHR_texture_transform"] =
      Json::parse(R"({"offset":[0.5,0.25],"rotation":1.5707963267948966,"scale":[2,1],"texCoord":0})");
  materials = read(file);
  EXPECT_NEAR(materials.primitives.at(0).texcoords.at(1)[0], 0.5, 1e-6);
  EXPECT_NEAR(materials.primitives.at(0).texcoords.at(1)[1], 0.25 - 2, 1e-6);
}

TEST_F(MaterialFiles, ReadsVertexColors) {
  HandMade file = textured();
  embed(file, png_of(2, 2));
  const std::size_t view = file.view<std::uint8_t>({255, 0, 0, 255, 0, 255, 0, 51, 0, 0, 255, 0});
  const std::size_t colors = file.accessor(view, 5121, 3, "VEC4");
  file.json["accessors"][colors]["normalized"] = true;
  file.primitive()["attributes"]["COLOR_0"] = colors;
  const Materials materials = read(file);
  EXPECT_EQ(materials.primitives.at(0).colors.at(1), (std::array<float, 4>{0, 1, 0, 0.2F}));
}

TEST_F(MaterialFiles, TransmissionIsBlended) {
  HandMade file = textured();
  file.json["materials"][0]["alphaMode"] = "OPAQUE";
  file.json["materials"][0]["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 0.75;
  embed(file, png_of(2, 2));
  const Materials materials = read(file);
  EXPECT_EQ(materials.primitives.at(0).alpha_mode, AlphaMode::blend);
  EXPECT_EQ(materials.primitives.at(0).base_color[3], 0.25F);
}

TEST_F(MaterialFiles, ReadsUnlitAndEmissiveSurfaces) {
  HandMade file = textured();
  embed(file, png_of(3, 2));
  Json& material = file.json["materials"][0];
  material["emissiveFactor"] = {0.5, 0.25, 0};
  material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 4;
  material["emissiveTexture"] = material["pbrMetallicRoughness"]["baseColorTexture"];
  const Materials lit = read(file);
  EXPECT_EQ(lit.primitives.at(0).emissive, (std::array<float, 3>{2, 1, 0}));
  EXPECT_EQ(lit.primitives[0].emissive_texture, lit.primitives[0].texture);
  EXPECT_FALSE(lit.primitives[0].unlit);
  EXPECT_TRUE(lit.notes.empty());
  // A texture with other coordinates cannot be drawn beside the base colour's.
  material["emissiveTexture"]["extensions"]["KHR_texture_transform"]["scale"] = {3, 3};
  EXPECT_THAT(read(file).notes, ::testing::ElementsAre(::testing::HasSubstr("emissive textures")));
  material["extensions"]["KHR_materials_unlit"] = Json::object();
  const Materials unlit = read(file);
  EXPECT_TRUE(unlit.primitives.at(0).unlit);
  EXPECT_EQ(unlit.primitives[0].emissive, (std::array<float, 3>{0, 0, 0}));
  EXPECT_TRUE(unlit.notes.empty());
}

TEST_F(MaterialFiles, ReadsTheDiffusePartOfSpecularGlossiness) {
  HandMade file = textured();
  embed(file, png_of(3, 2));
  Json& material = file.json["materials"][0];
  Json glossy;
  glossy["diffuseFactor"] = {0.5, 0.25, 1, 0.75};
  glossy["diffuseTexture"] = material["pbrMetallicRoughness"]["baseColorTexture"];
  material["extensions"]["KHR_materials_pbrSpecularGlossiness"] = glossy;
  material.erase("pbrMetallicRoughness");
  const Materials materials = read(file);
  EXPECT_EQ(materials.primitives.at(0).base_color, (std::array<float, 4>{0.5F, 0.25F, 1, 0.75F}));
  EXPECT_EQ(materials.primitives[0].texture, 0U);
}

TEST_F(MaterialFiles, OneNoteNamesWhatIsNotDrawn) {
  HandMade file = textured();
  embed(file, png_of(3, 2));
  Json& material = file.json["materials"][0];
  material["normalTexture"] = material["pbrMetallicRoughness"]["baseColorTexture"];
  material["pbrMetallicRoughness"]["metallicFactor"] = 1;
  material["pbrMetallicRoughness"]["roughnessFactor"] = 0.5;
  material["extensions"]["KHR_materials_clearcoat"]["clearcoatFactor"] = 1;
  EXPECT_THAT(read(file).notes,
              ::testing::ElementsAre("of its materials these are not drawn: KHR_materials_clearcoat, metal, "
                                     "normal maps, roughness"));
}

// glTF, section 3.9.2: what a material does not say is all metal.
TEST_F(MaterialFiles, MetalIsNotedWhereTheFileLeavesItOut) {
  HandMade file = textured();
  embed(file, png_of(3, 2));
  Json& material = file.json["materials"][0];
  const auto notes_metal = ::testing::ElementsAre("of its materials these are not drawn: metal");
  EXPECT_TRUE(read(file).notes.empty());
  material["pbrMetallicRoughness"].erase("metallicFactor");
  EXPECT_THAT(read(file).notes, notes_metal);
  material.erase("pbrMetallicRoughness");
  EXPECT_THAT(read(file).notes, notes_metal);
}

TEST_F(MaterialFiles, OneNoteNamesEveryExtensionThatIsNotDrawn) {
  HandMade file = textured();
  embed(file, png_of(3, 2));
  Json& extensions = file.json["materials"][0]["extensions"];
  extensions["EXT_materials_of_tomorrow"] = Json::object();
  extensions["KHR_materials_emissive_strength"] = Json::object();
  extensions["KHR_materials_transmission"]["transmissionTexture"]["index"] = 0;
  EXPECT_THAT(read(file).notes,
              ::testing::ElementsAre("of its materials these are not drawn: EXT_materials_of_tomorrow, "
                                     "refraction (transmission is drawn as opacity), transmission maps"));
}

TEST_F(MaterialFiles, NamesDamagedImages) {
  for (const Bytes& whole : images_of_all_formats()) {
    for (const std::size_t kept : {std::size_t{12}, whole.size() / 2, whole.size() - 20}) {
      HandMade file = textured();
      embed(file, Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(kept)));
      EXPECT_THAT(complaint(file), HasSubstr("images[0]: as a ")) << kept;
    }
  }
}

TEST_F(MaterialFiles, AbsurdSizesAreRefusedBeforeMemoryIsTaken) {
  HandMade file = textured();
  embed(file, png_of(40, 40));
  EXPECT_THAT(complaint(file, {.max_texels = 1599}), HasSubstr("40 x 40 texels"));
  EXPECT_EQ(read(file, {.max_texels = 1600}).images.size(), 1U);
#ifdef PELLUCID_WITH_JPEG
  // The sides stand at bytes 7 to 10 of a frame header.
  Bytes jpeg = jpeg_of(40, {1, 2, 3});
  for (std::size_t i = 0; i + 9 < jpeg.size(); ++i) {
    if (jpeg[i] != std::byte{0xFF} || jpeg[i + 1] != std::byte{0xC0}) continue;
    std::fill_n(jpeg.begin() + static_cast<std::ptrdiff_t>(i) + 5, 4, std::byte{0xF0});
    break;
  }
  file = textured();
  embed(file, jpeg);
  EXPECT_THAT(complaint(file), HasSubstr("61680 x 61680 texels"));
#endif
}

TEST_F(MaterialFiles, DamageAtRandomNeverCrashes) {
  Random random(5);
  for (const Bytes& whole : images_of_all_formats()) {
    for (int i = 0; i < 300; ++i) {
      Bytes damaged = whole;
      for (int k = 0; k < 3; ++k)
        damaged[8 + random.below(damaged.size() - 8)] = static_cast<std::byte>(random.below(256));
      HandMade file = textured();
      embed(file, damaged);
      complaint(file, {.max_texels = 1U << 16U});
    }
  }
}

TEST_F(MaterialFiles, OtherFormatsAreLeftOut) {
  HandMade file = textured();
  embed(file, Bytes(64, std::byte{'W'}));
  const Materials materials = read(file);
  EXPECT_FALSE(materials.primitives.at(0).texture);
  ASSERT_EQ(materials.notes.size(), 1U);
  EXPECT_THAT(materials.notes[0], HasSubstr("neither PNG nor JPEG"));
}

TEST_F(MaterialFiles, AttributesThatDoNotFitAreRefused) {
  HandMade file = textured();
  embed(file, png_of(2, 2));
  file.primitive()["attributes"]["TEXCOORD_0"] = file.accessor(file.view<float>({0, 0}), 5126, 1, "VEC2");
  EXPECT_THAT(complaint(file), HasSubstr("TEXCOORD_0 does not fit"));
  texture_info(file)["index"] = 7;
  EXPECT_NE(complaint(file), "");
}

TEST_F(MaterialFiles, ReadsColorsAndOpacitiesOfObj) {
  write_file_atomically(folder_ / "m.mtl",
                        std::string_view("newmtl glass\nKd 0.1 0.2 0.3\nd 0.5\nnewmtl wood\nKd 1 0 0\n"));
  write_file_atomically(folder_ / "m.obj",
                        std::string_view("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl glass\nf 1 2 3\n"
                                         "usemtl wood\nf 1 3 2\nusemtl none\nf 2 3 1\n"));
  const Materials materials = read_materials(read_model(folder_ / "m.obj"));
  ASSERT_EQ(materials.primitives.size(), 3U);
  EXPECT_EQ(materials.primitives[0].alpha_mode, AlphaMode::blend);
  EXPECT_EQ(materials.primitives[0].base_color[3], 0.5F);
  EXPECT_EQ(materials.primitives[1].alpha_mode, AlphaMode::opaque);
  EXPECT_TRUE(materials.primitives[1].known);
  EXPECT_FALSE(materials.primitives[2].known);
}

TEST(Png, ComesBackFromAFileAsWritten) {
  Image image{13, 7, {}};
  Random random(3);
  for (std::size_t i = 0; i < 3 * 13 * 7; ++i)
    image.rgb.push_back(static_cast<std::uint8_t>(random.below(256)));
  const std::string path = ::testing::TempDir() + "/pellucid_round_trip.png";
  write_png(image, path);
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&header, path.c_str()), 0);
  EXPECT_EQ(header.format, static_cast<png_uint_32>(PNG_FORMAT_RGB));
  header.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> read(PNG_IMAGE_SIZE(header));
  ASSERT_NE(png_image_finish_read(&header, nullptr, read.data(), 0, nullptr), 0);
  EXPECT_EQ(header.width, 13U);
  EXPECT_EQ(header.height, 7U);
  EXPECT_EQ(read, image.rgb);

  std::ifstream file(path, std::ios::binary);
  const std::string stored((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::vector<std::uint8_t> bytes = encode_png(image);
  EXPECT_EQ(stored, std::string(bytes.begin(), bytes.end()));
  std::filesystem::remove(path);
}

TEST(Png, RefusesImagesAndPathsThatCannotBeWritten) {
  EXPECT_THROW(encode_png({0, 0, {}}), Error);
  EXPECT_THROW(encode_png({2, 2, {1, 2, 3}}), Error);
  try {
    write_png({1, 1, {1, 2, 3}}, "/nonexistent-folder/image.png");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::cannot_write);
  }
}

}  // namespace
}  // namespace pellucid::test
