// Implements gpu_scene.h: checks a scene, sorts its triangles for drawing and copies it to the device.
#include "render/scene/gpu_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <tuple>

#include "render/frame.h"
#include "render/scene/texture_levels.h"

namespace pellucid::render {
namespace {

// Ids are 2 * (triangle + 1) + side and must fit into 32 bits.
constexpr std::uint64_t kMostTriangles = (1ULL << 31U) - 2;

[[noreturn]] void complain(const std::string& what) {
  throw Error(ErrorKind::bad_argument, "render: " + what);
}

void check_looks(const RenderScene& scene) {
  const auto fits = [&](std::size_t count) { return count == 0 || count == scene.positions.size(); };
  if (!fits(scene.texcoords.size()) || !fits(scene.colors.size()))
    complain("a scene has texture coordinates and colours for every position, or for none");
  for (const Surface& s : scene.surfaces) {
    for (const std::optional<std::uint32_t>& texture : {s.texture, s.emissive_texture}) {
      if (texture && *texture >= scene.textures.size()) complain("a surface has a texture that is not there");
      if (texture && scene.texcoords.empty()) complain("a textured scene has texture coordinates");
    }
  }
}

void check_scene(const RenderScene& scene) {
  if (scene.triangles.size() > kMostTriangles) complain("a scene of 2^31 triangles and more cannot be drawn");
  if (scene.normals.size() != scene.positions.size()) complain("a scene has one normal for every position");
  if (scene.objects.size() != scene.triangles.size()) complain("a scene has one object for every triangle");
  const auto vertices = scene.positions.size();
  for (const Triangle& t : scene.triangles) {
    if (t[0] >= vertices || t[1] >= vertices || t[2] >= vertices)
      complain("a triangle has a vertex that is not there");
  }
  for (const std::uint32_t object : scene.objects) {
    if (object >= scene.surfaces.size()) complain("a triangle has an object that is not there");
  }
  check_looks(scene);
  if (scene.draw_order.empty()) return;
  std::vector<bool> seen(scene.triangles.size());
  for (const std::uint32_t triangle : scene.draw_order) {
    if (triangle >= seen.size() || seen[triangle]) complain("the draw order is not a permutation");
    seen[triangle] = true;
  }
  if (scene.draw_order.size() != scene.triangles.size()) complain("the draw order is not a permutation");
}

Triangle smallest_corner_first(const Triangle& t, const std::vector<Vec3f>& positions) {
  const auto key = [&](std::uint32_t vertex) {
    const Vec3f& p = positions[vertex];
    return std::make_tuple(p.x, p.y, p.z);
  };
  if (key(t[1]) < key(t[0]) && key(t[1]) <= key(t[2])) return {t[1], t[2], t[0]};
  if (key(t[2]) < key(t[0]) && key(t[2]) < key(t[1])) return {t[2], t[0], t[1]};
  return t;
}

// The draw order of the triangles by their surfaces, and the ranges of equal surfaces in it.
struct SortedTriangles {
  std::vector<std::uint32_t> triangles;
  std::vector<DrawRange> ranges;
};

SortedTriangles sorted_triangles(const RenderScene& scene) {
  SortedTriangles result;
  std::vector<std::uint32_t>& order = result.triangles;
  order = scene.draw_order;
  if (order.empty()) {
    order.resize(scene.triangles.size());
    std::iota(order.begin(), order.end(), 0U);
  }
  const auto surface = [&](std::uint32_t triangle) -> const Surface& {
    return scene.surfaces[scene.objects[triangle]];
  };
  const auto opaque =
      std::stable_partition(order.begin(), order.end(), [&](std::uint32_t t) { return !surface(t).opaque; });
  std::stable_partition(order.begin(), opaque, [&](std::uint32_t t) { return surface(t).double_sided; });
  std::sort(opaque, order.end(), std::greater<>());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    const Surface& s = surface(order[i]);
    std::vector<DrawRange>& ranges = result.ranges;
    if (ranges.empty() || ranges.back().culled == s.double_sided || ranges.back().opaque != s.opaque)
      ranges.push_back({i, 0, !s.double_sided, s.opaque, false});
    ++ranges.back().triangles;
    ranges.back().cut_out = ranges.back().cut_out || s.cutoff > 0;
  }
  return result;
}

void grow(TriangleGroup& group, const Vec3f& p) {
  group.low = {std::min(group.low.x, p.x), std::min(group.low.y, p.y), std::min(group.low.z, p.z)};
  group.high = {std::max(group.high.x, p.x), std::max(group.high.y, p.y), std::max(group.high.z, p.z)};
}

constexpr float kFar = std::numeric_limits<float>::max();
constexpr TriangleGroup kNoTriangles{.range = {}, .low = {kFar, kFar, kFar}, .high = {-kFar, -kFar, -kFar}};

// Returns about 256 groups. Each belongs to one object, except where objects are tiny.
std::vector<TriangleGroup> groups_of(const RenderScene& scene, const SortedTriangles& order) {
  const std::size_t most = std::max<std::size_t>(32, order.triangles.size() / 256);
  const auto object = [&](std::uint32_t place) { return scene.objects[order.triangles[place]]; };
  TriangleGroup whole = kNoTriangles;
  std::vector<TriangleGroup> groups;
  for (const DrawRange& range : order.ranges) {
    for (std::uint32_t i = range.first_triangle; i < range.first_triangle + range.triangles; ++i) {
      const bool begins = i == range.first_triangle || groups.back().range.triangles >= most ||
                          (groups.back().range.triangles >= most / 4 && object(i) != object(i - 1));
      if (begins) {
        groups.push_back(kNoTriangles);
        groups.back().range = range;
        groups.back().range.first_triangle = i;
        groups.back().range.triangles = 0;
      }
      ++groups.back().range.triangles;
      for (const std::uint32_t vertex : scene.triangles[order.triangles[i]]) {
        grow(groups.back(), scene.positions[vertex]);
        grow(whole, scene.positions[vertex]);
      }
    }
  }
  const float margin = groups.empty() ? 0 : length(whole.high - whole.low) / 512;
  for (TriangleGroup& group : groups) {
    grow(group, group.low - Vec3f{margin, margin, margin});
    grow(group, group.high + Vec3f{margin, margin, margin});
  }
  return groups;
}

GpuSurface gpu_surface(const Surface& s) {
  constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  return {.color = {s.color.x, s.color.y, s.color.z, std::clamp(s.alpha, 0.0F, 1.0F)},
          .texture = s.texture.value_or(kNone),
          .cutoff = s.cutoff,
          .opaque = s.opaque ? 1U : 0U,
          .unlit = s.unlit ? 1U : 0U,
          .emissive = {s.emissive.x, s.emissive.y, s.emissive.z},
          .emissive_texture = s.emissive_texture.value_or(kNone)};
}

// Returns six numbers per vertex: texture coordinates and colour.
std::vector<float> attributes_of(const RenderScene& scene) {
  std::vector<float> numbers;
  numbers.reserve(6 * scene.positions.size());
  for (std::size_t v = 0; v < scene.positions.size(); ++v) {
    if (scene.texcoords.empty()) {
      numbers.insert(numbers.end(), 2, 0.0F);
    } else {
      numbers.insert(numbers.end(), scene.texcoords[v].begin(), scene.texcoords[v].end());
    }
    if (scene.colors.empty()) {
      numbers.insert(numbers.end(), 4, 1.0F);
    } else {
      numbers.insert(numbers.end(), scene.colors[v].begin(), scene.colors[v].end());
    }
  }
  return numbers;
}

// Packs the sampling as shaders/scene/texture.glsl reads it: two bits for each mode and one for each filter.
std::uint32_t packed(const TextureSampling& s) {
  const auto bits = [](auto choice, unsigned shift) { return static_cast<std::uint32_t>(choice) << shift; };
  return bits(s.wrap_u, 0) | bits(s.wrap_v, 2) | bits(s.levels, 4) | bits(s.magnify, 6) | bits(s.minify, 7);
}

// Returns a head of 20 words per texture (sides, levels, sampling, where each level begins), and then all
// texels.
std::vector<std::uint32_t> texture_words(const std::vector<TextureLevels>& textures) {
  constexpr std::size_t kHeadWords = 4 + kMostLevels;
  std::vector<std::uint32_t> words(kHeadWords * textures.size());
  for (std::size_t i = 0; i < textures.size(); ++i) {
    const TextureLevels& texture = textures[i];
    std::uint32_t* head = &words[kHeadWords * i];
    head[0] = texture.levels[0].width;
    head[1] = texture.levels[0].height;
    head[2] = static_cast<std::uint32_t>(texture.levels.size());
    head[3] = packed(texture.sampling);
    for (std::size_t level = 0; level < texture.levels.size(); ++level) {
      words[kHeadWords * i + 4 + level] = static_cast<std::uint32_t>(words.size());
      const std::vector<std::uint32_t>& texels = texture.levels[level].texels;
      words.insert(words.end(), texels.begin(), texels.end());
    }
  }
  return words;
}

}  // namespace

void GpuScene::draw_all() {
  ranges = all_ranges;
  groups = all_groups;
}

void GpuScene::draw_both_sides() {
  for (DrawRange& range : ranges) range.culled = false;
  for (TriangleGroup& group : groups) group.range.culled = false;
}

std::uint32_t GpuScene::features() const {
  const bool cuts = std::any_of(ranges.begin(), ranges.end(), [](const DrawRange& r) { return r.cut_out; });
  return (attributes ? static_cast<std::uint32_t>(colored) : 0U) | (cuts ? cut_out : 0U);
}

void GpuScene::draw_only(bool opaque) {
  ranges.clear();
  std::copy_if(all_ranges.begin(), all_ranges.end(), std::back_inserter(ranges),
               [&](const DrawRange& r) { return r.opaque == opaque; });
  groups.clear();
  std::copy_if(all_groups.begin(), all_groups.end(), std::back_inserter(groups),
               [&](const TriangleGroup& g) { return g.range.opaque == opaque; });
}

bool GpuScene::has_opaque() const {
  return !all_ranges.empty() && all_ranges.back().opaque;
}

GpuScene upload_scene(Context& context, const RenderScene& scene) {
  check_scene(scene);
  SortedTriangles order = sorted_triangles(scene);
  std::vector<Triangle> triangles;
  std::vector<std::array<std::uint32_t, 2>> infos;
  triangles.reserve(order.triangles.size());
  infos.reserve(order.triangles.size());
  for (const std::uint32_t t : order.triangles) {
    triangles.push_back(smallest_corner_first(scene.triangles[t], scene.positions));
    infos.push_back({scene.objects[t], t});
  }
  std::vector<GpuSurface> surfaces;
  for (const Surface& s : scene.surfaces) surfaces.push_back(gpu_surface(s));

  GpuScene gpu;
  gpu.positions = make_filled(context, "scene's positions", scene.positions);
  gpu.normals = make_filled(context, "scene's normals", scene.normals);
  gpu.indices = make_filled(context, "scene's triangles", triangles);
  gpu.triangles = make_filled(context, "scene's triangle numbers", infos);
  gpu.objects = make_filled(context, "scene's objects", scene.objects);
  gpu.surfaces = make_filled(context, "scene's surfaces", surfaces);
  if (!scene.texcoords.empty() || !scene.colors.empty())
    gpu.attributes = make_filled(context, "scene's vertex colours", attributes_of(scene));
  if (!scene.textures.empty())
    gpu.textures =
        make_filled(context, "scene's textures", texture_words(make_texture_levels(scene.textures)));
  gpu.object_count = static_cast<std::uint32_t>(scene.surfaces.size());
  gpu.all_groups = groups_of(scene, order);
  gpu.all_ranges = std::move(order.ranges);
  gpu.draw_all();
  return gpu;
}

}  // namespace pellucid::render
