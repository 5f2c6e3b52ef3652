// Implements pipeline.h: blending, depth, stencil and specialisation constants.
#include "render/device/pipeline.h"

#include <cassert>

#include "render/device/ordered_attachments.h"
#include "render/scene/gpu_scene.h"

namespace pellucid::render {
namespace {

OwnedShaderModule load(Context& context, std::span<const std::uint32_t> code) {
  const VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                      .codeSize = code.size_bytes(),
                                      .pCode = code.data()};
  VkShaderModule module = VK_NULL_HANDLE;
  context.call("loading a shader",
               [&] { return vkCreateShaderModule(context.device(), &info, nullptr, &module); });
  return {context.device(), module};
}

OwnedShaderModule load(Context& context, std::string_view name) {
  return load(context, shader_code(name));
}

// Points into `constants`, which must outlive this object.
class Specialization {
 public:
  explicit Specialization(const Constants& constants) {
    for (std::uint32_t i = 0; i < constants.size(); ++i) {
      entries_.push_back({.constantID = i, .offset = 4 * i, .size = 4});
    }
    info_ = {.mapEntryCount = static_cast<std::uint32_t>(entries_.size()),
             .pMapEntries = entries_.data(),
             .dataSize = 4 * constants.size(),
             .pData = constants.data()};
  }
  Specialization(const Specialization&) = delete;
  Specialization& operator=(const Specialization&) = delete;
  [[nodiscard]] const VkSpecializationInfo* get() const { return &info_; }

 private:
  std::vector<VkSpecializationMapEntry> entries_;
  VkSpecializationInfo info_{};
};

VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits kind, const OwnedShaderModule& module,
                                      const Specialization& constants) {
  return {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
          .stage = kind,
          .module = module.get(),
          .pName = "main",
          .pSpecializationInfo = constants.get()};
}

VkPipelineColorBlendAttachmentState blend_state(Blend blend) {
  constexpr VkColorComponentFlags kAll = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                                         VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
  VkPipelineColorBlendAttachmentState state{.colorWriteMask = kAll};
  if (blend == Blend::none) return state;
  state.blendEnable = VK_TRUE;
  state.srcColorBlendFactor =
      blend == Blend::under ? VK_BLEND_FACTOR_ONE_MINUS_DST_ALPHA : VK_BLEND_FACTOR_ONE;
  state.dstColorBlendFactor = VK_BLEND_FACTOR_ONE;
  state.colorBlendOp = blend == Blend::max ? VK_BLEND_OP_MAX : VK_BLEND_OP_ADD;
  state.srcAlphaBlendFactor = state.srcColorBlendFactor;
  state.dstAlphaBlendFactor = state.dstColorBlendFactor;
  state.alphaBlendOp = state.colorBlendOp;
  return state;
}

VkCompareOp compare_op(DepthTest test) {
  if (test == DepthTest::equal) return VK_COMPARE_OP_EQUAL;
  if (test == DepthTest::greater) return VK_COMPARE_OP_GREATER;
  return test == DepthTest::less ? VK_COMPARE_OP_LESS : VK_COMPARE_OP_LESS_OR_EQUAL;
}

VkStencilOpState stencil_state(Stencil use) {
  VkStencilOpState state{.failOp = VK_STENCIL_OP_KEEP,
                         .passOp = VK_STENCIL_OP_KEEP,
                         .depthFailOp = VK_STENCIL_OP_KEEP,
                         .compareOp = VK_COMPARE_OP_ALWAYS,
                         .compareMask = 0xFF,
                         .writeMask = 0xFF};
  if (use == Stencil::route) {
    state.failOp = state.passOp = state.depthFailOp = VK_STENCIL_OP_DECREMENT_AND_CLAMP;
    state.compareOp = VK_COMPARE_OP_EQUAL;
    state.reference = 2;
  }
  if (use == Stencil::mark) state.depthFailOp = VK_STENCIL_OP_INCREMENT_AND_CLAMP;
  if (use == Stencil::marked) state.compareOp = VK_COMPARE_OP_NOT_EQUAL;
  return state;
}

VkPipelineDepthStencilStateCreateInfo depth_state(const GraphicsSpec& spec) {
  const VkStencilOpState stencil = stencil_state(spec.stencil);
  return {.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
          .depthTestEnable = spec.depth_test != DepthTest::none ? VK_TRUE : VK_FALSE,
          .depthWriteEnable = spec.depth_write ? VK_TRUE : VK_FALSE,
          .depthCompareOp = compare_op(spec.depth_test),
          .stencilTestEnable = spec.stencil != Stencil::none ? VK_TRUE : VK_FALSE,
          .front = stencil,
          .back = stencil};
}

// Position and normal come from separate buffers.
constexpr std::array<VkVertexInputBindingDescription, 2> kVertexBuffers{
    {{.binding = 0, .stride = 12, .inputRate = VK_VERTEX_INPUT_RATE_VERTEX},
     {.binding = 1, .stride = 12, .inputRate = VK_VERTEX_INPUT_RATE_VERTEX}}};
constexpr std::array<VkVertexInputAttributeDescription, 2> kAttributes{
    {{.location = 0, .binding = 0, .format = VK_FORMAT_R32G32B32_SFLOAT, .offset = 0},
     {.location = 1, .binding = 1, .format = VK_FORMAT_R32G32B32_SFLOAT, .offset = 0}}};

}  // namespace

ScenePipeline make_scene_pipeline(Context& context, const GraphicsSpec& spec) {
  const Specialization constants(spec.constants);
  const OwnedShaderModule vertex = load(context, spec.vertex_shader);
  std::vector<VkPipelineShaderStageCreateInfo> stages{stage(VK_SHADER_STAGE_VERTEX_BIT, vertex, constants)};
  OwnedShaderModule fragment;
  if (!spec.fragment_shader.empty()) {
    fragment = load(context, spec.fragment_shader);
    stages.push_back(stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment, constants));
  }
  const VkPipelineVertexInputStateCreateInfo input{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
      .vertexBindingDescriptionCount = static_cast<std::uint32_t>(kVertexBuffers.size()),
      .pVertexBindingDescriptions = kVertexBuffers.data(),
      .vertexAttributeDescriptionCount = static_cast<std::uint32_t>(kAttributes.size()),
      .pVertexAttributeDescriptions = kAttributes.data()};
  const VkPipelineInputAssemblyStateCreateInfo assembly{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
      .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
  const VkPipelineViewportStateCreateInfo viewport{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
  VkPipelineRasterizationStateCreateInfo raster{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
      .depthClampEnable = spec.clamp_depth ? VK_TRUE : VK_FALSE,
      .polygonMode = VK_POLYGON_MODE_FILL,
      .cullMode = VK_CULL_MODE_NONE,
      .frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE,
      .lineWidth = 1};
  const VkPipelineMultisampleStateCreateInfo samples{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
      .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
  const VkPipelineDepthStencilStateCreateInfo depth = depth_state(spec);
  const std::vector<VkPipelineColorBlendAttachmentState> blends(spec.colors.size(), blend_state(spec.blend));
  constexpr auto kInOrder =
      VK_PIPELINE_COLOR_BLEND_STATE_CREATE_RASTERIZATION_ORDER_ATTACHMENT_ACCESS_BIT_EXT;
  const VkPipelineColorBlendStateCreateInfo blend{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
      .flags = spec.ordered == nullptr ? VkPipelineColorBlendStateCreateFlags{0}
                                       : VkPipelineColorBlendStateCreateFlags{kInOrder},
      .attachmentCount = static_cast<std::uint32_t>(blends.size()),
      .pAttachments = blends.data()};
  const std::array<VkDynamicState, 2> dynamic{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  const VkPipelineDynamicStateCreateInfo dynamic_info{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
      .dynamicStateCount = 2,
      .pDynamicStates = dynamic.data()};
  const VkPipelineRenderingCreateInfo rendering{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
      .colorAttachmentCount = static_cast<std::uint32_t>(spec.colors.size()),
      .pColorAttachmentFormats = spec.colors.data(),
      .depthAttachmentFormat = spec.depth,
      .stencilAttachmentFormat =
          spec.depth == VK_FORMAT_D32_SFLOAT_S8_UINT ? spec.depth : VK_FORMAT_UNDEFINED};
  const VkGraphicsPipelineCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
      .pNext = spec.ordered == nullptr ? &rendering : nullptr,
      .stageCount = static_cast<std::uint32_t>(stages.size()),
      .pStages = stages.data(),
      .pVertexInputState = &input,
      .pInputAssemblyState = &assembly,
      .pViewportState = &viewport,
      .pRasterizationState = &raster,
      .pMultisampleState = &samples,
      .pDepthStencilState = &depth,
      .pColorBlendState = &blend,
      .pDynamicState = &dynamic_info,
      .layout = spec.ordered == nullptr ? context.pipeline_layout() : spec.ordered->pipeline_layout(),
      .renderPass = spec.ordered == nullptr ? VkRenderPass{VK_NULL_HANDLE} : spec.ordered->render_pass()};
  const auto make = [&](VkCullModeFlags cull) {
    raster.cullMode = cull;
    VkPipeline pipeline = VK_NULL_HANDLE;
    context.call("creating a pipeline", [&] {
      return vkCreateGraphicsPipelines(context.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline);
    });
    return OwnedPipeline(context.device(), pipeline);
  };
  ScenePipeline pipelines;
  pipelines.two_sided = make(VK_CULL_MODE_NONE);
  pipelines.culled = make(VK_CULL_MODE_BACK_BIT);
  return pipelines;
}

OwnedPipeline make_compute_pipeline(Context& context, std::string_view shader, const Constants& constants) {
  return make_compute_pipeline(context, shader_code(shader), constants);
}

OwnedPipeline make_compute_pipeline(Context& context, std::span<const std::uint32_t> code,
                                    const Constants& values) {
  const Specialization constants(values);
  const OwnedShaderModule module = load(context, code);
  const VkComputePipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                         .stage = stage(VK_SHADER_STAGE_COMPUTE_BIT, module, constants),
                                         .layout = context.pipeline_layout()};
  VkPipeline pipeline = VK_NULL_HANDLE;
  context.call("creating a pipeline", [&] {
    return vkCreateComputePipelines(context.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline);
  });
  return {context.device(), pipeline};
}

}  // namespace pellucid::render
