// Computes all effects on the CPU, pixel by pixel, from complete sorted lists of fragments. It is written for
// clarity, and differs on purpose from the shaders, which see one fragment at a time.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <optional>

#include "pellucid/shading.h"
#include "render/options.h"
#include "render/scene/surface_sampler.h"

namespace pellucid {
namespace {

using Shaded = std::vector<ShadedFragment>;

// The fragments first .. last - 1, which have the same depth.
struct Group {
  std::size_t first, last;
};

// Returns the fragments in groups of one depth. `skin` is the number of steps of float32 by which depths may
// differ from that of the first of a group.
std::vector<Group> groups_of(std::span<const Fragment> fragments, std::uint32_t skin = 0) {
  std::vector<Group> groups;
  const auto bits = [&](std::size_t i) { return std::bit_cast<std::uint32_t>(fragments[i].depth); };
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    if (i == 0 || bits(i) - bits(groups.back().first) > skin) groups.push_back({i, i});
    groups.back().last = i + 1;
  }
  return groups;
}

class Reference {
 public:
  Reference(const RenderScene& scene, const Camera& camera, const RenderOptions& options);
  RenderResult draw();

 private:
  [[nodiscard]] Vec3d pixel(std::uint64_t p, std::span<const Fragment> fragments);
  [[nodiscard]] Vec3d blended(std::uint64_t p, const Shaded& shaded) const;
  void draw_edges(std::uint64_t p, Shaded& shaded) const;
  [[nodiscard]] Vec3d coplanarity(const std::vector<Group>& groups) const;
  [[nodiscard]] Vec3d complexity(std::size_t count) const;
  [[nodiscard]] Vec3d thickness(std::span<const Fragment> fragments) const;
  [[nodiscard]] Vec3d csg(std::span<const Fragment> fragments, const std::vector<Group>& groups,
                          const Shaded& shaded) const;
  [[nodiscard]] Vec3d self_collision(std::span<const Fragment> fragments, const std::vector<Group>& groups,
                                     const Shaded& shaded) const;
  [[nodiscard]] bool csg_value(const std::vector<bool>& inside) const;
  [[nodiscard]] std::optional<std::array<double, 2>> on_screen(const Vec3f& position) const;
  [[nodiscard]] double view_distance(double depth) const;
  void shade(std::uint64_t p, std::span<const Fragment> fragments);
  void keep_colors(std::uint64_t p, std::span<const Fragment> fragments,
                   std::vector<std::array<float, 4>>& colors);
  // Removes back faces of one-sided surfaces, and fragments that a texture cuts out.
  void drop_undrawn(FragmentBuffer& fragments) const;
  // Sets the background of a pixel, and returns the fragments in front of it.
  std::span<const Fragment> in_front_of_opaque(std::uint64_t p, std::span<const Fragment> fragments);
  void drop_hidden(FragmentBuffer& fragments);

  const RenderScene& scene_;
  const Camera& camera_;
  const RenderOptions& options_;
  Mesh mesh_;
  Vec3d background_;
  std::vector<Vec3d> opaque_;  // the background of every pixel, where an effect blends
  ShadingOptions shading_;
  Shaded shaded_;
  std::vector<SurfaceLook> looks_;
  std::optional<FragmentShader> shader_;
  render::SurfaceSampler sampler_;
};

Reference::Reference(const RenderScene& scene, const Camera& camera, const RenderOptions& options)
    : scene_(scene),
      camera_(camera),
      options_(options),
      background_(to_double(options.background)),
      sampler_(scene, camera) {
  mesh_.positions = scene.positions;
  mesh_.normals = scene.normals;
  mesh_.triangles = scene.triangles;
  shading_.background = options.background;
  shader_.emplace(mesh_, camera_, shading_);
}

void Reference::shade(std::uint64_t p, std::span<const Fragment> fragments) {
  looks_.clear();
  for (const Fragment& f : fragments) looks_.push_back(sampler_.look_at(p, f.node).value_or(SurfaceLook{}));
  shader_->shade(p, fragments, looks_, shaded_);
}

void Reference::drop_undrawn(FragmentBuffer& fragments) const {
  FragmentBuffer kept;
  kept.offsets.push_back(0);
  for (std::size_t p = 0; p + 1 < fragments.offsets.size(); ++p) {
    for (const Fragment& f : fragments.pixel(p)) {
      const bool back = (f.node & 1U) != 0;
      const Surface& surface = scene_.surfaces[scene_.objects[f.node / 2]];
      if (back && !surface.double_sided && !render::cuts_solids(options_.effect)) continue;
      if (surface.cutoff == 0 || sampler_.look_at(p, f.node)) kept.fragments.push_back(f);
    }
    kept.offsets.push_back(kept.fragments.size());
  }
  fragments.offsets = std::move(kept.offsets);
  fragments.fragments = std::move(kept.fragments);
}

std::span<const Fragment> Reference::in_front_of_opaque(std::uint64_t p,
                                                        std::span<const Fragment> fragments) {
  const auto opaque = std::find_if(fragments.begin(), fragments.end(), [&](const Fragment& f) {
    return scene_.surfaces[scene_.objects[triangle_of(f.node)]].opaque;
  });
  if (opaque == fragments.end()) return fragments;
  shade(p, std::span(opaque, 1));
  if (options_.effect == Effect::wireframe) draw_edges(p, shaded_);
  opaque_[p] = shaded_.front().color;
  const auto end =
      std::find_if(fragments.begin(), opaque, [&](const Fragment& f) { return f.depth >= opaque->depth; });
  return {fragments.begin(), end};
}

void Reference::drop_hidden(FragmentBuffer& fragments) {
  opaque_.assign(fragments.offsets.size() - 1, background_);
  FragmentBuffer kept;
  kept.offsets.push_back(0);
  for (std::size_t p = 0; p + 1 < fragments.offsets.size(); ++p) {
    const auto seen = in_front_of_opaque(p, fragments.pixel(p));
    kept.fragments.insert(kept.fragments.end(), seen.begin(), seen.end());
    kept.offsets.push_back(kept.fragments.size());
  }
  fragments.offsets = std::move(kept.offsets);
  fragments.fragments = std::move(kept.fragments);
}

Vec3d Reference::blended(std::uint64_t p, const Shaded& shaded) const {
  Vec3d color{};
  double transmittance = 1;
  for (const ShadedFragment& f : shaded) {
    color += f.color * (f.alpha * transmittance);
    transmittance *= 1 - f.alpha;
  }
  return color + opaque_[p] * transmittance;
}

std::optional<std::array<double, 2>> Reference::on_screen(const Vec3f& position) const {
  const Vec3d offset = to_double(position) - camera_.eye;
  const double w = camera_.perspective ? dot(offset, camera_.forward) : 1;
  if (!(w > 0)) return std::nullopt;
  const double unit = 0.5 * camera_.height / camera_.half_height;
  return {{0.5 * camera_.width + dot(offset, camera_.right) / w * unit,
           0.5 * camera_.height - dot(offset, camera_.up) / w * unit}};
}

void Reference::draw_edges(std::uint64_t p, Shaded& shaded) const {
  const std::uint64_t row = p / camera_.width;
  const std::array<double, 2> center{static_cast<double>(p % camera_.width) + 0.5,
                                     static_cast<double>(row) + 0.5};
  for (ShadedFragment& f : shaded) {
    const Triangle& t = scene_.triangles[triangle_of(f.node)];
    double nearest = 1e9;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = on_screen(scene_.positions[t[i]]);
      const auto b = on_screen(scene_.positions[t[(i + 1) % 3]]);
      if (!a || !b) continue;
      const double dx = (*b)[0] - (*a)[0];
      const double dy = (*b)[1] - (*a)[1];
      const double length = std::hypot(dx, dy);
      if (length > 0)
        nearest =
            std::min(nearest, std::abs(dx * (center[1] - (*a)[1]) - dy * (center[0] - (*a)[0])) / length);
    }
    const double place = std::clamp((nearest - 0.3) / 0.8, 0.0, 1.0);
    const double edge = 1 - place * place * (3 - 2 * place);
    f.color = f.color * (1 - edge) + to_double(options_.edge_color) * edge;
    f.alpha = f.alpha * (1 - edge) + edge;
  }
}

Vec3d Reference::coplanarity(const std::vector<Group>& groups) const {
  std::size_t largest = 0;
  for (const Group& g : groups) largest = std::max(largest, g.last - g.first);
  static constexpr std::array<Vec3d, 9> kColors{{{0.22, 0.22, 0.22},
                                                 {0.8, 0.02, 0.02},
                                                 {0.02, 0.05, 0.8},
                                                 {0.02, 0.45, 0.05},
                                                 {0, 0.75, 0.75},
                                                 {0.2, 1, 0.65},
                                                 {0.9, 0, 0.9},
                                                 {0.95, 0.9, 0},
                                                 {0.3, 0.12, 0.02}}};
  return kColors.at(std::min<std::size_t>(largest, 9) - 1);
}

Vec3d Reference::complexity(std::size_t count) const {
  static constexpr std::array<Vec3d, 8> kRamp{{{0.02, 0.03, 0.20},
                                               {0.03, 0.12, 0.55},
                                               {0.02, 0.40, 0.55},
                                               {0.05, 0.55, 0.15},
                                               {0.75, 0.70, 0.03},
                                               {0.90, 0.30, 0.02},
                                               {0.70, 0.02, 0.05},
                                               {0.95, 0.75, 0.85}}};
  const double place = std::clamp(std::log2(static_cast<double>(count)), 0.0, 6.999);
  const auto from = static_cast<std::size_t>(place);
  const double t = place - static_cast<double>(from);
  return kRamp.at(from) * (1 - t) + kRamp.at(from + 1) * t;
}

double Reference::view_distance(double depth) const {
  if (!camera_.perspective) return camera_.near_plane + depth * (camera_.far_plane - camera_.near_plane);
  return 1 / ((1 - depth) / camera_.near_plane + depth / camera_.far_plane);
}

Vec3d Reference::thickness(std::span<const Fragment> fragments) const {
  double sum = 0;
  for (const Fragment& f : fragments) {
    const double d = view_distance(double{f.depth}) - camera_.near_plane;
    sum += (f.node & 1U) != 0 ? d : -d;
  }
  const double share = std::max(sum / (camera_.far_plane - camera_.near_plane), 0.0);
  return {background_.x * std::exp(-9.0 * share), background_.y * std::exp(-4.5 * share),
          background_.z * std::exp(-1.8 * share)};
}

bool Reference::csg_value(const std::vector<bool>& inside) const {
  const auto count = std::count(inside.begin(), inside.end(), true);
  if (options_.csg == CsgOperation::union_of_all) return count > 0;
  if (options_.csg == CsgOperation::intersection) return static_cast<std::size_t>(count) == inside.size();
  return inside[0] && count == 1;
}

Vec3d Reference::csg(std::span<const Fragment> fragments, const std::vector<Group>& groups,
                     const Shaded& shaded) const {
  std::vector<bool> inside(scene_.surfaces.size(), false);
  for (const Group& g : groups) {
    const bool before = csg_value(inside);
    for (std::size_t i = g.first; i < g.last; ++i) {
      const std::uint32_t object = scene_.objects[fragments[i].node / 2];
      inside[object] = !inside[object];
    }
    if (csg_value(inside) != before) return shaded[g.first].color;
  }
  return background_;
}

Vec3d Reference::self_collision(std::span<const Fragment> fragments, const std::vector<Group>& groups,
                                const Shaded& shaded) const {
  std::map<std::uint32_t, int> inside;
  bool collides = false;
  for (const Group& g : groups) {
    std::map<std::uint32_t, int> entered;
    for (std::size_t i = g.first; i < g.last; ++i) {
      const std::uint32_t object = scene_.objects[fragments[i].node / 2];
      const bool back = (fragments[i].node & 1U) != 0;
      if (!back) ++entered[object];
      if (back) --inside[object];
    }
    for (const auto& [object, count] : entered) {
      inside[object] += count;
      collides = collides || inside[object] >= 2;
    }
  }
  const Vec3d& nearest = shaded.front().color;
  const double gray = 0.2126 * nearest.x + 0.7152 * nearest.y + 0.0722 * nearest.z;
  if (collides) return {0.25 + 0.6 * gray, 0.02, 0.02};
  return {0.15 + 0.7 * gray, 0.15 + 0.7 * gray, 0.15 + 0.7 * gray};
}

Vec3d Reference::pixel(std::uint64_t p, std::span<const Fragment> fragments) {
  if (fragments.empty()) return opaque_.empty() ? background_ : opaque_[p];
  shade(p, fragments);
  const std::vector<Group> groups = groups_of(fragments);
  switch (options_.effect) {
    case Effect::wireframe:
      draw_edges(p, shaded_);
      return blended(p, shaded_);
    case Effect::csg:
      // As in shaders/resolve/csg.glsl: faces in one plane that are cut into different triangles are one.
      return csg(fragments, groups_of(fragments, 32), shaded_);
    case Effect::self_collision:
      return self_collision(fragments, groups, shaded_);
    case Effect::coplanarity:
      return coplanarity(groups);
    case Effect::complexity:
      return complexity(fragments.size());
    case Effect::thickness:
      return thickness(fragments);
    case Effect::transparency:
      break;
  }
  return blended(p, shaded_);
}

void Reference::keep_colors(std::uint64_t p, std::span<const Fragment> fragments,
                            std::vector<std::array<float, 4>>& colors) {
  if (fragments.empty()) return;
  shade(p, fragments);
  for (const ShadedFragment& f : shaded_) {
    const Vec3f color = to_float(f.color);
    colors.push_back({color.x, color.y, color.z, static_cast<float>(f.alpha)});
  }
}

RenderResult Reference::draw() {
  const Stopwatch watch;
  FragmentBuffer fragments;
  rasterize(mesh_, camera_, {}, fragments);
  drop_undrawn(fragments);
  if (render::blends(options_.effect)) drop_hidden(fragments);
  RenderResult result;
  result.width = camera_.width;
  result.height = camera_.height;
  CaptureStats& stats = result.stats;
  stats.fragments = stats.captured = fragments.fragments.size();
  for (std::size_t p = 0; p + 1 < fragments.offsets.size(); ++p) {
    const auto list = fragments.pixel(p);
    result.pixels.push_back(to_float(pixel(p, list)));
    if (options_.keep_fragments) keep_colors(p, list, result.fragments.colors);
    stats.covered_pixels += list.empty() ? 0U : 1U;
    stats.deepest_pixel = std::max<std::uint64_t>(stats.deepest_pixel, list.size());
    std::uint64_t coplanar = 0;
    for (const Group& g : groups_of(list)) coplanar += g.last - g.first > 1 ? g.last - g.first : 0;
    stats.coplanar += coplanar;
    stats.coplanar_pixels += coplanar > 0 ? 1U : 0U;
  }
  stats.seen_pixels = stats.covered_pixels;
  stats.geometry_passes = 1;
  stats.bytes = 8 * (fragments.fragments.size() + fragments.offsets.size());
  stats.milliseconds = 1000 * watch.seconds();
  if (options_.keep_fragments) {
    result.fragments.offsets = std::move(fragments.offsets);
    result.fragments.fragments = std::move(fragments.fragments);
  }
  return result;
}

}  // namespace

RenderResult draw_reference(const RenderScene& scene, const Camera& camera, const RenderOptions& options) {
  render::check_effect(options.effect, scene.surfaces.size());
  if (options.samples != 1)
    throw Error(ErrorKind::bad_argument,
                "the reference on the CPU has one sample a pixel: choose another technique");
  if (options.peeling.cull)
    throw Error(ErrorKind::bad_argument,
                "the reference on the CPU draws nothing twice, so it cannot cull: choose another technique");
  return Reference(scene, camera, options).draw();
}

}  // namespace pellucid
