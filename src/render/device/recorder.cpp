// Implements recorder.h: passes over the scene, kernels, descriptors, barriers and timestamps.
#include "render/device/recorder.h"

#include <algorithm>
#include <iterator>

#include "render/scene/gpu_scene.h"

namespace pellucid::render {
namespace {

// The standard positions of four samples in a pixel (Vulkan), as in shaders/scene/samples.glsl. Samples are
// drawn as images of their own, because integer attachments and stencils need samples as well, and lavapipe
// does not support such multisampled images.
constexpr std::array<std::array<float, 2>, 4> kSamplePlaces{
    {{0.375F, 0.125F}, {0.875F, 0.375F}, {0.125F, 0.625F}, {0.625F, 0.875F}}};

}  // namespace

Recorder::Recorder(Context& context, VkCommandBuffer commands, const Buffer& unused, VkQueryPool timestamps)
    : context_(context), commands_(commands), timestamps_(timestamps) {
  for (VkDescriptorBufferInfo& buffer : buffers_)
    buffer = {.buffer = unused.get(), .offset = 0, .range = VK_WHOLE_SIZE};
}

void Recorder::bind(Slot slot, const Buffer& buffer) {
  buffers_.at(static_cast<std::uint32_t>(slot)) = {
      .buffer = buffer.get(), .offset = 0, .range = VK_WHOLE_SIZE};
}

void Recorder::bind(Slot slot, const Image& image) {
  images_.at(static_cast<std::uint32_t>(slot) - kFirstImageSlot) = {
      .sampler = VK_NULL_HANDLE, .imageView = image.sampled_view(), .imageLayout = VK_IMAGE_LAYOUT_GENERAL};
}

void Recorder::bind_stencil(Slot slot, const Image& image) {
  images_.at(static_cast<std::uint32_t>(slot) - kFirstImageSlot) = {
      .sampler = VK_NULL_HANDLE, .imageView = image.stencil_view(), .imageLayout = VK_IMAGE_LAYOUT_GENERAL};
}

void Recorder::prepare(const Image& image) {
  VkImageAspectFlags aspect = image.spec().depth() ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  if (image.spec().format == VK_FORMAT_D32_SFLOAT_S8_UINT) aspect |= VK_IMAGE_ASPECT_STENCIL_BIT;
  const VkImageMemoryBarrier2 transition{
      .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
      .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
      .srcAccessMask = VK_ACCESS_2_NONE,
      .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
      .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT,
      .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
      .newLayout = VK_IMAGE_LAYOUT_GENERAL,
      .image = image.get(),
      .subresourceRange = {.aspectMask = aspect, .levelCount = 1, .layerCount = image.spec().layers}};
  const VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                    .imageMemoryBarrierCount = 1,
                                    .pImageMemoryBarriers = &transition};
  vkCmdPipelineBarrier2(commands_, &dependency);
}

void Recorder::barrier() {
  const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                 .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                 .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                                 .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                 .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
  const VkDependencyInfo dependency{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
  vkCmdPipelineBarrier2(commands_, &dependency);
}

void Recorder::barrier_to_host() {
  const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                 .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                 .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                                 .dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT,
                                 .dstAccessMask = VK_ACCESS_2_HOST_READ_BIT};
  const VkDependencyInfo dependency{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
  vkCmdPipelineBarrier2(commands_, &dependency);
}

void Recorder::fill(const Buffer& buffer, std::uint32_t word) {
  fill(buffer, word, 0, VK_WHOLE_SIZE);
}

void Recorder::fill(const Buffer& buffer, std::uint32_t word, std::uint64_t offset, std::uint64_t bytes) {
  vkCmdFillBuffer(commands_, buffer.get(), offset, bytes, word);
}

void Recorder::push_state(VkPipelineBindPoint point) {
  std::array<VkWriteDescriptorSet, kSlots> writes{};
  std::uint32_t count = 0;
  const auto add = [&](std::uint32_t slot) -> VkWriteDescriptorSet& {
    VkWriteDescriptorSet& write = writes.at(count++);
    write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, .dstBinding = slot, .descriptorCount = 1};
    return write;
  };
  for (std::uint32_t slot = 0; slot < kFirstImageSlot; ++slot) {
    VkWriteDescriptorSet& write = add(slot);
    write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    write.pBufferInfo = &buffers_.at(slot);
  }
  for (std::uint32_t slot = kFirstImageSlot; slot < kSlots; ++slot) {
    if (images_.at(slot - kFirstImageSlot).imageView == VK_NULL_HANDLE) continue;
    VkWriteDescriptorSet& write = add(slot);
    write.descriptorType = VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
    write.pImageInfo = &images_.at(slot - kFirstImageSlot);
  }
  context_.push_descriptors()(commands_, point, context_.pipeline_layout(), 0, count, writes.data());
}

void Recorder::number_stencils(const VkRect2D& area, std::uint32_t layers) {
  for (std::uint32_t layer = 0; layer < layers; ++layer) {
    VkClearAttachment clear{.aspectMask = VK_IMAGE_ASPECT_STENCIL_BIT};
    clear.clearValue.depthStencil.stencil = layer + 2;
    const VkClearRect rectangle{.rect = area, .baseArrayLayer = layer, .layerCount = 1};
    vkCmdClearAttachments(commands_, 1, &clear, 1, &rectangle);
  }
}

void Recorder::draw(const GpuScene& scene, const ScenePipeline& pipeline, const Attachments& attachments,
                    const SomeTriangles* some) {
  ++geometry_passes_;
  const VkAttachmentLoadOp load =
      attachments.clear ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD;
  std::vector<VkRenderingAttachmentInfo> colors;
  for (const Image* image : attachments.colors) {
    colors.push_back({.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                      .imageView = image->view(),
                      .imageLayout = VK_IMAGE_LAYOUT_GENERAL,
                      .loadOp = load,
                      .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                      .clearValue = {.color = attachments.clear_color}});
  }
  VkRenderingAttachmentInfo depth{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  if (attachments.depth != nullptr) {
    depth.imageView = attachments.depth->view();
    depth.imageLayout = VK_IMAGE_LAYOUT_GENERAL;
    depth.loadOp = attachments.load_depth ? VK_ATTACHMENT_LOAD_OP_LOAD : load;
    depth.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    depth.clearValue.depthStencil = {.depth = attachments.clear_depth, .stencil = 0};
  }
  const VkRect2D area{.offset = {0, 0}, .extent = {attachments.width, attachments.height}};
  const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                  .renderArea = area,
                                  .layerCount = attachments.layers,
                                  .colorAttachmentCount = static_cast<std::uint32_t>(colors.size()),
                                  .pColorAttachments = colors.data(),
                                  .pDepthAttachment = attachments.depth != nullptr ? &depth : nullptr,
                                  .pStencilAttachment = attachments.stencil ? &depth : nullptr};
  vkCmdBeginRendering(commands_, &rendering);
  if (attachments.number_stencils) number_stencils(area, attachments.layers);
  push_state(VK_PIPELINE_BIND_POINT_GRAPHICS);
  for_each_sample(attachments, [&] { draw_triangles(scene, pipeline, attachments.layers, some); });
  vkCmdEndRendering(commands_);
}

void Recorder::draw_ordered(const GpuScene& scene, const ScenePipeline& pipeline, const OrderedTarget& target,
                            const Attachments& window) {
  ++geometry_passes_;
  const OrderedLayout& layout = target.layout();
  VkClearValue nothing{};
  std::fill(std::begin(nothing.color.uint32), std::end(nothing.color.uint32), 0xFFFFFFFFU);
  const std::vector<VkClearValue> clears(layout.attachments(), nothing);
  const VkRenderPassBeginInfo begin{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                    .renderPass = layout.render_pass(),
                                    .framebuffer = target.framebuffer(),
                                    .renderArea = {.offset = {0, 0}, .extent = {window.width, window.height}},
                                    .clearValueCount = layout.attachments(),
                                    .pClearValues = clears.data()};
  vkCmdBeginRenderPass(commands_, &begin, VK_SUBPASS_CONTENTS_INLINE);
  push_state(VK_PIPELINE_BIND_POINT_GRAPHICS);
  const VkDescriptorSet set = target.set();
  vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_GRAPHICS, layout.pipeline_layout(), 1, 1, &set, 0,
                          nullptr);
  for_each_sample(window, [&] { draw_triangles(scene, pipeline, 1, nullptr); });
  vkCmdEndRenderPass(commands_);
}

void Recorder::draw_triangles(const GpuScene& scene, const ScenePipeline& pipeline, std::uint32_t layers,
                              const SomeTriangles* some) {
  const std::array<VkBuffer, 2> vertices{scene.positions.get(), scene.normals.get()};
  const std::array<VkDeviceSize, 2> offsets{};
  vkCmdBindVertexBuffers(commands_, 0, 2, vertices.data(), offsets.data());
  if (some != nullptr) {
    vkCmdBindIndexBuffer(commands_, some->indices.get(), 0, VK_INDEX_TYPE_UINT32);
    for (std::size_t i = 0; i < scene.ranges.size(); ++i) {
      bind_range(scene.ranges[i], pipeline);
      vkCmdDrawIndexedIndirect(commands_, some->arguments.get(), i * sizeof(VkDrawIndexedIndirectCommand), 1,
                               sizeof(VkDrawIndexedIndirectCommand));
    }
    return;
  }
  vkCmdBindIndexBuffer(commands_, scene.indices.get(), 0, VK_INDEX_TYPE_UINT32);
  if (predicates_ == nullptr) {
    for (const DrawRange& range : scene.ranges) draw_range(range, pipeline, layers);
    return;
  }
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    begin_if(*predicates_, i);
    draw_range(groups_[i], pipeline, layers);
    end_if();
  }
}

void Recorder::set_window(const Attachments& attachments, std::uint32_t sample) {
  const std::uint32_t rows = attachments.height / attachments.samples;
  const std::array<float, 2> place =
      attachments.samples == 1 ? std::array{0.5F, 0.5F} : kSamplePlaces.at(sample);
  // A band is a window on the whole image. It is moved by whole pixels, so nothing is rasterised differently.
  // Samples move it by eighths of a pixel, so that the position of the sample becomes the pixel centre.
  const auto top = static_cast<std::int32_t>(sample * rows);
  const VkViewport viewport{.x = 0.5F - place[0],
                            .y = static_cast<float>(top - attachments.first_row) + 0.5F - place[1],
                            .width = static_cast<float>(attachments.width),
                            .height = static_cast<float>(attachments.image_height),
                            .minDepth = 0,
                            .maxDepth = 1};
  vkCmdSetViewport(commands_, 0, 1, &viewport);
  const VkRect2D area{.offset = {0, top}, .extent = {attachments.width, rows}};
  vkCmdSetScissor(commands_, 0, 1, &area);
}

void Recorder::push_words() {
  vkCmdPushConstants(commands_, context_.pipeline_layout(),
                     VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT,
                     0, sizeof push_, &push_);
}

void Recorder::bind_range(const DrawRange& range, const ScenePipeline& pipeline) {
  const OwnedPipeline& chosen = range.culled ? pipeline.culled : pipeline.two_sided;
  vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_GRAPHICS, chosen.get());
  push_.first_triangle = range.first_triangle;
  push_words();
}

void Recorder::draw_range(const DrawRange& range, const ScenePipeline& pipeline, std::uint32_t layers) {
  bind_range(range, pipeline);
  vkCmdDrawIndexed(commands_, 3 * range.triangles, layers, 3 * range.first_triangle, 0, 0);
}

void Recorder::begin_if(const Buffer& predicates, std::size_t index) {
  const VkConditionalRenderingBeginInfoEXT info{
      .sType = VK_STRUCTURE_TYPE_CONDITIONAL_RENDERING_BEGIN_INFO_EXT,
      .buffer = predicates.get(),
      .offset = 4 * static_cast<VkDeviceSize>(index)};
  context_.begin_conditional()(commands_, &info);
}

void Recorder::end_if() {
  context_.end_conditional()(commands_);
}

void Recorder::copy_word(const Buffer& from, std::uint64_t from_offset, const Buffer& to,
                         std::uint64_t to_offset) {
  const VkBufferCopy region{.srcOffset = from_offset, .dstOffset = to_offset, .size = sizeof(std::uint32_t)};
  vkCmdCopyBuffer(commands_, from.get(), to.get(), 1, &region);
}

void Recorder::draw_groups(std::span<const DrawRange> groups, const Buffer& predicates) {
  groups_ = groups;
  predicates_ = &predicates;
}

void Recorder::draw_boxes(const QueriedBoxes& boxes, const ScenePipeline& pipeline,
                          const Attachments& attachments) {
  vkCmdResetQueryPool(commands_, boxes.queries, 0, boxes.count);
  const VkRenderingInfo rendering{
      .sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
      .renderArea = {.offset = {0, 0}, .extent = {attachments.width, attachments.height}},
      .layerCount = 1};
  vkCmdBeginRendering(commands_, &rendering);
  push_state(VK_PIPELINE_BIND_POINT_GRAPHICS);
  const std::array<VkBuffer, 2> vertices{boxes.corners.get(), boxes.corners.get()};
  const std::array<VkDeviceSize, 2> offsets{};
  vkCmdBindVertexBuffers(commands_, 0, 2, vertices.data(), offsets.data());
  vkCmdBindIndexBuffer(commands_, boxes.indices.get(), 0, VK_INDEX_TYPE_UINT32);
  vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.culled.get());
  for (std::uint32_t i = 0; i < boxes.count; ++i) {
    push_.p[0] = i;
    push_words();
    begin_if(boxes.predicates, i);
    vkCmdBeginQuery(commands_, boxes.queries, i, 0);
    for_each_sample(attachments, [&] {
      vkCmdDrawIndexed(commands_, boxes.index_count, 1, 0, static_cast<std::int32_t>(8 * i), 0);
    });
    vkCmdEndQuery(commands_, boxes.queries, i);
    end_if();
  }
  vkCmdEndRendering(commands_);
  barrier();
  vkCmdCopyQueryPoolResults(commands_, boxes.queries, 0, boxes.count, boxes.predicates.get(), 0, 4,
                            VK_QUERY_RESULT_WAIT_BIT);
  barrier();
}

void Recorder::dispatch(const OwnedPipeline& pipeline, std::uint32_t groups_x, std::uint32_t groups_y) {
  count_fullscreen_pass();
  push_state(VK_PIPELINE_BIND_POINT_COMPUTE);
  vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.get());
  push_words();
  vkCmdDispatch(commands_, groups_x, groups_y, 1);
}

void Recorder::dispatch_indirect(const OwnedPipeline& pipeline, const Buffer& arguments,
                                 std::uint64_t offset) {
  push_state(VK_PIPELINE_BIND_POINT_COMPUTE);
  vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.get());
  push_words();
  vkCmdDispatchIndirect(commands_, arguments.get(), offset);
}

void Recorder::begin_time() {
  vkCmdResetQueryPool(commands_, timestamps_, 0, kMostTimestamps);
  write_timestamp();
}

void Recorder::begin_resolve() {
  if (resolves_) return;
  resolves_ = true;
  write_timestamp();
}

void Recorder::end_resolve() {
  if (!resolves_) return;
  resolves_ = false;
  barrier();
  write_timestamp();
}

void Recorder::end_time() {
  barrier();
  end_resolve();
  write_timestamp();
}

void Recorder::write_timestamp() {
  // Some drivers let a timestamp slip into the next pass. A barrier right behind it prevents that.
  vkCmdWriteTimestamp2(commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, timestamps_, used_timestamps_++);
  barrier();
}

}  // namespace pellucid::render
