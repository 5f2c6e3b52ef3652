// Colour and opacity of single fragments, and what a pixel's fragments blend to: see pellucid/shading.h.
#include <algorithm>
#include <cmath>

#include "pellucid/shading.h"

namespace pellucid {
namespace {

// Shares of the light: from everywhere, from the eye, and from the upper left behind it.
constexpr double kAmbient = 0.2;
constexpr double kHeadlight = 0.62;
constexpr double kFill = 0.45;
// The highlight of the fill light (Blinn-Phong, exponent 48).
constexpr double kHighlight = 0.35;
// A thin sheet of alpha a seen under cosine c lets (1 - a)^(1 / c) through (Beer-Lambert); this bounds 1 / c.
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
    shaded.push_back(lit ? shade_lit(ray, f.node, options_.looks[look].color, log2_transmittances_[look])
                         : shade_depth(f));
  }
}

void FragmentShader::shade(std::uint64_t pixel, std::span<const Fragment> fragments,
                           std::span<const SurfaceLook> looks, std::vector<ShadedFragment>& shaded) const {
  const Ray ray = ray_through(pixel);
  shaded.clear();
  for (std::size_t i = 0; i < fragments.size(); ++i)
    shaded.push_back(shade_lit(ray, fragments[i].node, looks[i].color, std::log2(1 - looks[i].alpha)));
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

  // Barycentric coordinates of the ray's point (Moeller, Trumbore 1997): in space, hence right in
  // perspective.
  const double determinant = -dot(face, ray.direction);
  const Vec3d offset = ray.origin - a;
  const Vec3d moment = cross(offset, ray.direction);
  double v = dot(ac, moment) / determinant;
  double w = -dot(ab, moment) / determinant;
  if (!std::isfinite(v) || !std::isfinite(w)) v = w = 1.0 / 3;
  // Snapping covers centres a little outside, too.
  v = std::clamp(v, 0.0, 1.0);
  w = std::clamp(w, 0.0, 1.0 - v);
  const Vec3d smooth =
      to_double(normals_[t[0]]) * (1 - v - w) + to_double(normals_[t[1]]) * v + to_double(normals_[t[2]]) * w;
  const Vec3d normal = normalized(dot(smooth, smooth) > 0 ? smooth : face);
  return flipped_towards(normal, shown);
}

ShadedFragment FragmentShader::shade_lit(const Ray& ray, NodeId node, const Vec3f& color,
                                         double log2_transmittance) const {
  const Vec3d normal = normal_at(ray, node);
  const Vec3d to_eye = -ray.direction;
  const double facing = std::clamp(dot(normal, to_eye), 0.0, 1.0);
  const double fill = std::max(dot(normal, fill_light_), 0.0);
  const double highlight = std::max(dot(normal, normalized(fill_light_ + to_eye)), 0.0);

  const double diffuse = kAmbient + kHeadlight * facing + kFill * fill;
  const double gloss = kHighlight * to_the_48th(highlight);
  const double alpha = 1 - std::exp2(log2_transmittance / std::max(facing, kGrazingCosine));
  return {to_double(color) * diffuse + Vec3d{gloss, gloss, gloss}, alpha, node};
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

}  // namespace pellucid
