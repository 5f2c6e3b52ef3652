// Cameras: see file_camera.h.
#include "file_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "pellucid/asset.h"

namespace pellucid::cli {
namespace {

ModelCamera find_camera(const Model& model, const std::string& name) {
  const std::vector<ModelCamera> cameras = read_cameras(model);
  std::string names;
  for (const ModelCamera& camera : cameras) {
    if (camera.name == name) return camera;
    names.append(names.empty() ? "" : ", ").append(camera.name.empty() ? "(unnamed)" : camera.name);
  }
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error == std::errc{} && end == name.data() + name.size() && number < cameras.size())
    return cameras[number];
  throw Error(ErrorKind::bad_argument, fmt::format("--camera: {} has no camera '{}'; there is {}", model.path,
                                                   name, names.empty() ? "none" : names));
}

// Near and far planes around the sphere, as far as it lies in front.
void fit_planes(const BoundingSphere& sphere, Camera& camera) {
  constexpr double kSlack = 1.001;
  constexpr double kNearest = 1e-4;  // of the far plane
  const double depth = dot(sphere.center - camera.eye, camera.forward);
  const double radius = std::max(sphere.radius, 1e-12) * kSlack;
  if (!camera.perspective) {
    camera.eye += camera.forward * (depth - radius);
    camera.near_plane = 0;
    camera.far_plane = 2 * radius;
    return;
  }
  camera.far_plane = std::max(depth + radius, radius);
  camera.near_plane = std::max(depth - radius, kNearest * camera.far_plane);
}

Camera placed(const ModelCamera& source, const BoundingSphere& sphere, std::uint32_t width,
              std::uint32_t height) {
  const auto& m = source.world.m;
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.perspective = source.perspective;
  camera.half_height = source.half_height;
  camera.eye = {m[12], m[13], m[14]};
  camera.forward = normalized(Vec3d{-m[8], -m[9], -m[10]});
  camera.right = normalized(cross(camera.forward, Vec3d{m[4], m[5], m[6]}));
  camera.up = cross(camera.right, camera.forward);
  const double volume = dot(camera.right, cross(camera.up, -camera.forward));
  if (!(volume > 0.5)) {
    throw Error(ErrorKind::bad_input,
                fmt::format("camera '{}': its node's matrix gives it no direction", source.name));
  }
  fit_planes(sphere, camera);
  return camera;
}

}  // namespace

Camera camera_from(const std::string& text, const Model& model, const Scene& scene, std::uint32_t width,
                   std::uint32_t height) {
  if (!is_file_camera(text)) return look_at_sphere(scene.sphere, parse_camera(text), width, height);
  const ModelCamera camera = find_camera(model, text.substr(kFileCamera.size()));
  return placed(camera, scene.sphere, width, height);
}

}  // namespace pellucid::cli
