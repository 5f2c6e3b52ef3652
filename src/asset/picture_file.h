// Internal to the module `asset`: pictures out of PNG and JPEG files in memory.
#pragma once

#include <cstddef>
#include <span>
#include <stdexcept>

#include "pellucid/material.h"

namespace pellucid {

class PictureError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Is it a file that decode_picture reads, by its first bytes?
bool is_picture(std::span<const std::byte> file);

// Throws PictureError where the file is damaged, or says that it has more than `max_texels` texels: then
// nothing was allocated for them.
RgbaImage decode_picture(std::span<const std::byte> file, std::uint64_t max_texels);

// Returns whether decode_picture() knows the format of an image file: JPEG only where PELLUCID_JPEG is on.
bool can_decode(std::span<const std::byte> file);

}  // namespace pellucid
