// A scene on the device: see gpu_scene.h.
#include "gpu_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

namespace pellucid::render {
namespace {

// Ids are 2 * (triangle + 1) + side in 32 bits.
constexpr std::uint64_t kMostTriangles = (1ULL << 31U) - 2;

[[noreturn]] void complain(const std::string& what) {
  throw Error(ErrorKind::bad_argument, "render: " + what);
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
  if (scene.sequence.empty()) return;
  std::vector<bool> seen(scene.triangles.size());
  for (const std::uint32_t triangle : scene.sequence) {
    if (triangle >= seen.size() || seen[triangle]) complain("the drawing sequence is not a permutation");
    seen[triangle] = true;
  }
  if (scene.sequence.size() != scene.triangles.size()) complain("the drawing sequence is not a permutation");
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

template <class T>
Buffer make_buffer(Context& context, const std::string& name, const std::vector<T>& values) {
  Buffer buffer(context, name, values.size() * sizeof(T));
  upload<T>(context, buffer, values);
  return buffer;
}

}  // namespace

GpuScene upload_scene(Context& context, const RenderScene& scene) {
  check_scene(scene);
  std::vector<std::uint32_t> sequence = scene.sequence;
  if (sequence.empty()) {
    sequence.resize(scene.triangles.size());
    std::iota(sequence.begin(), sequence.end(), 0U);
  }
  const auto culled = [&](std::uint32_t triangle) {
    return !scene.surfaces[scene.objects[triangle]].double_sided;
  };
  const auto middle =
      std::stable_partition(sequence.begin(), sequence.end(), [&](std::uint32_t t) { return !culled(t); });

  std::vector<Triangle> triangles;
  std::vector<std::array<std::uint32_t, 2>> infos;
  triangles.reserve(sequence.size());
  infos.reserve(sequence.size());
  for (const std::uint32_t t : sequence) {
    triangles.push_back(smallest_corner_first(scene.triangles[t], scene.positions));
    infos.push_back({scene.objects[t], t});
  }
  std::vector<std::array<float, 4>> surfaces;
  for (const Surface& s : scene.surfaces) {
    surfaces.push_back({s.color.x, s.color.y, s.color.z, std::clamp(s.alpha, 0.0F, 1.0F)});
  }

  GpuScene gpu;
  gpu.positions = make_buffer(context, "scene's positions", scene.positions);
  gpu.normals = make_buffer(context, "scene's normals", scene.normals);
  gpu.indices = make_buffer(context, "scene's triangles", triangles);
  gpu.triangles = make_buffer(context, "scene's triangle numbers", infos);
  gpu.objects = make_buffer(context, "scene's objects", scene.objects);
  gpu.surfaces = make_buffer(context, "scene's surfaces", surfaces);
  gpu.object_count = static_cast<std::uint32_t>(scene.surfaces.size());
  const auto both_sides = static_cast<std::uint32_t>(middle - sequence.begin());
  const auto all = static_cast<std::uint32_t>(sequence.size());
  if (both_sides > 0) gpu.ranges.push_back({0, both_sides, false});
  if (both_sides < all) gpu.ranges.push_back({both_sides, all - both_sides, true});
  return gpu;
}

}  // namespace pellucid::render
