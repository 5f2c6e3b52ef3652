// Implements pellucid/shading.h and the image functions of pellucid/metric.h: shades and blends fragments,
// finds the pixels of a frame that are in a wrong order, and makes images.
#include "pellucid/shading.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "pellucid/metric.h"

namespace pellucid {

namespace {

// The shares of the light: ambient, from the eye, and from the upper left behind the eye.
constexpr double kAmbient = 0.2;
constexpr double kHeadlight = 0.62;
constexpr double kFill = 0.45;
// The highlight of the fill light (Blinn-Phong, exponent 48).
constexpr double kHighlight = 0.35;
// A thin sheet of opacity a that is seen under cosine c transmits (1 - a)^(1 / c) (Beer-Lambert). This bounds
// 1 / c.
constexpr double kGrazingCosine = 0.2;

// Depth ramp from near to far, sRGB: falling lightness, turning hue.
constexpr std::array<Vec3d, 5> kRamp{
    {{0.99, 0.90, 0.45}, {0.97, 0.55, 0.30}, {0.79, 0.25, 0.45}, {0.44, 0.14, 0.55}, {0.11, 0.09, 0.36}}};

Vec3d linear_from_srgb(const Vec3d& c) {
  return {pellucid::linear_from_srgb(c.x), pellucid::linear_from_srgb(c.y), pellucid::linear_from_srgb(c.z)};
}
Vec3d encoded_srgb(const Vec3d& c) {
  return {srgb_from_linear(c.x), srgb_from_linear(c.y), srgb_from_linear(c.z)};
}

double to_the_48th(double x) {
  const double x2 = x * x;
  const double x4 = x2 * x2;
  const double x8 = x4 * x4;
  const double x16 = x8 * x8;
  return x16 * x16 * x16;
}

// Fragments keep colours of 0..2 (pack_color() in shaders/frame.glsl). Only surfaces that emit light exceed
// it.
Vec3d clipped(const Vec3d& color) {
  constexpr double kBrightest = 2;
  return {std::clamp(color.x, 0.0, kBrightest), std::clamp(color.y, 0.0, kBrightest),
          std::clamp(color.z, 0.0, kBrightest)};
}

Vec3d flipped_towards(const Vec3d& v, const Vec3d& side) {
  return dot(v, side) < 0 ? -v : v;
}

}  // namespace

double srgb_from_linear(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

double linear_from_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

FragmentShader::FragmentShader(const Mesh& mesh, const Camera& camera, const ShadingOptions& options)
    : mesh_(mesh), camera_(camera), options_(options) {
  if (options_.looks.empty()) options_.looks.push_back({options_.color, options_.alpha});
  for (const SurfaceLook& look : options_.looks) log2_transmittances_.push_back(std::log2(1 - look.alpha));
  const bool lit = options.shading == Shading::lit;
  if (lit && mesh.normals.size() != mesh.positions.size()) computed_normals_ = vertex_normals(mesh);
  normals_ = computed_normals_.empty() ? std::span(mesh.normals) : std::span(computed_normals_);
  fill_light_ = normalized(camera.up * 0.8 - camera.right * 0.55 - camera.forward * 0.35);
  for (std::size_t i = 0; i < ramp_.size(); ++i) ramp_[i] = linear_from_srgb(kRamp[i]);
}

Vec3d FragmentShader::background() const {
  return encoded_srgb(to_double(options_.background));
}

void FragmentShader::shade(std::uint64_t pixel, std::span<const Fragment> fragments,
                           std::vector<ShadedFragment>& shaded) const {
  const Ray ray = ray_through(pixel);
  const bool lit = options_.shading == Shading::lit;
  shaded.clear();
  for (const Fragment& f : fragments) {
    const std::uint32_t look =
        options_.triangle_looks.empty() ? 0 : options_.triangle_looks[triangle_of(f.node)];
    shaded.push_back(lit ? shade_lit(ray, f.node, options_.looks[look], log2_transmittances_[look])
                         : shade_depth(f));
  }
}

void FragmentShader::shade(std::uint64_t pixel, std::span<const Fragment> fragments,
                           std::span<const SurfaceLook> looks, std::vector<ShadedFragment>& shaded) const {
  const Ray ray = ray_through(pixel);
  shaded.clear();
  for (std::size_t i = 0; i < fragments.size(); ++i)
    shaded.push_back(shade_lit(ray, fragments[i].node, looks[i], std::log2(1 - looks[i].alpha)));
}

Vec3d FragmentShader::blend(std::span<const ShadedFragment> front_to_back) const {
  Vec3d color{};
  double transmittance = 1;
  for (const ShadedFragment& fragment : front_to_back) {
    color += fragment.color * (fragment.alpha * transmittance);
    transmittance *= 1 - fragment.alpha;
  }
  return encoded_srgb(color + to_double(options_.background) * transmittance);
}

FragmentShader::Ray FragmentShader::ray_through(std::uint64_t pixel) const {
  const double unit = 2 * camera_.half_height / camera_.height;
  const std::uint64_t row = pixel / camera_.width;
  const std::uint64_t column = pixel % camera_.width;
  const double x = (static_cast<double>(column) + 0.5 - 0.5 * camera_.width) * unit;
  const double y = (0.5 * camera_.height - static_cast<double>(row) - 0.5) * unit;
  const Vec3d offset = camera_.right * x + camera_.up * y;
  if (camera_.perspective) return {camera_.eye, normalized(camera_.forward + offset)};
  return {camera_.eye + offset, camera_.forward};
}

Vec3d FragmentShader::normal_at(const Ray& ray, NodeId node) const {
  const Triangle& t = mesh_.triangles[triangle_of(node)];
  const Vec3d a = to_double(mesh_.positions[t[0]]);
  const Vec3d ab = to_double(mesh_.positions[t[1]]) - a;
  const Vec3d ac = to_double(mesh_.positions[t[2]]) - a;
  const Vec3d face = cross(ab, ac);
  const Vec3d shown = is_flipped(node) ? -face : face;

  // Barycentric coordinates of the point on the ray (Moeller, Trumbore 1997). They are computed in space and
  // are therefore right in perspective.
  const double determinant = -dot(face, ray.direction);
  const Vec3d offset = ray.origin - a;
  const Vec3d moment = cross(offset, ray.direction);
  double v = dot(ac, moment) / determinant;
  double w = -dot(ab, moment) / determinant;
  if (!std::isfinite(v) || !std::isfinite(w)) v = w = 1.0 / 3;
  // Vertices snap to a grid, so that pixel centres a little outside the triangle can be covered, too.
  v = std::clamp(v, 0.0, 1.0);
  w = std::clamp(w, 0.0, 1.0 - v);
  const Vec3d smooth =
      to_double(normals_[t[0]]) * (1 - v - w) + to_double(normals_[t[1]]) * v + to_double(normals_[t[2]]) * w;
  const Vec3d normal = normalized(dot(smooth, smooth) > 0 ? smooth : face);
  return flipped_towards(normal, shown);
}

ShadedFragment FragmentShader::shade_lit(const Ray& ray, NodeId node, const SurfaceLook& look,
                                         double log2_transmittance) const {
  if (look.unlit) return {clipped(to_double(look.color) + to_double(look.emissive)), look.alpha, node};
  const Vec3d normal = normal_at(ray, node);
  const Vec3d to_eye = -ray.direction;
  const double facing = std::clamp(dot(normal, to_eye), 0.0, 1.0);
  const double fill = std::max(dot(normal, fill_light_), 0.0);
  const double highlight = std::max(dot(normal, normalized(fill_light_ + to_eye)), 0.0);

  const double diffuse = kAmbient + kHeadlight * facing + kFill * fill;
  const double gloss = kHighlight * to_the_48th(highlight);
  const double alpha = 1 - std::exp2(log2_transmittance / std::max(facing, kGrazingCosine));
  const Vec3d reflected = to_double(look.color) * diffuse + Vec3d{gloss, gloss, gloss};
  return {clipped(reflected + to_double(look.emissive)), alpha, node};
}

ShadedFragment FragmentShader::shade_depth(const Fragment& fragment) const {
  const double place = std::clamp(double{fragment.depth}, 0.0, 1.0) * static_cast<double>(ramp_.size() - 1);
  const auto from = std::min(static_cast<std::size_t>(place), ramp_.size() - 2);
  const double t = place - static_cast<double>(from);
  return {ramp_[from] * (1 - t) + ramp_[from + 1] * t, options_.alpha, fragment.node};
}

void put_in_drawn_order(std::vector<ShadedFragment>& fragments, std::span<const std::uint32_t> ranks) {
  std::erase_if(fragments, [&](const ShadedFragment& f) { return ranks[f.node] == kNoRank; });
  std::sort(fragments.begin(), fragments.end(),
            [&](const ShadedFragment& a, const ShadedFragment& b) { return ranks[a.node] < ranks[b.node]; });
}

// ----------------------------------------------------------------------------------- wrong pixels of a frame

bool pixel_in_order(std::span<const Fragment> fragments, std::span<const std::uint32_t> ranks) {
  // Every fragment must come after all that are nearer by more than a tie.
  std::size_t nearer = 0;            // how many of the nearer fragments have been seen so far
  std::uint32_t highest_nearer = 0;  // the highest rank of these, plus one
  for (const Fragment& fragment : fragments) {
    const std::uint32_t rank = ranks[fragment.node];
    if (rank == kNoRank) return false;
    for (; fragment.depth - fragments[nearer].depth > kDepthTie; ++nearer) {
      highest_nearer = std::max(highest_nearer, ranks[fragments[nearer].node] + 1);
    }
    if (rank + 1 < highest_nearer) return false;
  }
  return true;
}

bool pixel_is_verified(std::span<const Fragment> fragments, std::span<const std::uint32_t> ranks) {
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const std::uint32_t rank = ranks[fragments[i].node];
    if (rank == kNoRank) return false;
    if (i == 0) continue;
    if (fragments[i].depth <= fragments[i - 1].depth || rank < ranks[fragments[i - 1].node]) return false;
  }
  return true;
}

PixelCount count_incorrect_pixels(const FragmentBuffer& fragments, std::span<const std::uint32_t> ranks) {
  PixelCount count;
  const std::uint64_t pixels = std::uint64_t{fragments.width} * fragments.height;
  for (std::uint64_t p = 0; p < pixels; ++p) {
    const std::span<const Fragment> pixel = fragments.pixel(p);
    if (pixel.empty()) continue;
    ++count.foreground;
    if (pixel_is_verified(pixel, ranks)) continue;
    ++count.repaired;
    if (!pixel_in_order(pixel, ranks)) ++count.incorrect;
  }
  return count;
}

double FrameError::psnr() const {
  if (squared_error <= 0) return kPerfectPsnr;
  const double mean = squared_error / (3 * static_cast<double>(foreground));
  return std::min(kPerfectPsnr, -10 * std::log10(mean));
}

FrameError frame_error(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
                       std::span<const std::uint32_t> ranks, const ShadingOptions& shading) {
  const FragmentShader shader(mesh, camera, shading);
  FrameError error;
  std::vector<ShadedFragment> shaded;
  const std::size_t pixels = std::size_t{fragments.width} * fragments.height;
  for (std::size_t p = 0; p < pixels; ++p) {
    const std::span<const Fragment> list = fragments.pixel(p);
    if (list.empty()) continue;
    ++error.foreground;
    if (pixel_is_verified(list, ranks)) continue;
    ++error.repaired;
    // A pixel in order blends to the same colour by construction.
    if (pixel_in_order(list, ranks)) continue;
    ++error.incorrect;
    shader.shade(p, list, shaded);
    const Vec3d exact = shader.blend(shaded);
    put_in_drawn_order(shaded, ranks);
    const Vec3d difference = exact - shader.blend(shaded);
    error.squared_error += dot(difference, difference);
  }
  return error;
}

// ----------------------------------------------------------------------------------------- images of a frame

namespace {

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

void put(Image& image, std::size_t pixel, const Vec3d& srgb) {
  image.rgb[3 * pixel] = to_byte(srgb.x);
  image.rgb[3 * pixel + 1] = to_byte(srgb.y);
  image.rgb[3 * pixel + 2] = to_byte(srgb.z);
}

Image blank(const FragmentBuffer& fragments) {
  return {fragments.width, fragments.height,
          std::vector<std::uint8_t>(3UL * fragments.width * fragments.height)};
}

// Blends every pixel after `arrange` has put its fragments in order. Rows are processed in parallel.
template <class Arrange>
Image shade(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
            const ShadingOptions& options, const Arrange& arrange) {
  const FragmentShader shader(mesh, camera, options);
  const Vec3d background = shader.background();
  Image image = blank(fragments);
  parallel_loop(std::uint32_t{0}, fragments.height, [&](std::uint32_t y) {
    std::vector<ShadedFragment> shaded;
    for (std::uint32_t x = 0; x < fragments.width; ++x) {
      const std::size_t p = std::size_t{y} * fragments.width + x;
      const std::span<const Fragment> list = fragments.pixel(p);
      if (list.empty()) {
        put(image, p, background);
        continue;
      }
      shader.shade(p, list, shaded);
      arrange(shaded);
      put(image, p, shader.blend(shaded));
    }
  });
  return image;
}

constexpr double kNoDepth = std::numeric_limits<double>::infinity();

// Returns the depth of the nearest fragment of a pixel.
double front_depth(const FragmentBuffer& fragments, std::uint32_t x, std::uint32_t y) {
  const std::span<const Fragment> list = fragments.pixel(std::size_t{y} * fragments.width + x);
  return list.empty() ? kNoDepth : double{list.front().depth};
}

// An outline is drawn where the depth of the front surface jumps by more than this share of the depth range.
constexpr double kOutlineJump = 0.02;

}  // namespace

Image shade_exact(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
                  const ShadingOptions& options) {
  return shade(mesh, camera, fragments, options, [](const std::vector<ShadedFragment>&) {});
}

Image shade_ordered(const Mesh& mesh, const Camera& camera, const FragmentBuffer& fragments,
                    std::span<const std::uint32_t> ranks, const ShadingOptions& options) {
  return shade(mesh, camera, fragments, options,
               [ranks](std::vector<ShadedFragment>& list) { put_in_drawn_order(list, ranks); });
}

Image error_image(const FragmentBuffer& fragments, std::span<const std::uint32_t> ranks) {
  double nearest = kNoDepth;
  double farthest = 0;
  for (std::uint32_t y = 0; y < fragments.height; ++y) {
    for (std::uint32_t x = 0; x < fragments.width; ++x) {
      const double depth = front_depth(fragments, x, y);
      nearest = std::min(nearest, depth);
      if (depth < kNoDepth) farthest = std::max(farthest, depth);
    }
  }
  const double range = std::max(farthest - nearest, 1e-6);

  Image image = blank(fragments);
  for (std::uint32_t y = 0; y < fragments.height; ++y) {
    for (std::uint32_t x = 0; x < fragments.width; ++x) {
      const std::size_t p = std::size_t{y} * fragments.width + x;
      const double depth = front_depth(fragments, x, y);
      if (depth == kNoDepth) {
        put(image, p, {1, 1, 1});
      } else if (!pixel_in_order(fragments.pixel(p), ranks)) {
        put(image, p, {0.9, 0.05, 0.05});
      } else {
        // Farther pixels are paler, and depth jumps have an outline.
        const double left = x > 0 ? front_depth(fragments, x - 1, y) : kNoDepth;
        const double above = y > 0 ? front_depth(fragments, x, y - 1) : kNoDepth;
        const bool outline = std::max(std::abs(left - depth), std::abs(above - depth)) > kOutlineJump * range;
        const double grey = 0.80 + 0.14 * (depth - nearest) / range - (outline ? 0.12 : 0.0);
        put(image, p, {grey, grey, grey});
      }
    }
  }
  return image;
}

}  // namespace pellucid
