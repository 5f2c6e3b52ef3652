// Textures as words of a buffer, so that a draw may use any number of them of any size. Each texture has a
// head of 20 words: sides, levels, sampling (bits 0..1 and 2..3: wrap modes; 4..5: use of levels; 6 and 7:
// filters), and where each level begins. A texel has eight bits per channel: linear colour in gamma 2, then
// opacity.
#ifndef TEXTURE_GLSL
#define TEXTURE_GLSL
layout(std430, set = 0, binding = SLOT_TEXTURES) readonly buffer Textures { uint texture_words[]; };
const uint kTextureHead = 20u;
const uint kWrapRepeat = 0u;
const uint kWrapMirror = 1u;
const uint kLevelsNearest = 1u;
const uint kLevelsNone = 2u;
const uint kMagnifyNearest = 6u;
const uint kMinifyNearest = 7u;

// Wraps a coordinate into 0..1.
float wrapped(float x, uint wrap) {
  if (wrap == kWrapRepeat) return x - floor(x);
  if (wrap == kWrapMirror) return 1.0 - abs(1.0 - (x - 2.0 * floor(0.5 * x)));
  return clamp(x, 0.0, 1.0);
}

int neighbour(int i, int side, uint wrap) {
  if (wrap == kWrapRepeat) return i < 0 ? side - 1 : i >= side ? 0 : i;
  return clamp(i, 0, side - 1);
}

vec4 texel(uint begin, int width, ivec2 at) {
  const vec4 c = unpackUnorm4x8(texture_words[begin + uint(at.y * width + at.x)]);
  return vec4(c.rgb * c.rgb, c.a);
}

vec4 sample_level(uint head, uint level, vec2 at, bool nearest) {
  const uint sampling = texture_words[head + 3u];
  const uvec2 wraps = uvec2(sampling & 3u, (sampling >> 2) & 3u);
  const ivec2 size = max(ivec2(texture_words[head], texture_words[head + 1u]) >> int(level), ivec2(1));
  const vec2 place = vec2(wrapped(at.x, wraps.x), wrapped(at.y, wraps.y)) * vec2(size) - (nearest ? 0.0 : 0.5);
  const ivec2 low = ivec2(floor(place));
  const vec2 share = place - vec2(low);
  const ivec2 a = ivec2(neighbour(low.x, size.x, wraps.x), neighbour(low.y, size.y, wraps.y));
  const ivec2 b = ivec2(neighbour(low.x + 1, size.x, wraps.x), neighbour(low.y + 1, size.y, wraps.y));
  const uint begin = texture_words[head + 4u + level];
  if (nearest) return texel(begin, size.x, a);
  return mix(mix(texel(begin, size.x, a), texel(begin, size.x, ivec2(b.x, a.y)), share.x),
             mix(texel(begin, size.x, ivec2(a.x, b.y)), texel(begin, size.x, b), share.x), share.y);
}

// Samples a texture. `dx` and `dy` say how the coordinates change from pixel to pixel.
vec4 sample_texture(uint number, vec2 at, vec2 dx, vec2 dy) {
  const uint head = kTextureHead * number;
  const vec2 size = vec2(texture_words[head], texture_words[head + 1u]);
  const uint last = texture_words[head + 2u] - 1u;
  const uint sampling = texture_words[head + 3u];
  const float texels = max(length(dx * size), length(dy * size));
  if (!(texels > 1.0)) return sample_level(head, 0u, at, ((sampling >> kMagnifyNearest) & 1u) != 0u);
  const bool nearest = ((sampling >> kMinifyNearest) & 1u) != 0u;
  const uint use = (sampling >> 4) & 3u;
  const float level = min(log2(texels), float(last));
  if (use == kLevelsNone) return sample_level(head, 0u, at, nearest);
  if (use == kLevelsNearest) return sample_level(head, uint(ceil(level + 0.5)) - 1u, at, nearest);
  const uint finer = uint(level);
  const vec4 color = sample_level(head, finer, at, nearest);
  const float share = level - float(finer);
  if (share == 0.0) return color;
  return mix(color, sample_level(head, min(finer + 1u, last), at, nearest), share);
}
#endif
