// Internal to the module `asset`: image files in memory. In: the bytes of a PNG or JPEG file. Out: its
// texels. PNG is read by libpng, JPEG by libjpeg where PELLUCID_JPEG is on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>

#include "pellucid/material.h"

namespace pellucid {

constexpr std::uint64_t kLargestImageFile = std::uint64_t{1} << 28U;  // bytes that are read

// Says what is wrong with an image file. The caller adds the name of the file.
class ImageFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Returns whether a file is a PNG or JPEG, by its first bytes.
bool is_image(std::span<const std::byte> file);

// Returns whether this build can decode the file: JPEG only where PELLUCID_JPEG is on.
bool can_decode(std::span<const std::byte> file);

// Decodes a PNG or JPEG. Throws ImageFileError if the file is damaged, or if it has more than `max_texels`
// texels. In that case no memory was allocated for them.
RgbaImage decode_image(std::span<const std::byte> file, std::uint64_t max_texels);

}  // namespace pellucid
