// Implements surface_sampler.h: perspective weights, and wrapped and filtered texels.
#include "render/scene/surface_sampler.h"

#include <algorithm>
#include <cmath>

namespace pellucid::render {
namespace {

using Color = std::array<double, 4>;

Color mixed(const Color& a, const Color& b, double share) {
  Color c{};
  for (std::size_t k = 0; k < 4; ++k) c.at(k) = a.at(k) * (1 - share) + b.at(k) * share;
  return c;
}

Color times(const Color& a, const Color& b) {
  return {a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]};
}

// Returns the texel of a row of `count` that the index `i`, which may lie outside of the row, is wrapped to.
std::int64_t texel_of(double i, std::int64_t count, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp)
    return static_cast<std::int64_t>(std::clamp(i, 0.0, static_cast<double>(count - 1)));
  const double period = static_cast<double>(wrap == TextureWrap::mirror ? 2 * count : count);
  const auto inside = static_cast<std::int64_t>(i - period * std::floor(i / period));
  return inside < count ? inside : 2 * count - 1 - inside;
}

Color texel(const TextureLevel& level, std::int64_t x, std::int64_t y) {
  const std::uint32_t word = level.texels[static_cast<std::size_t>(y * level.width + x)];
  const auto channel = [&](unsigned shift) { return ((word >> shift) & 255U) / 255.0; };
  const auto linear = [&](unsigned shift) { return channel(shift) * channel(shift); };
  return {linear(0), linear(8), linear(16), channel(24)};
}

Color filtered(const TextureLevels& texture, std::size_t level_number, double u, double v,
               TextureFilter filter) {
  const TextureLevel& level = texture.levels[level_number];
  const double x = u * level.width - 0.5;
  const double y = v * level.height - 0.5;
  const auto at = [&](double column, double row) {
    return texel(level, texel_of(column, level.width, texture.sampling.wrap_u),
                 texel_of(row, level.height, texture.sampling.wrap_v));
  };
  if (filter == TextureFilter::nearest) return at(std::floor(x + 0.5), std::floor(y + 0.5));
  const double left = std::floor(x);
  const double top = std::floor(y);
  return mixed(mixed(at(left, top), at(left + 1, top), x - left),
               mixed(at(left, top + 1), at(left + 1, top + 1), x - left), y - top);
}

}  // namespace

SurfaceSampler::SurfaceSampler(const RenderScene& scene, const Camera& camera)
    : scene_(scene), camera_(camera), textures_(make_texture_levels(scene.textures)) {}

SurfaceSampler::Weights SurfaceSampler::weights_at(const Place& point, const Triangle& triangle) const {
  const double unit = 2 * camera_.half_height / camera_.height;
  const Vec3d across = camera_.right * ((point[0] - 0.5 * camera_.width) * unit) +
                       camera_.up * ((0.5 * camera_.height - point[1]) * unit);
  const Vec3d origin = camera_.perspective ? camera_.eye : camera_.eye + across;
  const Vec3d direction = camera_.perspective ? camera_.forward + across : camera_.forward;
  // The weights are the volumes of the three tetrahedra that the ray makes with the edges.
  std::array<Vec3d, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) corners.at(i) = to_double(scene_.positions[triangle.at(i)]) - origin;
  Weights weights{};
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    weights.at(i) = dot(direction, cross(corners.at((i + 1) % 3), corners.at((i + 2) % 3)));
    sum += weights.at(i);
  }
  if (sum == 0) return {1.0 / 3, 1.0 / 3, 1.0 / 3};
  for (double& weight : weights) weight /= sum;
  return weights;
}

SurfaceSampler::Place SurfaceSampler::texcoord_at(const Place& point, const Triangle& triangle) const {
  const Weights weights = weights_at(point, triangle);
  Place place{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 2; ++k)
      place.at(k) += weights.at(i) * static_cast<double>(scene_.texcoords[triangle.at(i)].at(k));
  }
  return place;
}

SurfaceSampler::Color SurfaceSampler::vertex_color(const Place& point, const Triangle& triangle) const {
  const Weights weights = weights_at(point, triangle);
  Color color{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 4; ++k)
      color.at(k) += weights.at(i) * static_cast<double>(scene_.colors[triangle.at(i)].at(k));
  }
  return color;
}

SurfaceSampler::Color SurfaceSampler::texture_color(std::uint32_t number, const Place& point,
                                                    const Triangle& triangle) const {
  const TextureLevels& texture = textures_[number];
  const Place here = texcoord_at(point, triangle);
  const auto texels_to = [&](const Place& other) {
    const Place there = texcoord_at(other, triangle);
    return std::hypot((there[0] - here[0]) * texture.levels[0].width,
                      (there[1] - here[1]) * texture.levels[0].height);
  };
  const double texels = std::max(texels_to({point[0] + 1, point[1]}), texels_to({point[0], point[1] + 1}));
  const auto on = [&](std::size_t level, TextureFilter filter) {
    return filtered(texture, std::min(level, texture.levels.size() - 1), here[0], here[1], filter);
  };
  const TextureSampling& how = texture.sampling;
  // Written so that it also holds if the coordinates are so large that their differences are NaN.
  if (!(texels > 1)) return on(0, how.magnify);
  const double level = std::min(std::log2(texels), static_cast<double>(texture.levels.size() - 1));
  if (how.levels == TextureLevelsUse::none) return on(0, how.minify);
  if (how.levels == TextureLevelsUse::nearest)
    return on(static_cast<std::size_t>(std::ceil(level + 0.5) - 1), how.minify);
  const auto finer = static_cast<std::size_t>(level);
  return mixed(on(finer, how.minify), on(finer + 1, how.minify), level - std::floor(level));
}

std::optional<SurfaceLook> SurfaceSampler::look_at(std::uint64_t pixel, NodeId node) const {
  const Surface& surface = scene_.surfaces[scene_.objects[triangle_of(node)]];
  const Triangle& triangle = scene_.triangles[triangle_of(node)];
  const std::uint64_t row = pixel / camera_.width;
  const Place center{static_cast<double>(pixel % camera_.width) + 0.5, static_cast<double>(row) + 0.5};
  const Vec3d plain = to_double(surface.color);
  Color color{plain.x, plain.y, plain.z, static_cast<double>(surface.alpha)};
  if (!scene_.colors.empty()) color = times(color, vertex_color(center, triangle));
  if (surface.texture) color = times(color, texture_color(*surface.texture, center, triangle));
  if (surface.cutoff > 0 && color[3] < static_cast<double>(surface.cutoff)) return std::nullopt;
  const Vec3d strength = to_double(surface.emissive);
  Color emissive{strength.x, strength.y, strength.z, 1};
  if (surface.emissive_texture)
    emissive = times(emissive, texture_color(*surface.emissive_texture, center, triangle));
  return SurfaceLook{to_float({color[0], color[1], color[2]}),
                     surface.opaque ? 1.0 : std::clamp(color[3], 0.0, 1.0), surface.unlit,
                     to_float({emissive[0], emissive[1], emissive[2]})};
}

}  // namespace pellucid::render
