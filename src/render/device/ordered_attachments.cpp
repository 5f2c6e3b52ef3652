// Implements ordered_attachments.h: render passes, framebuffers and descriptor sets.
#include "render/device/ordered_attachments.h"

namespace pellucid::render {
namespace {

OwnedRenderPass make_render_pass(Context& context, std::uint32_t attachments) {
  const std::vector<VkAttachmentDescription> descriptions(attachments,
                                                          {.format = kOrderedFormat,
                                                           .samples = VK_SAMPLE_COUNT_1_BIT,
                                                           .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                                           .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                                           .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                                           .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                                           .initialLayout = VK_IMAGE_LAYOUT_GENERAL,
                                                           .finalLayout = VK_IMAGE_LAYOUT_GENERAL});
  std::vector<VkAttachmentReference> references;
  for (std::uint32_t i = 0; i < attachments; ++i) references.push_back({i, VK_IMAGE_LAYOUT_GENERAL});
  const VkSubpassDescription subpass{
      .flags = VK_SUBPASS_DESCRIPTION_RASTERIZATION_ORDER_ATTACHMENT_COLOR_ACCESS_BIT_EXT,
      .pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
      .inputAttachmentCount = attachments,
      .pInputAttachments = references.data(),
      .colorAttachmentCount = attachments,
      .pColorAttachments = references.data()};
  // Fragments read what earlier fragments of the same pixel wrote in the same subpass.
  const VkSubpassDependency itself{.srcSubpass = 0,
                                   .dstSubpass = 0,
                                   .srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                                   .dstStageMask = VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT,
                                   .srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                                   .dstAccessMask = VK_ACCESS_INPUT_ATTACHMENT_READ_BIT,
                                   .dependencyFlags = VK_DEPENDENCY_BY_REGION_BIT};
  const VkRenderPassCreateInfo info{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                    .attachmentCount = attachments,
                                    .pAttachments = descriptions.data(),
                                    .subpassCount = 1,
                                    .pSubpasses = &subpass,
                                    .dependencyCount = 1,
                                    .pDependencies = &itself};
  VkRenderPass pass = VK_NULL_HANDLE;
  context.call("creating a render pass",
               [&] { return vkCreateRenderPass(context.device(), &info, nullptr, &pass); });
  return {context.device(), pass};
}

OwnedDescriptorSetLayout make_set_layout(Context& context, std::uint32_t attachments) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (std::uint32_t i = 0; i < attachments; ++i) {
    bindings.push_back({.binding = i,
                        .descriptorType = VK_DESCRIPTOR_TYPE_INPUT_ATTACHMENT,
                        .descriptorCount = 1,
                        .stageFlags = VK_SHADER_STAGE_FRAGMENT_BIT,
                        .pImmutableSamplers = nullptr});
  }
  const VkDescriptorSetLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                             .bindingCount = attachments,
                                             .pBindings = bindings.data()};
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  context.call("creating a descriptor layout",
               [&] { return vkCreateDescriptorSetLayout(context.device(), &info, nullptr, &layout); });
  return {context.device(), layout};
}

OwnedImageView make_view(Context& context, const Image& image, std::uint32_t layer) {
  const VkImageViewCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                   .image = image.get(),
                                   .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                   .format = kOrderedFormat,
                                   .subresourceRange = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT,
                                                        .levelCount = 1,
                                                        .baseArrayLayer = layer,
                                                        .layerCount = 1}};
  VkImageView view = VK_NULL_HANDLE;
  context.call("creating an image view",
               [&] { return vkCreateImageView(context.device(), &info, nullptr, &view); });
  return {context.device(), view};
}

OwnedDescriptorPool make_pool(Context& context, std::uint32_t attachments) {
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_INPUT_ATTACHMENT, attachments};
  const VkDescriptorPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                        .maxSets = 1,
                                        .poolSizeCount = 1,
                                        .pPoolSizes = &size};
  VkDescriptorPool pool = VK_NULL_HANDLE;
  context.call("creating a descriptor pool",
               [&] { return vkCreateDescriptorPool(context.device(), &info, nullptr, &pool); });
  return {context.device(), pool};
}

}  // namespace

OrderedLayout::OrderedLayout(Context& context, std::uint32_t attachments)
    : attachments_(attachments),
      render_pass_(make_render_pass(context, attachments)),
      set_layout_(make_set_layout(context, attachments)),
      pipeline_layout_(context.make_pipeline_layout(set_layout_.get())) {}

OrderedTarget::OrderedTarget(Context& context, const OrderedLayout& layout, const Image& layers)
    : layout_(&layout) {
  const std::uint32_t count = layout.attachments();
  std::vector<VkImageView> views;
  for (std::uint32_t i = 0; i < count; ++i) {
    views_.push_back(make_view(context, layers, i));
    views.push_back(views_.back().get());
  }
  const VkFramebufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                     .renderPass = layout.render_pass(),
                                     .attachmentCount = count,
                                     .pAttachments = views.data(),
                                     .width = layers.spec().width,
                                     .height = layers.spec().height,
                                     .layers = 1};
  VkFramebuffer framebuffer = VK_NULL_HANDLE;
  context.call("creating a framebuffer",
               [&] { return vkCreateFramebuffer(context.device(), &info, nullptr, &framebuffer); });
  framebuffer_ = {context.device(), framebuffer};

  pool_ = make_pool(context, count);
  const VkDescriptorSetLayout set_layout = layout.set_layout();
  const VkDescriptorSetAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                             .descriptorPool = pool_.get(),
                                             .descriptorSetCount = 1,
                                             .pSetLayouts = &set_layout};
  context.call("allocating descriptors",
               [&] { return vkAllocateDescriptorSets(context.device(), &allocate, &set_); });
  std::vector<VkDescriptorImageInfo> images;
  std::vector<VkWriteDescriptorSet> writes;
  images.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    images.push_back({.imageView = views[i], .imageLayout = VK_IMAGE_LAYOUT_GENERAL});
    writes.push_back({.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                      .dstSet = set_,
                      .dstBinding = i,
                      .descriptorCount = 1,
                      .descriptorType = VK_DESCRIPTOR_TYPE_INPUT_ATTACHMENT,
                      .pImageInfo = &images.back()});
  }
  vkUpdateDescriptorSets(context.device(), count, writes.data(), 0, nullptr);
}

}  // namespace pellucid::render
