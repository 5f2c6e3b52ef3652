// Implements texture_levels.h: halving of textures, and the limit of the memory that they take on the device.
#include "render/scene/texture_levels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pellucid/shading.h"

namespace pellucid::render {
namespace {

using Texel = std::array<float, 4>;  // linear

struct Plane {
  std::uint32_t width = 0, height = 0;
  std::vector<Texel> texels;
};

void check_texture(const Texture& texture) {
  constexpr std::uint32_t kMostSide = (1U << kMostLevels) - 1;
  const std::uint64_t texels = std::uint64_t{texture.width} * texture.height;
  if (texels > 0 && texture.width <= kMostSide && texture.height <= kMostSide &&
      texture.rgba.size() == 4 * texels)
    return;
  throw Error(ErrorKind::bad_argument, "render: a texture of " + std::to_string(texture.width) + " x " +
                                           std::to_string(texture.height) + " texels with " +
                                           std::to_string(texture.rgba.size()) + " bytes cannot be drawn");
}

Plane decoded(const Texture& texture) {
  std::array<float, 256> linear{};
  for (std::size_t i = 0; i < linear.size(); ++i)
    linear.at(i) = static_cast<float>(linear_from_srgb(static_cast<double>(i) / 255));
  Plane plane{texture.width, texture.height, {}};
  plane.texels.reserve(texture.rgba.size() / 4);
  for (std::size_t i = 0; i < texture.rgba.size(); i += 4) {
    const std::uint8_t* const c = &texture.rgba[i];
    plane.texels.push_back(
        {linear.at(c[0]), linear.at(c[1]), linear.at(c[2]), static_cast<float>(c[3]) / 255});
  }
  return plane;
}

// Returns the next smaller level. Each texel is the mean of four. For an odd side the last texel is not used.
Plane halved(const Plane& from) {
  Plane to{std::max(from.width / 2, 1U), std::max(from.height / 2, 1U), {}};
  to.texels.resize(std::size_t{to.width} * to.height);
  const auto at = [&](std::uint32_t x, std::uint32_t y) -> const Texel& {
    return from.texels[std::size_t{std::min(y, from.height - 1)} * from.width + std::min(x, from.width - 1)];
  };
  for (std::uint32_t y = 0; y < to.height; ++y) {
    for (std::uint32_t x = 0; x < to.width; ++x) {
      Texel& texel = to.texels[std::size_t{y} * to.width + x];
      for (std::size_t k = 0; k < 4; ++k) {
        texel.at(k) = 0.25F * (at(2 * x, 2 * y).at(k) + at(2 * x + 1, 2 * y).at(k) +
                               at(2 * x, 2 * y + 1).at(k) + at(2 * x + 1, 2 * y + 1).at(k));
      }
    }
  }
  return to;
}

std::uint32_t packed(const Texel& texel) {
  const auto byte = [](float value) { return static_cast<std::uint32_t>(std::lround(255 * value)); };
  return byte(std::sqrt(texel[0])) | byte(std::sqrt(texel[1])) << 8U | byte(std::sqrt(texel[2])) << 16U |
         byte(texel[3]) << 24U;
}

// Returns the bytes of a texture with all smaller levels, which take a third more.
std::uint64_t bytes_of(const Texture& texture, std::uint32_t halvings) {
  const std::uint64_t texels =
      std::uint64_t{std::max(texture.width >> halvings, 1U)} * std::max(texture.height >> halvings, 1U);
  return texels * 16 / 3 + 4 * kMostLevels;
}

// Returns how often each texture is halved to make its first level.
std::vector<std::uint32_t> find_halvings(const std::vector<Texture>& textures) {
  std::vector<std::uint32_t> halvings(textures.size(), 0);
  std::vector<std::uint64_t> bytes;
  std::uint64_t sum = 0;
  for (const Texture& texture : textures) sum += bytes.emplace_back(bytes_of(texture, 0));
  while (sum > kMostTextureBytes) {
    const auto largest =
        static_cast<std::size_t>(std::max_element(bytes.begin(), bytes.end()) - bytes.begin());
    const std::uint64_t smaller = bytes_of(textures[largest], ++halvings[largest]);
    if (smaller == bytes[largest])
      throw Error(ErrorKind::bad_argument, "render: a scene has too many textures");
    sum -= bytes[largest] - smaller;
    bytes[largest] = smaller;
  }
  return halvings;
}

}  // namespace

std::vector<TextureLevels> make_texture_levels(const std::vector<Texture>& textures) {
  for (const Texture& texture : textures) check_texture(texture);
  const std::vector<std::uint32_t> halvings = find_halvings(textures);
  std::vector<TextureLevels> result;
  for (std::size_t i = 0; i < textures.size(); ++i) {
    TextureLevels& made = result.emplace_back();
    made.sampling = textures[i].sampling;
    Plane plane = decoded(textures[i]);
    for (std::uint32_t h = 0; h < halvings[i]; ++h) plane = halved(plane);
    for (bool last = false; !last; plane = halved(plane)) {
      TextureLevel& level = made.levels.emplace_back(TextureLevel{plane.width, plane.height, {}});
      for (const Texel& texel : plane.texels) level.texels.push_back(packed(texel));
      last = plane.width == 1 && plane.height == 1;
    }
  }
  return result;
}

}  // namespace pellucid::render
