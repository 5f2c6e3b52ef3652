// Implements opaque_layer.h: the pass over opaque surfaces.
#include "render/scene/opaque_layer.h"

namespace pellucid::render {
namespace {

constexpr VkFormat kNearest = VK_FORMAT_R32G32_UINT;
constexpr VkFormat kDepth = VK_FORMAT_D32_SFLOAT;

}  // namespace

OpaqueLayer::OpaqueLayer(const Frame& frame) {
  const bool used = needed(frame);
  const std::uint32_t width = used ? frame.width : 1;
  const std::uint32_t height = used ? frame.height : 1;
  nearest_ = Image(frame.context, "opaque surfaces", {.format = kNearest, .width = width, .height = height});
  if (used) {
    depth_ = Image(frame.context, "depth of opaque surfaces",
                   {.format = kDepth, .width = width, .height = height});
  }
}

void OpaqueLayer::draw(const Frame& frame, Recorder& recorder) const {
  recorder.prepare(depth_);
  Attachments attachments = frame.attachments();
  attachments.colors = {&nearest_};
  attachments.depth = &depth_;
  // Triangles are drawn in falling order of their ids, so the smallest id remains where depths are equal.
  recorder.draw(frame.scene,
                frame.pipelines.scene({.fragment_shader = "scene/opaque.frag",
                                       .constants = {frame.effect},
                                       .colors = {kNearest},
                                       .depth = kDepth,
                                       .depth_test = DepthTest::less_or_equal,
                                       .depth_write = true}),
                attachments);
}

}  // namespace pellucid::render
