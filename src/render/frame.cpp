// A picture while it is drawn: see frame.h.
#include "render/frame.h"

#include <fmt/format.h>

namespace pellucid::render {
namespace {

void append(std::string& key, const Constants& constants) {
  for (const std::uint32_t c : constants) key.append(" ").append(std::to_string(c));
}

}  // namespace

// Constants 0 to 3 are those of effect and technique; what they do not give is not read.
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
          .picture_height = picture_height};
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

std::uint32_t loop_budget(const DeviceInfo& device) {
  // Measured on lavapipe 22.3.6: after 65,535 turns all loops of an invocation end, silently.
  return device.cpu ? 60'000U : 0xFFFFFFFFU;
}

}  // namespace pellucid::render
