// PNG files: written, read back by libpng, refused.
#include <gtest/gtest.h>
#include <png.h>

#include <filesystem>
#include <fstream>

#include "pellucid/asset.h"

namespace pellucid {
namespace {

TEST(Png, RoundTripThroughAFile) {
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

TEST(Png, RefusesWhatCannotBeWritten) {
  EXPECT_THROW(encode_png({0, 0, {}}), Error);
  EXPECT_THROW(encode_png({2, 2, {1, 2, 3}}), Error);
  try {
    write_png({1, 1, {1, 2, 3}}, "/nonexistent-folder/picture.png");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::cannot_write);
  }
}

}  // namespace
}  // namespace pellucid
