// texture_levels.h - makes the smaller levels of textures by halving them in linear colours. The device and
// the CPU reference sample the same levels.
#pragma once

#include <cstdint>
#include <vector>

#include "pellucid/render.h"

namespace pellucid::render {

constexpr std::uint32_t kMostLevels = 16;  // sides up to 65,535

struct TextureLevel {
  std::uint32_t width = 0, height = 0;
  // Eight bits per channel, red in the lowest byte: linear colour in gamma 2, then opacity.
  std::vector<std::uint32_t> texels;
};

struct TextureLevels {
  std::vector<TextureLevel> levels;  // from the largest one; each has half the sides, at least 1
  TextureSampling sampling;
};

// Makes the levels of all textures of a scene, within kMostTextureBytes. Throws Error{bad_argument} if a
// texture has no texels, has another number of texels than its size says, or has a side that is too long.
std::vector<TextureLevels> make_texture_levels(const std::vector<Texture>& textures);

}  // namespace pellucid::render
