// png.cpp - pictures as PNG files (libpng's simplified interface).
#include <png.h>

#include "pellucid/asset.h"

namespace pellucid {

std::vector<std::uint8_t> encode_png(const Image& image) {
  if (image.width == 0 || image.height == 0 ||
      image.rgb.size() != std::size_t{3} * image.width * image.height) {
    throw Error(ErrorKind::bad_argument, "picture of " + std::to_string(image.width) + " x " +
                                             std::to_string(image.height) + " pixels with " +
                                             std::to_string(image.rgb.size()) + " bytes cannot be a PNG");
  }
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = image.width;
  header.height = image.height;
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::vector<std::uint8_t> bytes(size);
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) == 0) {
    throw Error(ErrorKind::internal, std::string("libpng: ") + header.message);
  }
  bytes.resize(size);
  return bytes;
}

void write_png(const Image& image, const std::string& path) {
  const std::vector<std::uint8_t> bytes = encode_png(image);
  write_file_atomically(path, std::as_bytes(std::span(bytes)));
}

}  // namespace pellucid
