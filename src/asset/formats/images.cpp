// Implements images.h and the image files of pellucid/asset.h and pellucid/material.h. PNG is read and
// written through libpng's simplified interface, JPEG is read through libjpeg.
#include "asset/formats/images.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#ifdef PELLUCID_WITH_JPEG
#include <jpeglib.h>

#include <csetjmp>
#include <cstdio>  // jpeglib.h needs it
#endif

namespace pellucid {
namespace {

constexpr std::array<unsigned char, 8> kPngBegins{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::array<unsigned char, 3> kJpegBegins{0xFF, 0xD8, 0xFF};

template <std::size_t count>
bool begins_with(std::span<const std::byte> file, const std::array<unsigned char, count>& bytes) {
  return file.size() >= count && std::memcmp(file.data(), bytes.data(), count) == 0;
}

void check_size(std::uint64_t width, std::uint64_t height, std::uint64_t max_texels) {
  const std::string size = std::to_string(width) + " x " + std::to_string(height) + " texels";
  if (width == 0 || height == 0) throw ImageFileError("it has " + size);
  if (height > max_texels / width) {
    throw ImageFileError("it has " + size + ", and all images together may have " +
                         std::to_string(max_texels));
  }
}

RgbaImage decode_png(std::span<const std::byte> file, std::uint64_t max_texels) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  // Frees what libpng holds, also if an error is thrown.
  struct Free {
    png_image* image;
    ~Free() { png_image_free(image); }
  } const free{&header};
  if (png_image_begin_read_from_memory(&header, file.data(), file.size()) == 0)
    throw ImageFileError(std::string("as a PNG it is damaged: ") + header.message);
  check_size(header.width, header.height, max_texels);
  header.format = PNG_FORMAT_RGBA;
  RgbaImage image{header.width, header.height, {}};
  image.rgba.resize(PNG_IMAGE_SIZE(header));
  if (png_image_finish_read(&header, nullptr, image.rgba.data(), 0, nullptr) == 0)
    throw ImageFileError(std::string("as a PNG it is damaged: ") + header.message);
  // For a file that is cut off, libpng returns the rows that exist, with a warning.
  if ((header.warning_or_error & PNG_IMAGE_WARNING) != 0 &&
      std::string_view(header.message).find("Not enough") != std::string_view::npos)
    throw ImageFileError(std::string("as a PNG it is damaged: ") + header.message);
  return image;
}

#ifdef PELLUCID_WITH_JPEG

// The memory that libjpeg may allocate beside the image. It holds progressive files as coefficients.
constexpr long kMostJpegMemory = 1L << 30;

// libjpeg reports errors by longjmp, so no object with a destructor may be created between there and here.
struct JpegReader {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf out{};
  std::array<char, JMSG_LENGTH_MAX> message{};
};

JpegReader& reader_of(j_common_ptr jpeg) {
  return *static_cast<JpegReader*>(jpeg->client_data);
}

[[noreturn]] void leave_jpeg(j_common_ptr jpeg) {
  JpegReader& reader = reader_of(jpeg);
  jpeg->err->format_message(jpeg, reader.message.data());
  std::longjmp(reader.out, 1);  // NOLINT(modernize-avoid-setjmp-longjmp)
}

// Level -1 means that the data is corrupt and that libjpeg would guess the rest.
void on_jpeg_message(j_common_ptr jpeg, int level) {
  if (level < 0) leave_jpeg(jpeg);
}

// Reads the header. Returns false where libjpeg reports an error.
bool begin_jpeg(JpegReader& reader, std::span<const std::byte> file) {
  reader.jpeg.err = jpeg_std_error(&reader.errors);
  reader.errors.error_exit = leave_jpeg;
  reader.errors.emit_message = on_jpeg_message;
  reader.jpeg.client_data = &reader;
  if (setjmp(reader.out) != 0) return false;
  jpeg_create_decompress(&reader.jpeg);
  reader.jpeg.mem->max_memory_to_use = kMostJpegMemory;
  jpeg_mem_src(&reader.jpeg, reinterpret_cast<const unsigned char*>(file.data()),
               static_cast<unsigned long>(file.size()));
  jpeg_read_header(&reader.jpeg, TRUE);
  return true;
}

// Decodes all rows into `rgb`, which has room for the whole image. Returns false where libjpeg reports an
// error.
bool decode_rows(JpegReader& reader, std::uint8_t* rgb) {
  if (setjmp(reader.out) != 0) return false;
  reader.jpeg.out_color_space = JCS_RGB;
  jpeg_start_decompress(&reader.jpeg);
  const std::size_t row_bytes = std::size_t{3} * reader.jpeg.output_width;
  while (reader.jpeg.output_scanline < reader.jpeg.output_height) {
    JSAMPROW row = rgb + row_bytes * reader.jpeg.output_scanline;
    jpeg_read_scanlines(&reader.jpeg, &row, 1);
  }
  jpeg_finish_decompress(&reader.jpeg);
  return true;
}

RgbaImage decode_jpeg(std::span<const std::byte> file, std::uint64_t max_texels) {
  JpegReader reader;
  struct Free {
    jpeg_decompress_struct* jpeg;
    ~Free() { jpeg_destroy_decompress(jpeg); }
  } const free{&reader.jpeg};
  const auto complain = [&] {
    throw ImageFileError(std::string("as a JPEG it is damaged: ") + reader.message.data());
  };
  if (!begin_jpeg(reader, file)) complain();
  check_size(reader.jpeg.image_width, reader.jpeg.image_height, max_texels);
  RgbaImage image{reader.jpeg.image_width, reader.jpeg.image_height, {}};
  const std::size_t texels = std::size_t{image.width} * image.height;
  std::vector<std::uint8_t> rgb(3 * texels);
  if (!decode_rows(reader, rgb.data())) complain();
  image.rgba.resize(4 * texels, 255);
  for (std::size_t i = 0; i < texels; ++i) std::copy_n(&rgb[3 * i], 3, &image.rgba[4 * i]);
  return image;
}

#else

RgbaImage decode_jpeg(std::span<const std::byte> /*file*/, std::uint64_t /*max_texels*/) {
  throw ImageFileError("it is a JPEG, and this build of pellucid cannot read JPEG (PELLUCID_JPEG is off)");
}

#endif

}  // namespace

bool is_image(std::span<const std::byte> file) {
  return begins_with(file, kPngBegins) || begins_with(file, kJpegBegins);
}

bool can_decode(std::span<const std::byte> file) {
#ifdef PELLUCID_WITH_JPEG
  return is_image(file);
#else
  return begins_with(file, kPngBegins);
#endif
}

RgbaImage decode_image(std::span<const std::byte> file, std::uint64_t max_texels) {
  return begins_with(file, kPngBegins) ? decode_png(file, max_texels) : decode_jpeg(file, max_texels);
}

RgbaImage read_image(const std::string& path) {
  constexpr std::uint64_t kMostTexels = std::uint64_t{1} << 27U;
  const std::vector<std::byte> file = read_file(path);
  if (!is_image(file)) throw Error(ErrorKind::bad_input, path + ": it is neither a PNG nor a JPEG");
  try {
    return decode_image(file, kMostTexels);
  } catch (const ImageFileError& error) {
    throw Error(ErrorKind::bad_input, path + ": " + error.what());
  }
}

std::vector<std::uint8_t> encode_png(const Image& image) {
  if (image.width == 0 || image.height == 0 ||
      image.rgb.size() != std::size_t{3} * image.width * image.height) {
    throw Error(ErrorKind::bad_argument, "an image of " + std::to_string(image.width) + " x " +
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
