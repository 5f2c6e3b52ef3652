// Implements context.h: the choice of a device, its features, submission, and validation messages.
#include "render/device/context.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <optional>

namespace pellucid::render {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

const char* name_of(VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "out of memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "out of device memory: try a smaller image or memory budget";
    case VK_ERROR_DEVICE_LOST:
      return "the device was lost";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "initialisation failed";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "no Vulkan driver is installed (Debian: mesa-vulkan-drivers)";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "the validation layers are not installed (Debian: vulkan-validationlayers)";
    case VK_ERROR_TOO_MANY_OBJECTS:
      return "too many objects";
    default:
      return nullptr;
  }
}

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT /*severity*/,
                                          VkDebugUtilsMessageTypeFlagsEXT type,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  // Drivers send their own messages with the general type. Only validation messages are kept.
  if ((type & VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT) == 0) return VK_FALSE;
  auto* log = static_cast<ValidationLog*>(user);
  const std::scoped_lock lock(log->mutex);
  log->messages.emplace_back(data->pMessage);
  if (log->on_message) log->on_message(log->messages.back());
  return VK_FALSE;
}

template <class Call>
auto instance_call(VkInstance instance, const char* name) {
  return reinterpret_cast<Call>(vkGetInstanceProcAddr(instance, name));
}

bool has(const std::vector<VkExtensionProperties>& extensions, const char* name) {
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

std::vector<VkExtensionProperties> device_extensions(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
  return extensions;
}

std::optional<std::uint32_t> graphics_queue(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (std::uint32_t i = 0; i < count; ++i) {
    if ((families[i].queueFlags & kNeeded) == kNeeded) return i;
  }
  return std::nullopt;
}

// Prefers GPUs to a driver that runs on the CPU, and the first of several equal devices.
int preference(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 3;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 2;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 1;
    default:
      return 0;
  }
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

constexpr std::uint32_t kMostOrderedAttachments = 8;  // shaders/capture/k_buffers/ordered_slots.frag

// Features of extensions that a device need not support.
struct OptionalFeatures {
  VkPhysicalDeviceConditionalRenderingFeaturesEXT conditional{
      .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_CONDITIONAL_RENDERING_FEATURES_EXT};
  VkPhysicalDeviceRasterizationOrderAttachmentAccessFeaturesEXT ordered{
      .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RASTERIZATION_ORDER_ATTACHMENT_ACCESS_FEATURES_EXT};
  VkPhysicalDeviceFragmentShaderInterlockFeaturesEXT interlock{
      .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FRAGMENT_SHADER_INTERLOCK_FEATURES_EXT};

  // Appends the wanted structures to a chain.
  void chain(void** end, bool with_conditional, bool with_ordered, bool with_interlock) {
    const auto append = [&](bool wanted, auto& features) {
      if (!wanted) return;
      *end = &features;
      end = &features.pNext;
    };
    append(with_conditional, conditional);
    append(with_ordered, ordered);
    append(with_interlock, interlock);
  }
};

// Returns why a device cannot be used, or an empty text if it can.
std::string unfit(VkPhysicalDevice device, const VkPhysicalDeviceProperties& properties) {
  if (properties.apiVersion < VK_API_VERSION_1_3) return "has no Vulkan 1.3";
  if (!graphics_queue(device)) return "has no queue for graphics and compute";
  if (!has(device_extensions(device), VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME)) {
    return "has no VK_KHR_push_descriptor";
  }
  VkPhysicalDeviceFeatures features{};
  vkGetPhysicalDeviceFeatures(device, &features);
  if (features.geometryShader == VK_FALSE) return "does not number triangles (geometryShader)";
  if (features.independentBlend == VK_FALSE) return "cannot blend attachments differently";
  if (features.fragmentStoresAndAtomics == VK_FALSE) return "cannot store from fragment shaders";
  return "";
}

}  // namespace

void check(VkResult result, std::string_view what) {
  if (result == VK_SUCCESS) return;
  const char* name = name_of(result);
  throw Error(ErrorKind::internal, name != nullptr
                                       ? fmt::format("Vulkan, {}: {}", what, name)
                                       : fmt::format("Vulkan, {}: error {}", what, static_cast<int>(result)));
}

Context::OwnedInstance::~OwnedInstance() {
  if (messenger != VK_NULL_HANDLE) {
    instance_call<PFN_vkDestroyDebugUtilsMessengerEXT>(handle, "vkDestroyDebugUtilsMessengerEXT")(
        handle, messenger, nullptr);
  }
  if (handle != VK_NULL_HANDLE) vkDestroyInstance(handle, nullptr);
}

Context::OwnedDevice::~OwnedDevice() {
  if (handle != VK_NULL_HANDLE) vkDestroyDevice(handle, nullptr);
}

Context::Context(const DeviceOptions& options)
    : fault_(options.fault), log_(std::make_unique<ValidationLog>()) {
  log_->on_message = options.on_message;
  create_instance(options.validate);
  choose_device(options);
  create_device();
  create_layouts();
}

VkResult Context::attempt(std::string_view what, const std::function<VkResult()>& make) {
  if (lost_) return VK_ERROR_DEVICE_LOST;
  const auto injected = static_cast<VkResult>(fault_ ? fault_(what) : 0);
  const VkResult result = injected == VK_SUCCESS ? make() : injected;
  lost_ = result == VK_ERROR_DEVICE_LOST;
  return result;
}

void Context::call(std::string_view what, const std::function<VkResult()>& make) {
  check(attempt(what, make), what);
}

void Context::create_instance(bool validate) {
  const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                      .pApplicationName = "pellucid",
                                      .apiVersion = VK_API_VERSION_1_3};
  const VkDebugUtilsMessengerCreateInfoEXT messenger{
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .messageSeverity =
          VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
      .messageType =
          VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
      .pfnUserCallback = on_message,
      .pUserData = log_.get()};
  const VkValidationFeatureEnableEXT synchronisation =
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  const VkValidationFeaturesEXT features{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                         .pNext = &messenger,
                                         .enabledValidationFeatureCount = 1,
                                         .pEnabledValidationFeatures = &synchronisation};
  const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                  .pNext = validate ? &features : nullptr,
                                  .pApplicationInfo = &application,
                                  .enabledLayerCount = validate ? 1U : 0U,
                                  .ppEnabledLayerNames = &kValidationLayer,
                                  .enabledExtensionCount = validate ? 1U : 0U,
                                  .ppEnabledExtensionNames = &extension};
  call("creating the instance", [&] { return vkCreateInstance(&info, nullptr, &instance_.handle); });
  if (validate) {
    check(
        instance_call<PFN_vkCreateDebugUtilsMessengerEXT>(instance_.handle, "vkCreateDebugUtilsMessengerEXT")(
            instance_.handle, &messenger, nullptr, &instance_.messenger),
        "creating the message callback");
  }
}

void Context::choose_device(const DeviceOptions& options) {
  const std::string& wanted = options.device;
  std::uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(instance_.handle, &count, nullptr), "listing devices");
  std::vector<VkPhysicalDevice> devices(count);
  check(vkEnumeratePhysicalDevices(instance_.handle, &count, devices.data()), "listing devices");
  std::string there;
  int best = -1;
  for (const VkPhysicalDevice device : devices) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(device, &properties);
    const std::string reason = unfit(device, properties);
    there.append(there.empty() ? "" : ", ").append(properties.deviceName);
    if (!reason.empty()) {
      there.append(" (").append(reason).append(")");
      continue;
    }
    const bool named = lower(properties.deviceName).find(lower(wanted)) != std::string::npos;
    if (!named || preference(properties.deviceType) <= best) continue;
    best = preference(properties.deviceType);
    physical_ = device;
  }
  if (physical_ == VK_NULL_HANDLE) {
    throw Error(
        ErrorKind::bad_argument,
        fmt::format("there is no Vulkan device {}; there is {}",
                    wanted.empty() ? std::string("can be used") : "is named '" + wanted + "'",
                    there.empty() ? "none (Debian: mesa-vulkan-drivers has one for the CPU)" : there));
  }
  read_info(options.max_buffer_bytes);
  read_features();
}

void Context::read_info(std::uint64_t most_buffer_bytes) {
  VkPhysicalDeviceSubgroupProperties subgroup{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
  VkPhysicalDeviceDriverProperties driver{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES,
                                          .pNext = &subgroup};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                         .pNext = &driver};
  vkGetPhysicalDeviceProperties2(physical_, &properties);
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
  const auto& limits = properties.properties.limits;
  nanoseconds_per_tick_ = static_cast<double>(limits.timestampPeriod);
  info_.name = properties.properties.deviceName;
  info_.driver = fmt::format("{} {}", driver.driverName, driver.driverInfo);
  info_.cpu = properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  info_.max_buffer_bytes = limits.maxStorageBufferRange;
  if (most_buffer_bytes != 0) info_.max_buffer_bytes = std::min(info_.max_buffer_bytes, most_buffer_bytes);
  info_.max_side =
      std::min({limits.maxFramebufferWidth, limits.maxFramebufferHeight, limits.maxImageDimension2D});

  info_.ordered_attachments =
      std::min({limits.maxColorAttachments, limits.maxFragmentOutputAttachments,
                limits.maxPerStageDescriptorInputAttachments, kMostOrderedAttachments});
}

void Context::read_features() {
  const std::vector<VkExtensionProperties> extensions = device_extensions(physical_);
  VkPhysicalDeviceVulkan12Features features12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                     .pNext = &features12};
  OptionalFeatures optional;
  void** end = &features12.pNext;
  optional.chain(end, has(extensions, VK_EXT_CONDITIONAL_RENDERING_EXTENSION_NAME),
                 has(extensions, VK_EXT_RASTERIZATION_ORDER_ATTACHMENT_ACCESS_EXTENSION_NAME),
                 has(extensions, VK_EXT_FRAGMENT_SHADER_INTERLOCK_EXTENSION_NAME));
  vkGetPhysicalDeviceFeatures2(physical_, &features);
  integers64_ = features.features.shaderInt64 == VK_TRUE;
  info_.atomics64 = integers64_ && features12.shaderBufferInt64Atomics == VK_TRUE;
  info_.layered = features12.shaderOutputLayer == VK_TRUE;
  info_.precise_queries = features.features.occlusionQueryPrecise == VK_TRUE;
  info_.conditional =
      optional.conditional.conditionalRendering == VK_TRUE && features.features.depthClamp == VK_TRUE;
  // The fragments in the attachments are compared as 64-bit keys.
  if (optional.ordered.rasterizationOrderColorAttachmentAccess == VK_FALSE || !integers64_)
    info_.ordered_attachments = 0;
  info_.interlock = optional.interlock.fragmentShaderPixelInterlock == VK_TRUE && integers64_;
}

void Context::create_device() {
  queue_family_ = graphics_queue(physical_).value();
  const float priority = 1;
  const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                      .queueFamilyIndex = queue_family_,
                                      .queueCount = 1,
                                      .pQueuePriorities = &priority};
  const bool ordered = info_.ordered_attachments > 0;
  OptionalFeatures optional;
  optional.conditional.conditionalRendering = VK_TRUE;
  optional.ordered.rasterizationOrderColorAttachmentAccess = VK_TRUE;
  optional.interlock.fragmentShaderPixelInterlock = VK_TRUE;
  VkPhysicalDeviceVulkan13Features features13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                              .synchronization2 = VK_TRUE,
                                              .dynamicRendering = VK_TRUE};
  optional.chain(&features13.pNext, info_.conditional, ordered, info_.interlock);
  VkPhysicalDeviceVulkan12Features features12{
      .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
      .pNext = &features13,
      .shaderBufferInt64Atomics = info_.atomics64 ? VK_TRUE : VK_FALSE,
      .shaderOutputLayer = info_.layered ? VK_TRUE : VK_FALSE};
  const VkPhysicalDeviceFeatures2 features{
      .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
      .pNext = &features12,
      .features = {.independentBlend = VK_TRUE,
                   .geometryShader = VK_TRUE,  // gl_PrimitiveID in fragment shaders
                   .depthClamp = info_.conditional ? VK_TRUE : VK_FALSE,
                   .occlusionQueryPrecise = info_.precise_queries ? VK_TRUE : VK_FALSE,
                   .fragmentStoresAndAtomics = VK_TRUE,
                   .shaderInt64 = integers64_ ? VK_TRUE : VK_FALSE}};
  std::vector<const char*> extensions{VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME};
  if (info_.conditional) extensions.push_back(VK_EXT_CONDITIONAL_RENDERING_EXTENSION_NAME);
  if (ordered) extensions.push_back(VK_EXT_RASTERIZATION_ORDER_ATTACHMENT_ACCESS_EXTENSION_NAME);
  if (info_.interlock) extensions.push_back(VK_EXT_FRAGMENT_SHADER_INTERLOCK_EXTENSION_NAME);
  const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                .pNext = &features,
                                .queueCreateInfoCount = 1,
                                .pQueueCreateInfos = &queue,
                                .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
                                .ppEnabledExtensionNames = extensions.data()};
  call("creating the device", [&] { return vkCreateDevice(physical_, &info, nullptr, &device_.handle); });
  vkGetDeviceQueue(device_.handle, queue_family_, 0, &queue_);
  push_descriptors_ = reinterpret_cast<PFN_vkCmdPushDescriptorSetKHR>(
      vkGetDeviceProcAddr(device_.handle, "vkCmdPushDescriptorSetKHR"));
  begin_conditional_ = reinterpret_cast<PFN_vkCmdBeginConditionalRenderingEXT>(
      vkGetDeviceProcAddr(device_.handle, "vkCmdBeginConditionalRenderingEXT"));
  end_conditional_ = reinterpret_cast<PFN_vkCmdEndConditionalRenderingEXT>(
      vkGetDeviceProcAddr(device_.handle, "vkCmdEndConditionalRenderingEXT"));

  const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                     .queueFamilyIndex = queue_family_};
  VkCommandPool commands = VK_NULL_HANDLE;
  call("creating the command pool",
       [&] { return vkCreateCommandPool(device_.handle, &pool, nullptr, &commands); });
  commands_ = {device_.handle, commands};
}

void Context::create_layouts() {
  std::array<VkDescriptorSetLayoutBinding, kSlots> bindings{};
  for (std::uint32_t slot = 0; slot < kSlots; ++slot) {
    bindings[slot] = {
        .binding = slot,
        .descriptorType =
            slot < kFirstImageSlot ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER : VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE,
        .descriptorCount = 1,
        .stageFlags = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT,
        .pImmutableSamplers = nullptr};
  }
  const VkDescriptorSetLayoutCreateInfo set{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                            .flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR,
                                            .bindingCount = kSlots,
                                            .pBindings = bindings.data()};
  VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
  call("creating the descriptor layout",
       [&] { return vkCreateDescriptorSetLayout(device_.handle, &set, nullptr, &set_layout); });
  set_layout_ = {device_.handle, set_layout};
  pipeline_layout_ = make_pipeline_layout();
}

OwnedPipelineLayout Context::make_pipeline_layout(VkDescriptorSetLayout set_1) {
  const VkPushConstantRange push{
      .stageFlags = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT,
      .offset = 0,
      .size = kPushBytes};
  const std::array<VkDescriptorSetLayout, 2> sets{set_layout_.get(), set_1};
  const VkPipelineLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                        .setLayoutCount = set_1 == VK_NULL_HANDLE ? 1U : 2U,
                                        .pSetLayouts = sets.data(),
                                        .pushConstantRangeCount = 1,
                                        .pPushConstantRanges = &push};
  VkPipelineLayout layout = VK_NULL_HANDLE;
  call("creating the pipeline layout",
       [&] { return vkCreatePipelineLayout(device_.handle, &info, nullptr, &layout); });
  return {device_.handle, layout};
}

void Context::submit(const std::function<void(VkCommandBuffer)>& record) {
  call("resetting the command pool", [&] { return vkResetCommandPool(device_.handle, commands_.get(), 0); });
  const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                             .commandPool = commands_.get(),
                                             .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                             .commandBufferCount = 1};
  VkCommandBuffer commands = VK_NULL_HANDLE;
  call("allocating commands", [&] { return vkAllocateCommandBuffers(device_.handle, &allocate, &commands); });
  struct Free {
    VkDevice device;
    VkCommandPool pool;
    VkCommandBuffer commands;
    ~Free() { vkFreeCommandBuffers(device, pool, 1, &commands); }
  } const free{device_.handle, commands_.get(), commands};
  const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                       .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  call("recording", [&] { return vkBeginCommandBuffer(commands, &begin); });
  record(commands);
  call("recording", [&] { return vkEndCommandBuffer(commands); });

  const VkFenceCreateInfo fence_info{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  VkFence fence = VK_NULL_HANDLE;
  call("creating a fence", [&] { return vkCreateFence(device_.handle, &fence_info, nullptr, &fence); });
  const OwnedFence owned(device_.handle, fence);
  const VkCommandBufferSubmitInfo buffer{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                         .commandBuffer = commands};
  const VkSubmitInfo2 submission{
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &buffer};
  call("submitting", [&] { return vkQueueSubmit2(queue_, 1, &submission, fence); });
  const VkResult waited =
      attempt("waiting", [&] { return vkWaitForFences(device_.handle, 1, &fence, VK_TRUE, UINT64_MAX); });
  // Objects that the device still uses must not be destroyed. For a lost device this returns at once.
  if (waited != VK_SUCCESS) vkDeviceWaitIdle(device_.handle);
  check(waited, "waiting for the device");
}

std::vector<std::string> Context::validation_messages() const {
  const std::scoped_lock lock(log_->mutex);
  return log_->messages;
}

}  // namespace pellucid::render
