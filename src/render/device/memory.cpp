// Implements memory.h: allocation of buffers and images, and copies through staging buffers.
#include "render/device/memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>

namespace pellucid::render {
namespace {

std::optional<std::uint32_t> find_memory_type(const Context& context, std::uint32_t allowed,
                                              VkMemoryPropertyFlags wanted) {
  const VkPhysicalDeviceMemoryProperties& memory = context.memory();
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    const bool fits = (memory.memoryTypes[i].propertyFlags & wanted) == wanted;
    if (((allowed >> i) & 1U) != 0 && fits) return i;
  }
  return std::nullopt;
}

OwnedMemory allocate(Context& context, const std::string& name, const VkMemoryRequirements& needs,
                     MemoryKind kind) {
  constexpr VkMemoryPropertyFlags kHost =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  auto type =
      kind == MemoryKind::readback
          ? find_memory_type(context, needs.memoryTypeBits, kHost | VK_MEMORY_PROPERTY_HOST_CACHED_BIT)
          : find_memory_type(context, needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  if (!type) type = find_memory_type(context, needs.memoryTypeBits, kind == MemoryKind::readback ? kHost : 0);
  const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                  .allocationSize = needs.size,
                                  .memoryTypeIndex = type.value_or(0)};
  VkDeviceMemory memory = VK_NULL_HANDLE;
  const VkResult result = context.attempt(
      "allocating memory", [&] { return vkAllocateMemory(context.device(), &info, nullptr, &memory); });
  if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY) {
    throw Error(ErrorKind::internal,
                fmt::format("Vulkan: {} is out of memory: the {} takes {} bytes: try a smaller image or "
                            "another technique",
                            context.info().name, name, needs.size));
  }
  check(result, "allocating memory");
  return {context.device(), memory};
}

VkImageCreateInfo image_info(const ImageSpec& spec) {
  const VkImageUsageFlags attachment =
      spec.depth() ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
  const VkImageUsageFlags read_back = spec.use == ImageUse::read_back
                                          ? VkImageUsageFlags{VK_IMAGE_USAGE_INPUT_ATTACHMENT_BIT}
                                          : VkImageUsageFlags{0};
  return {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
          .imageType = VK_IMAGE_TYPE_2D,
          .format = spec.format,
          .extent = {spec.width, spec.height, 1},
          .mipLevels = 1,
          .arrayLayers = spec.layers,
          .samples = VK_SAMPLE_COUNT_1_BIT,
          .tiling = VK_IMAGE_TILING_OPTIMAL,
          .usage = attachment | VK_IMAGE_USAGE_SAMPLED_BIT | read_back};
}

}  // namespace

Buffer::Buffer(Context& context, const std::string& name, std::uint64_t bytes, MemoryKind kind)
    : bytes_(std::max<std::uint64_t>(bytes, 16)) {
  if (kind == MemoryKind::device && bytes_ > context.info().max_buffer_bytes) {
    throw Error(
        ErrorKind::bad_argument,
        fmt::format("the {} would take {:.0f} MB, and {} lets shaders address {:.0f} MB at once: try a "
                    "smaller image or another technique",
                    name, static_cast<double>(bytes_) / 1e6, context.info().name,
                    static_cast<double>(context.info().max_buffer_bytes) / 1e6));
  }
  const VkBufferCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
      .size = bytes_,
      .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
               VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
               VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
               (context.info().conditional ? VkBufferUsageFlags{VK_BUFFER_USAGE_CONDITIONAL_RENDERING_BIT_EXT}
                                           : VkBufferUsageFlags{0})};
  VkBuffer buffer = VK_NULL_HANDLE;
  context.call(fmt::format("creating the {} of {} bytes", name, bytes_),
               [&] { return vkCreateBuffer(context.device(), &info, nullptr, &buffer); });
  buffer_ = {context.device(), buffer};
  VkMemoryRequirements needs{};
  vkGetBufferMemoryRequirements(context.device(), buffer, &needs);
  memory_ = allocate(context, name, needs, kind);
  context.call("binding memory of the " + name,
               [&] { return vkBindBufferMemory(context.device(), buffer, memory_.get(), 0); });
  if (kind == MemoryKind::readback) {
    context.call("mapping the " + name,
                 [&] { return vkMapMemory(context.device(), memory_.get(), 0, VK_WHOLE_SIZE, 0, &mapped_); });
  }
}

void Buffer::upload(Context& context, std::span<const std::byte> data) const {
  if (data.empty()) return;
  const Buffer staging(context, "staging buffer", data.size(), MemoryKind::readback);
  std::memcpy(staging.mapped_, data.data(), data.size());
  context.submit([&](VkCommandBuffer commands) {
    const VkBufferCopy region{.srcOffset = 0, .dstOffset = 0, .size = data.size()};
    vkCmdCopyBuffer(commands, staging.get(), get(), 1, &region);
  });
}

void Buffer::download(Context& context, std::span<std::byte> data, std::uint64_t offset) const {
  if (data.empty()) return;
  if (mapped_ != nullptr) {
    std::memcpy(data.data(), static_cast<const std::byte*>(mapped_) + offset, data.size());
    return;
  }
  const Buffer staging(context, "staging buffer", data.size(), MemoryKind::readback);
  context.submit([&](VkCommandBuffer commands) {
    const VkBufferCopy region{.srcOffset = offset, .dstOffset = 0, .size = data.size()};
    vkCmdCopyBuffer(commands, get(), staging.get(), 1, &region);
    const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                   .srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT,
                                   .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                   .dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT,
                                   .dstAccessMask = VK_ACCESS_2_HOST_READ_BIT};
    const VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &dependency);
  });
  std::memcpy(data.data(), staging.mapped_, data.size());
}

std::uint64_t Image::bytes_needed(const Context& context, const ImageSpec& spec) {
  const VkImageCreateInfo info = image_info(spec);
  const VkDeviceImageMemoryRequirements asked{.sType = VK_STRUCTURE_TYPE_DEVICE_IMAGE_MEMORY_REQUIREMENTS,
                                              .pCreateInfo = &info};
  VkMemoryRequirements2 needs{.sType = VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2};
  vkGetDeviceImageMemoryRequirements(context.device(), &asked, &needs);
  return needs.memoryRequirements.size;
}

Image::Image(Context& context, const std::string& name, const ImageSpec& spec) : spec_(spec) {
  const VkImageCreateInfo info = image_info(spec);
  VkImage image = VK_NULL_HANDLE;
  context.call("creating the image '" + name + "'",
               [&] { return vkCreateImage(context.device(), &info, nullptr, &image); });
  image_ = {context.device(), image};
  VkMemoryRequirements needs{};
  vkGetImageMemoryRequirements(context.device(), image, &needs);
  bytes_ = needs.size;
  memory_ = allocate(context, name, needs, MemoryKind::device);
  context.call("binding memory of the image '" + name + "'",
               [&] { return vkBindImageMemory(context.device(), image, memory_.get(), 0); });

  const auto make_view = [&](VkImageAspectFlags aspect) {
    const VkImageViewCreateInfo view_info{
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = image,
        .viewType = spec.layers > 1 || spec.use == ImageUse::read_back ? VK_IMAGE_VIEW_TYPE_2D_ARRAY
                                                                       : VK_IMAGE_VIEW_TYPE_2D,
        .format = spec.format,
        .subresourceRange = {.aspectMask = aspect, .levelCount = 1, .layerCount = spec.layers}};
    VkImageView view = VK_NULL_HANDLE;
    context.call("creating an image view",
                 [&] { return vkCreateImageView(context.device(), &view_info, nullptr, &view); });
    return OwnedImageView(context.device(), view);
  };
  const bool stencil = spec.format == VK_FORMAT_D32_SFLOAT_S8_UINT;
  const VkImageAspectFlags readable = spec.depth() ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  view_ = make_view(stencil ? readable | VK_IMAGE_ASPECT_STENCIL_BIT : readable);
  sampled_ = make_view(readable);
  if (stencil) stencil_ = make_view(VK_IMAGE_ASPECT_STENCIL_BIT);
}

}  // namespace pellucid::render
