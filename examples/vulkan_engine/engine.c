#include "engine.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t kVertexShader[] =
#include "shape.vert.inc"
    ;
static const uint32_t kFragmentShader[] =
#include "shape.frag.inc"
    ;
static const VkFormat kFormat = VK_FORMAT_R8G8B8A8_SRGB; /* blends linear light */

static void check(VkResult result, const char* what) {
  if (result == VK_SUCCESS) return;
  fprintf(stderr, "vulkan_engine: %s failed: VkResult %d\n", what, (int)result);
  exit(1);
}

static void make_device(Engine* e) {
  const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                         .pApplicationName = "vulkan_engine",
                                         .apiVersion = VK_API_VERSION_1_3};
  const VkInstanceCreateInfo instance = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                         .pApplicationInfo = &application};
  const float priority = 1;
  uint32_t count = 1;
  VkResult found;
  check(vkCreateInstance(&instance, NULL, &e->instance), "vkCreateInstance");
  found = vkEnumeratePhysicalDevices(e->instance, &count, &e->gpu); /* takes the first one */
  if (found == VK_INCOMPLETE) found = VK_SUCCESS;
  check(count == 0 ? VK_ERROR_INITIALIZATION_FAILED : found, "vkEnumeratePhysicalDevices");
  /* A real engine looks for a queue family with graphics. In practice the first one has it. */
  e->queue_family = 0;
  const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                         .queueFamilyIndex = e->queue_family,
                                         .queueCount = 1,
                                         .pQueuePriorities = &priority};
  VkPhysicalDeviceVulkan13Features features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                               .synchronization2 = VK_TRUE,
                                               .dynamicRendering = VK_TRUE};
  const VkDeviceCreateInfo device = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .pNext = &features,
                                     .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queue};
  check(vkCreateDevice(e->gpu, &device, NULL, &e->device), "vkCreateDevice");
  vkGetDeviceQueue(e->device, e->queue_family, 0, &e->queue);
}

static VkDeviceMemory allocate(const Engine* e, const VkMemoryRequirements* needs,
                               VkMemoryPropertyFlags wanted) {
  VkPhysicalDeviceMemoryProperties memory;
  VkDeviceMemory allocated;
  uint32_t type = 0;
  vkGetPhysicalDeviceMemoryProperties(e->gpu, &memory);
  while (type < memory.memoryTypeCount && !((needs->memoryTypeBits >> type & 1u) &&
                                            (memory.memoryTypes[type].propertyFlags & wanted) == wanted))
    ++type;
  const VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                     .allocationSize = needs->size,
                                     .memoryTypeIndex = type};
  check(type < memory.memoryTypeCount ? VK_SUCCESS : VK_ERROR_OUT_OF_DEVICE_MEMORY, "finding memory");
  check(vkAllocateMemory(e->device, &info, NULL, &allocated), "vkAllocateMemory");
  return allocated;
}

/* Makes a buffer in memory that the CPU can write. An engine for discrete GPUs copies it to device memory
 * once. */
static Buffer make_buffer(const Engine* e, size_t bytes, VkBufferUsageFlags usage) {
  const VkBufferCreateInfo info = {
      .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = usage};
  VkMemoryRequirements needs;
  Buffer made;
  check(vkCreateBuffer(e->device, &info, NULL, &made.buffer), "vkCreateBuffer");
  vkGetBufferMemoryRequirements(e->device, made.buffer, &needs);
  made.memory =
      allocate(e, &needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  check(vkBindBufferMemory(e->device, made.buffer, made.memory, 0), "vkBindBufferMemory");
  check(vkMapMemory(e->device, made.memory, 0, VK_WHOLE_SIZE, 0, &made.mapped), "vkMapMemory");
  return made;
}

static void make_target(Engine* e) {
  const VkImageCreateInfo image = {
      .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
      .imageType = VK_IMAGE_TYPE_2D,
      .format = kFormat,
      .extent = {kWidth, kHeight, 1},
      .mipLevels = 1,
      .arrayLayers = 1,
      .samples = VK_SAMPLE_COUNT_1_BIT,
      .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
  VkMemoryRequirements needs;
  check(vkCreateImage(e->device, &image, NULL, &e->target), "vkCreateImage");
  vkGetImageMemoryRequirements(e->device, e->target, &needs);
  e->target_memory = allocate(e, &needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  check(vkBindImageMemory(e->device, e->target, e->target_memory, 0), "vkBindImageMemory");
  const VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                      .image = e->target,
                                      .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                      .format = kFormat,
                                      .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
  check(vkCreateImageView(e->device, &view, NULL, &e->target_view), "vkCreateImageView");
}

static VkShaderModule make_shader(const Engine* e, const uint32_t* code, size_t bytes) {
  const VkShaderModuleCreateInfo info = {
      .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = bytes, .pCode = code};
  VkShaderModule shader;
  check(vkCreateShaderModule(e->device, &info, NULL, &shader), "vkCreateShaderModule");
  return shader;
}

/* Only two settings are particular to pellucid. Back faces are culled, because orders of meshes with two
 * visible sides hold a flipped copy of each triangle for its back. And depth is not written. (Where opaque
 * objects are drawn first, turn the depth test on.) */
static void make_pipeline(Engine* e) {
  const VkPushConstantRange range = {VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                                     sizeof(Frame)};
  const VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                             .pushConstantRangeCount = 1,
                                             .pPushConstantRanges = &range};
  check(vkCreatePipelineLayout(e->device, &layout, NULL, &e->layout), "vkCreatePipelineLayout");
  const VkPipelineShaderStageCreateInfo stages[2] = {
      {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
       .stage = VK_SHADER_STAGE_VERTEX_BIT,
       .module = make_shader(e, kVertexShader, sizeof kVertexShader),
       .pName = "main"},
      {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
       .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
       .module = make_shader(e, kFragmentShader, sizeof kFragmentShader),
       .pName = "main"}};
  const VkVertexInputBindingDescription binding = {0, 6 * sizeof(float), VK_VERTEX_INPUT_RATE_VERTEX};
  const VkVertexInputAttributeDescription attributes[2] = {
      {0, 0, VK_FORMAT_R32G32B32_SFLOAT, 0}, {1, 0, VK_FORMAT_R32G32B32_SFLOAT, 3 * sizeof(float)}};
  const VkPipelineVertexInputStateCreateInfo input = {
      .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
      .vertexBindingDescriptionCount = 1,
      .pVertexBindingDescriptions = &binding,
      .vertexAttributeDescriptionCount = 2,
      .pVertexAttributeDescriptions = attributes};
  const VkPipelineInputAssemblyStateCreateInfo assembly = {
      .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
      .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
  /* A negative height makes y point upwards, so that counter-clockwise stays counter-clockwise. */
  const VkViewport viewport = {0, kHeight, kWidth, -kHeight, 0, 1};
  const VkRect2D scissor = {{0, 0}, {kWidth, kHeight}};
  const VkPipelineViewportStateCreateInfo viewports = {
      .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
      .viewportCount = 1,
      .pViewports = &viewport,
      .scissorCount = 1,
      .pScissors = &scissor};
  const VkPipelineRasterizationStateCreateInfo raster = {
      .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
      .cullMode = VK_CULL_MODE_BACK_BIT,
      .frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE,
      .lineWidth = 1};
  const VkPipelineMultisampleStateCreateInfo samples = {
      .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
      .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
  const VkPipelineColorBlendAttachmentState over = {
      .blendEnable = VK_TRUE,
      .srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA,
      .dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
      .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
      .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
      .colorWriteMask = 0xF};
  const VkPipelineColorBlendStateCreateInfo blend = {
      .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
      .attachmentCount = 1,
      .pAttachments = &over};
  const VkPipelineRenderingCreateInfo rendering = {.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                   .colorAttachmentCount = 1,
                                                   .pColorAttachmentFormats = &kFormat};
  const VkGraphicsPipelineCreateInfo pipeline = {.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                                 .pNext = &rendering,
                                                 .stageCount = 2,
                                                 .pStages = stages,
                                                 .pVertexInputState = &input,
                                                 .pInputAssemblyState = &assembly,
                                                 .pViewportState = &viewports,
                                                 .pRasterizationState = &raster,
                                                 .pMultisampleState = &samples,
                                                 .pColorBlendState = &blend,
                                                 .layout = e->layout};
  check(vkCreateGraphicsPipelines(e->device, VK_NULL_HANDLE, 1, &pipeline, NULL, &e->pipeline),
        "vkCreateGraphicsPipelines");
  vkDestroyShaderModule(e->device, stages[0].module, NULL);
  vkDestroyShaderModule(e->device, stages[1].module, NULL);
}

static void make_commands(Engine* e) {
  const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                        .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                        .queueFamilyIndex = e->queue_family};
  const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  check(vkCreateCommandPool(e->device, &pool, NULL, &e->pool), "vkCreateCommandPool");
  const VkCommandBufferAllocateInfo buffer = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                              .commandPool = e->pool,
                                              .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                              .commandBufferCount = 1};
  check(vkAllocateCommandBuffers(e->device, &buffer, &e->commands), "vkAllocateCommandBuffers");
  check(vkCreateFence(e->device, &fence, NULL, &e->done), "vkCreateFence");
}

Engine make_engine(const void* vertices, size_t vertex_bytes, size_t index_bytes) {
  Engine e = {0};
  make_device(&e);
  make_commands(&e);
  make_target(&e);
  make_pipeline(&e);
  e.vertices = make_buffer(&e, vertex_bytes, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
  e.indices = make_buffer(&e, index_bytes, VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
  e.pixels = make_buffer(&e, kWidth * kHeight * 4, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
  memcpy(e.vertices.mapped, vertices, vertex_bytes);
  return e;
}

static void free_buffer(const Engine* e, Buffer* buffer) {
  vkDestroyBuffer(e->device, buffer->buffer, NULL);
  vkFreeMemory(e->device, buffer->memory, NULL);
}

void free_engine(Engine* e) {
  free_buffer(e, &e->vertices);
  free_buffer(e, &e->indices);
  free_buffer(e, &e->pixels);
  vkDestroyPipeline(e->device, e->pipeline, NULL);
  vkDestroyPipelineLayout(e->device, e->layout, NULL);
  vkDestroyImageView(e->device, e->target_view, NULL);
  vkDestroyImage(e->device, e->target, NULL);
  vkFreeMemory(e->device, e->target_memory, NULL);
  vkDestroyFence(e->device, e->done, NULL);
  vkDestroyCommandPool(e->device, e->pool, NULL);
  vkDestroyDevice(e->device, NULL);
  vkDestroyInstance(e->instance, NULL);
}

/* Changes the layout of the target. All later commands wait for all earlier ones, which is simple and right;
 * an engine names the stages. */
static void use_target_as(const Engine* e, VkImageLayout before, VkImageLayout now) {
  const VkImageMemoryBarrier2 barrier = {
      .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
      .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
      .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
      .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
      .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT,
      .oldLayout = before,
      .newLayout = now,
      .image = e->target,
      .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
  const VkDependencyInfo dependency = {.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                       .imageMemoryBarrierCount = 1,
                                       .pImageMemoryBarriers = &barrier};
  vkCmdPipelineBarrier2(e->commands, &dependency);
}

static void record_draw(const Engine* e, const Frame* frame, uint32_t first, uint32_t count) {
  const VkDeviceSize start = 0;
  const VkRenderingAttachmentInfo target = {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                            .imageView = e->target_view,
                                            .imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                            .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                            .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                            .clearValue = {{{1, 1, 1, 1}}}};
  const VkRenderingInfo rendering = {.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                     .renderArea = {{0, 0}, {kWidth, kHeight}},
                                     .layerCount = 1,
                                     .colorAttachmentCount = 1,
                                     .pColorAttachments = &target};
  vkCmdBeginRendering(e->commands, &rendering);
  vkCmdBindPipeline(e->commands, VK_PIPELINE_BIND_POINT_GRAPHICS, e->pipeline);
  vkCmdPushConstants(e->commands, e->layout, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                     sizeof *frame, frame);
  vkCmdBindVertexBuffers(e->commands, 0, 1, &e->vertices.buffer, &start);
  vkCmdBindIndexBuffer(e->commands, e->indices.buffer, 0, VK_INDEX_TYPE_UINT32);
  vkCmdDrawIndexed(e->commands, count, 1, first, 0, 0);
  vkCmdEndRendering(e->commands);
}

static void record_copy(const Engine* e) {
  const VkBufferImageCopy region = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                    .imageExtent = {kWidth, kHeight, 1}};
  const VkMemoryBarrier2 written = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                    .srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT,
                                    .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                    .dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT,
                                    .dstAccessMask = VK_ACCESS_2_HOST_READ_BIT};
  const VkDependencyInfo dependency = {
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &written};
  vkCmdCopyImageToBuffer(e->commands, e->target, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, e->pixels.buffer, 1,
                         &region);
  vkCmdPipelineBarrier2(e->commands, &dependency);
}

const uint8_t* draw(Engine* e, const Frame* frame, uint32_t first, uint32_t count) {
  const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                          .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  const VkCommandBufferSubmitInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                              .commandBuffer = e->commands};
  const VkSubmitInfo2 submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                                .commandBufferInfoCount = 1,
                                .pCommandBufferInfos = &commands};
  check(vkBeginCommandBuffer(e->commands, &begin), "vkBeginCommandBuffer");
  use_target_as(e, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
  record_draw(e, frame, first, count);
  use_target_as(e, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  record_copy(e);
  check(vkEndCommandBuffer(e->commands), "vkEndCommandBuffer");
  check(vkQueueSubmit2(e->queue, 1, &submit, e->done), "vkQueueSubmit2");
  check(vkWaitForFences(e->device, 1, &e->done, VK_TRUE, UINT64_MAX), "vkWaitForFences");
  check(vkResetFences(e->device, 1, &e->done), "vkResetFences");
  return e->pixels.mapped;
}
