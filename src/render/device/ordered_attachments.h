// ordered_attachments.h - colour attachments that fragment shaders can read back. The fragments of a pixel
// run one after the other in draw order (VK_EXT_rasterization_order_attachment_access). This needs an
// old-style render pass and input attachments.
#pragma once

#include <cstdint>
#include <vector>

#include "render/device/memory.h"

namespace pellucid::render {

constexpr VkFormat kOrderedFormat = VK_FORMAT_R32G32B32A32_UINT;

// Returns the number of 128-bit attachments that hold k fragments of three words.
constexpr std::uint32_t ordered_attachments_for(std::uint32_t k) {
  return (3 * k + 3) / 4;
}

// Objects that all passes with the same number of attachments share. Set 0 is the same as in all other
// passes.
class OrderedLayout {
 public:
  OrderedLayout(Context& context, std::uint32_t attachments);
  [[nodiscard]] std::uint32_t attachments() const { return attachments_; }
  [[nodiscard]] VkRenderPass render_pass() const { return render_pass_.get(); }
  [[nodiscard]] VkDescriptorSetLayout set_layout() const { return set_layout_.get(); }
  [[nodiscard]] VkPipelineLayout pipeline_layout() const { return pipeline_layout_.get(); }

 private:
  std::uint32_t attachments_;
  OwnedRenderPass render_pass_;
  OwnedDescriptorSetLayout set_layout_;
  OwnedPipelineLayout pipeline_layout_;
};

// Attachments that are the layers of one image.
class OrderedTarget {
 public:
  OrderedTarget() = default;
  // `layers` must have at least two layers and must outlive this object.
  OrderedTarget(Context& context, const OrderedLayout& layout, const Image& layers);
  [[nodiscard]] VkFramebuffer framebuffer() const { return framebuffer_.get(); }
  [[nodiscard]] VkDescriptorSet set() const { return set_; }
  [[nodiscard]] const OrderedLayout& layout() const { return *layout_; }

 private:
  const OrderedLayout* layout_ = nullptr;
  std::vector<OwnedImageView> views_;
  OwnedFramebuffer framebuffer_;
  OwnedDescriptorPool pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;  // belongs to the pool
};

}  // namespace pellucid::render
