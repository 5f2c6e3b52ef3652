// Implements frame.h: pipelines, memory and passes of a frame, and the data that shaders get.
#include "render/frame.h"

#include <fmt/format.h>

#include <algorithm>

namespace pellucid::render {
namespace {

void append(std::string& key, const Constants& constants) {
  for (const std::uint32_t c : constants) key.append(" ").append(std::to_string(c));
}

std::array<float, 4> four(const Vec3d& v, double w) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), static_cast<float>(w)};
}

// Returns the projection, column-major. y points down. Depth runs from 0 at the near plane to 1 at the far
// plane (raster.h).
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

// Appends the features as constant 4. Constants 0 to 3 belong to the effect and the technique; missing ones
// are filled up and not read.
Constants Pipelines::with_features(Constants constants) const {
  constants.resize(4);
  constants.push_back(features_);
  return constants;
}

const OrderedLayout& Pipelines::ordered(std::uint32_t attachments) {
  const auto found = ordered_.find(attachments);
  if (found != ordered_.end()) return found->second;
  return ordered_.try_emplace(attachments, context_, attachments).first->second;
}

const ScenePipeline& Pipelines::scene(const GraphicsSpec& given) {
  GraphicsSpec spec = given;
  spec.constants = with_features(given.constants);
  std::string key = fmt::format("{} {} {} {} {} {} {} {}", spec.vertex_shader, spec.fragment_shader,
                                static_cast<int>(spec.blend), static_cast<int>(spec.depth),
                                static_cast<int>(spec.depth_test), spec.depth_write,
                                static_cast<int>(spec.stencil), spec.clamp_depth);
  for (const VkFormat format : spec.colors) key.append(" c").append(std::to_string(static_cast<int>(format)));
  append(key, spec.constants);
  const auto found = scene_.find(key);
  if (found != scene_.end()) return found->second;
  return scene_.emplace(key, make_scene_pipeline(context_, spec)).first->second;
}

const OwnedPipeline& Pipelines::compute(std::string_view shader, const Constants& given) {
  const Constants constants = with_features(given);
  std::string key(shader);
  append(key, constants);
  const auto found = compute_.find(key);
  if (found != compute_.end()) return found->second;
  return compute_.emplace(key, make_compute_pipeline(context_, shader, constants)).first->second;
}

Buffer Frame::make_buffer(const std::string& name, std::uint64_t bytes) {
  Buffer buffer(context, name, bytes);
  technique_bytes += buffer.bytes();
  return buffer;
}

Image Frame::make_image(const std::string& name, VkFormat format, std::uint32_t layers, ImageUse use) {
  Image image(context, name, image_spec(format, layers, use));
  technique_bytes += image.bytes();
  return image;
}

Attachments Frame::attachments() const {
  return {.width = width,
          .height = height,
          .samples = options.samples,
          .first_row = static_cast<std::int32_t>(first_row),
          .image_height = image_height};
}

void Frame::gather(Recorder& recorder, std::string_view fragment_shader, const Constants& constants) const {
  recorder.draw(scene, pipelines.scene({.fragment_shader = fragment_shader, .constants = constants}),
                attachments());
}

void Frame::gather_in_order(Recorder& recorder, std::string_view fragment_shader, const Constants& constants,
                            const Image& layers, const OrderedTarget& target) const {
  const OrderedLayout& layout = target.layout();
  recorder.prepare(layers);
  recorder.bind(Slot::image_0, layers);
  recorder.draw_ordered(
      scene,
      pipelines.scene({.fragment_shader = fragment_shader,
                       .constants = constants,
                       .colors = std::vector<VkFormat>(layout.attachments(), kOrderedFormat),
                       .ordered = &layout}),
      target, attachments());
}

FrameData frame_data(const Camera& camera, const Frame& frame) {
  FrameData data;
  data.clip_from_world = clip_from_world(camera);
  data.eye = four(camera.eye, camera.perspective ? 1 : 0);
  data.to_viewer = four(-camera.forward, 0);
  // Uses the light of pellucid/shading.h.
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

std::uint32_t loop_budget(const DeviceInfo& device) {
  // On lavapipe 22.3.6 all loops of an invocation end silently after 65,535 turns (measured).
  return device.cpu ? 60'000U : 0xFFFFFFFFU;
}

}  // namespace pellucid::render
