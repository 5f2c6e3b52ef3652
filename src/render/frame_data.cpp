// What shaders know of a frame: see frame_data.h.
#include "render/frame_data.h"

#include <algorithm>

namespace pellucid::render {
namespace {

std::array<float, 4> four(const Vec3d& v, double w) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), static_cast<float>(w)};
}

// Column-major; y points down, depth runs from 0 at the near to 1 at the far plane (raster.h).
std::array<float, 16> clip_from_world(const Camera& camera) {
  const double half_width = camera.half_height * camera.width / camera.height;
  const double n = camera.near_plane;
  const double f = camera.far_plane;
  struct Row {
    Vec3d direction;
    double offset;
  };
  const auto row = [&](const Vec3d& axis, double scale, double shift) {
    return Row{axis * scale, shift - scale * dot(axis, camera.eye)};
  };
  const Row x = row(camera.right, 1 / half_width, 0);
  const Row y = row(camera.up, -1 / camera.half_height, 0);
  const Row z = camera.perspective ? row(camera.forward, f / (f - n), -f * n / (f - n))
                                   : row(camera.forward, 1 / (f - n), -n / (f - n));
  const Row w = camera.perspective ? row(camera.forward, 1, 0) : Row{{0, 0, 0}, 1};
  std::array<float, 16> m{};
  const std::array<Row, 4> rows{x, y, z, w};
  for (std::size_t i = 0; i < 4; ++i) {
    m.at(i) = static_cast<float>(rows.at(i).direction.x);
    m.at(4 + i) = static_cast<float>(rows.at(i).direction.y);
    m.at(8 + i) = static_cast<float>(rows.at(i).direction.z);
    m.at(12 + i) = static_cast<float>(rows.at(i).offset);
  }
  return m;
}

}  // namespace

FrameData frame_data(const Camera& camera, const Frame& frame) {
  FrameData data;
  data.clip_from_world = clip_from_world(camera);
  data.eye = four(camera.eye, camera.perspective ? 1 : 0);
  data.to_viewer = four(-camera.forward, 0);
  // The same light as in pellucid/shading.h.
  data.fill_light = four(normalized(camera.up * 0.8 - camera.right * 0.55 - camera.forward * 0.35), 0);
  data.background = four(to_double(frame.options.background), 1);
  data.planes = {static_cast<float>(camera.near_plane), static_cast<float>(camera.far_plane),
                 static_cast<float>(1 / camera.near_plane), static_cast<float>(1 / camera.far_plane)};
  data.size = {frame.width, frame.height};
  data.objects = frame.scene.object_count;
  data.capacity = static_cast<std::uint32_t>(std::min<std::uint64_t>(frame.capacity(), 0xFFFFFFFEU));
  data.line = four(to_double(frame.options.edge_color), camera.height);
  data.first_row = frame.first_row;
  data.csg = static_cast<std::uint32_t>(frame.options.csg);
  data.samples = frame.options.samples;
  return data;
}

}  // namespace pellucid::render
