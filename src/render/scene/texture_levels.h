// texture_levels.h - makes the smaller levels of textures, by halving them in linear colours. The device and
// the reference on the CPU sample the same levels.
#pragma once

#include <cstdint>
#include <vector>

#include "pellucid/render.h"

namespace pellucid::render {

constexpr std::uint32_t kMostLevels = 16;  // sides up to 65,535

struct TextureLevel {
  std::uint32_t width = 0, height = 0;
  // Eight bits a channel, red lowest: linear colours in gamma 2, then opacity.
  std::vector<std::uint32_t> texels;
};

struct TextureLevels {
  std::vector<TextureLevel> levels;  // from the largest one; each has half the sides, at least 1
  TextureSampling sampling;
};

// Of all textures of a scene, in kMostTextureBytes. Throws Error{bad_argument} where a texture has no texels,
// other than it says, or a side that is too long.
std::vector<TextureLevels> make_texture_levels(const std::vector<Texture>& textures);

}  // namespace pellucid::render
