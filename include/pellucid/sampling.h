// pellucid/sampling.h - how a texture is sampled: glTF 2.0, section 3.8.4.
#pragma once

namespace pellucid {

enum class TextureWrap { repeat, mirror, clamp };
enum class TextureFilter { linear, nearest };

// Smaller levels of a texture, where several texels meet in a pixel: mixed, the one that fits best, or none.
enum class TextureLevelsUse { mixed, nearest, none };

struct TextureSampling {
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
  TextureFilter magnify = TextureFilter::linear;  // where a texel covers a pixel or more
  TextureFilter minify = TextureFilter::linear;   // elsewhere, within a level
  TextureLevelsUse levels = TextureLevelsUse::mixed;

  bool operator==(const TextureSampling&) const = default;
};

}  // namespace pellucid
