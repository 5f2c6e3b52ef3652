// Implements render_helpers.h: scenes with coincident surfaces, and their fragments on the CPU.
#include "render_helpers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace pellucid::testing {
namespace {

std::uint32_t add_vertex(RenderScene& scene, const Vec3f& p) {
  scene.positions.push_back(p);
  scene.normals.push_back({0, 0, 0});
  return static_cast<std::uint32_t>(scene.positions.size() - 1);
}

void add_triangle(RenderScene& scene, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  scene.triangles.push_back({add_vertex(scene, a), add_vertex(scene, b), add_vertex(scene, c)});
  scene.objects.push_back(static_cast<std::uint32_t>(scene.surfaces.size() - 1));
}

void add_box(RenderScene& scene, const Vec3f& low, const Vec3f& high, std::uint32_t object) {
  const auto corner = [&](std::size_t c) {
    return Vec3f{(c & 1U) != 0 ? high.x : low.x, (c & 2U) != 0 ? high.y : low.y,
                 (c & 4U) != 0 ? high.z : low.z};
  };
  // Counter-clockwise, seen from outside.
  constexpr std::array<std::array<std::size_t, 4>, 6> kFaces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}}};
  for (const auto& face : kFaces) {
    add_triangle(scene, corner(face[0]), corner(face[1]), corner(face[2]));
    scene.objects.back() = object;
    add_triangle(scene, corner(face[0]), corner(face[2]), corner(face[3]));
    scene.objects.back() = object;
  }
}

// Multiples of 1/64: exact in fixed and in floating point.
float on_grid(Random& random) {
  return static_cast<float>(random.below(65)) / 64.0F;
}

}  // namespace

bool validation_is_on() {
  return std::filesystem::exists("/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json");
}

std::string first_validation_message() {
  const std::vector<std::string> messages = test_renderer().validation_messages();
  return messages.empty() ? "" : messages.front();
}

Renderer& test_renderer() {
  static Renderer renderer({.device = "", .validate = validation_is_on()});
  return renderer;
}

std::vector<std::string> techniques_that(const std::function<bool(const TechniqueInfo&)>& wanted) {
  std::vector<std::string> names;
  for (const TechniqueInfo& info : render_techniques()) {
    if (wanted(info)) names.push_back(info.name);
  }
  return names;
}

std::string technique_test_name(const ::testing::TestParamInfo<std::string>& parameter) {
  std::string name = parameter.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

RenderScene random_stack(std::uint64_t seed, std::size_t triangles) {
  Random random(seed);
  RenderScene scene;
  for (std::uint32_t object = 0; object < 4; ++object) {
    scene.surfaces.push_back(
        {.color = {0.2F * static_cast<float>(object), 0.5F, 0.9F - 0.2F * static_cast<float>(object)},
         .alpha = 0.2F + 0.15F * static_cast<float>(object)});
  }
  while (scene.triangles.size() < triangles) {
    const float depth = static_cast<float>(random.below(9)) / 8.0F;  // 0 and 1 included
    const Vec3f a{on_grid(random), on_grid(random), depth};
    const Vec3f b{on_grid(random), on_grid(random), depth};
    const Vec3f c{on_grid(random), on_grid(random), depth};
    const std::uint64_t copies = 1 + random.below(6);
    for (std::uint64_t i = 0; i < copies && scene.triangles.size() < triangles; ++i) {
      // Copies start at another corner, or face the other way.
      if (i % 3 == 0) add_triangle(scene, a, b, c);
      if (i % 3 == 1) add_triangle(scene, b, c, a);
      if (i % 3 == 2) add_triangle(scene, a, c, b);
      scene.objects.back() = static_cast<std::uint32_t>(random.below(4));
    }
  }
  return scene;
}

RenderScene coplanar_squares(std::uint32_t copies, float depth) {
  RenderScene scene;
  for (std::uint32_t i = 0; i < copies; ++i) {
    scene.surfaces.push_back({.color = {0.1F * static_cast<float>(i % 10), 0.4F, 0.6F}, .alpha = 0.3F});
    add_triangle(scene, {0, 0, depth}, {1, 1, depth}, {1, 0, depth});
    add_triangle(scene, {0, 0, depth}, {0, 1, depth}, {1, 1, depth});
  }
  return scene;
}

RenderScene closed_box(const Vec3f& low, const Vec3f& high) {
  RenderScene scene;
  scene.surfaces.push_back({.color = {0.3F, 0.6F, 0.2F}, .alpha = 0.4F});
  add_box(scene, low, high, 0);
  return scene;
}

RenderScene random_boxes(std::uint64_t seed, std::size_t boxes, std::uint32_t objects) {
  Random random(seed);
  RenderScene scene;
  for (std::uint32_t object = 0; object < objects; ++object) {
    const float hue = static_cast<float>(object) / static_cast<float>(objects);
    scene.surfaces.push_back({.color = {hue, 0.5F, 1 - hue}, .alpha = 0.2F + 0.3F * hue});
  }
  const auto interval = [&] {
    const std::uint64_t a = random.below(8);
    const std::uint64_t b = a + 1 + random.below(8 - a);
    return std::array<float, 2>{static_cast<float>(a) / 8, static_cast<float>(b) / 8};
  };
  for (std::size_t i = 0; i < boxes; ++i) {
    const auto x = interval();
    const auto y = interval();
    const auto z = interval();
    const auto object = static_cast<std::uint32_t>(random.below(objects));
    add_box(scene, {x[0], y[0], z[0]}, {x[1], y[1], z[1]}, object);
  }
  return scene;
}

RenderScene joined(const RenderScene& a, const RenderScene& b) {
  RenderScene scene = a;
  const auto vertices = static_cast<std::uint32_t>(a.positions.size());
  const auto objects = static_cast<std::uint32_t>(a.surfaces.size());
  scene.positions.insert(scene.positions.end(), b.positions.begin(), b.positions.end());
  scene.normals.insert(scene.normals.end(), b.normals.begin(), b.normals.end());
  scene.surfaces.insert(scene.surfaces.end(), b.surfaces.begin(), b.surfaces.end());
  for (const Triangle& t : b.triangles)
    scene.triangles.push_back({t[0] + vertices, t[1] + vertices, t[2] + vertices});
  for (const std::uint32_t object : b.objects) scene.objects.push_back(object + objects);
  return scene;
}

RenderScene scene_of(const Mesh& mesh) {
  RenderScene scene;
  scene.positions = mesh.positions;
  scene.normals = mesh.normals.empty() ? vertex_normals(mesh) : mesh.normals;
  scene.triangles = mesh.triangles;
  scene.objects.assign(mesh.triangles.size(), 0);
  scene.surfaces.push_back({.color = {0.09F, 0.34F, 0.68F}, .alpha = 0.5F});
  return scene;
}

Camera unit_camera(std::uint32_t width, std::uint32_t height) {
  Camera camera;
  camera.eye = {0.5, 0.5, 0};
  camera.right = {1, 0, 0};
  camera.up = {0, -1, 0};
  camera.forward = {0, 0, 1};
  camera.perspective = false;
  camera.half_height = 0.5;
  camera.near_plane = 0;
  camera.far_plane = 1;
  camera.width = width;
  camera.height = height;
  return camera;
}

FragmentBuffer cpu_fragments(const RenderScene& scene, const Camera& camera) {
  Mesh mesh;
  mesh.positions = scene.positions;
  mesh.triangles = scene.triangles;
  FragmentBuffer fragments;
  rasterize(mesh, camera, {}, fragments);
  return fragments;
}

float difference(const Vec3f& a, const Vec3f& b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

float largest_difference(const RenderResult& a, const RenderResult& b) {
  float largest = 0;
  for (std::size_t p = 0; p < a.pixels.size(); ++p)
    largest = std::max(largest, difference(a.pixels[p], b.pixels[p]));
  return largest;
}

bool same_fragments(std::span<const Fragment> a, std::span<const Fragment> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Fragment& f, const Fragment& g) {
    return f.depth == g.depth && f.node == g.node;
  });
}

std::vector<Fragment> pixel_of(const CapturedFragments& captured, std::size_t pixel) {
  std::vector<Fragment> list(
      captured.fragments.begin() + static_cast<std::ptrdiff_t>(captured.offsets[pixel]),
      captured.fragments.begin() + static_cast<std::ptrdiff_t>(captured.offsets[pixel + 1]));
  return list;
}

}  // namespace pellucid::testing
