// context.h - owns the Vulkan instance, one device and one queue, without a window. Validation is optional.
//
// A GPU is preferred to a driver that runs on the CPU. All work goes through submit(), which waits for the
// end. One command buffer per piece of work lets synchronisation validation see all of its hazards.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pellucid/render.h"

namespace pellucid::render {

// Owners of Vulkan objects. They destroy their objects in reverse order of creation, also when an error is
// thrown.

// An object that belongs to a device. `Destroy` is the vkDestroy* or vkFree* function of its type.
template <class Handle, auto Destroy>
class Owned {
 public:
  Owned() = default;
  Owned(VkDevice device, Handle handle) : device_(device), handle_(handle) {}
  Owned(Owned&& other) noexcept
      : device_(std::exchange(other.device_, VK_NULL_HANDLE)),
        handle_(std::exchange(other.handle_, VK_NULL_HANDLE)) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(handle_, other.handle_);
    return *this;
  }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  ~Owned() {
    if (handle_ != VK_NULL_HANDLE) Destroy(device_, handle_, nullptr);
  }
  [[nodiscard]] Handle get() const { return handle_; }
  explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }

 private:
  VkDevice device_ = VK_NULL_HANDLE;
  Handle handle_ = VK_NULL_HANDLE;
};

using OwnedBuffer = Owned<VkBuffer, vkDestroyBuffer>;
using OwnedCommandPool = Owned<VkCommandPool, vkDestroyCommandPool>;
using OwnedDescriptorPool = Owned<VkDescriptorPool, vkDestroyDescriptorPool>;
using OwnedDescriptorSetLayout = Owned<VkDescriptorSetLayout, vkDestroyDescriptorSetLayout>;
using OwnedFence = Owned<VkFence, vkDestroyFence>;
using OwnedFramebuffer = Owned<VkFramebuffer, vkDestroyFramebuffer>;
using OwnedImage = Owned<VkImage, vkDestroyImage>;
using OwnedImageView = Owned<VkImageView, vkDestroyImageView>;
using OwnedMemory = Owned<VkDeviceMemory, vkFreeMemory>;
using OwnedPipeline = Owned<VkPipeline, vkDestroyPipeline>;
using OwnedPipelineLayout = Owned<VkPipelineLayout, vkDestroyPipelineLayout>;
using OwnedQueryPool = Owned<VkQueryPool, vkDestroyQueryPool>;
using OwnedRenderPass = Owned<VkRenderPass, vkDestroyRenderPass>;
using OwnedShaderModule = Owned<VkShaderModule, vkDestroyShaderModule>;

// Throws Error{internal} unless the call succeeded. The message names the call and the result, and a remedy
// if there is one.
void check(VkResult result, std::string_view what);

// The messages of the validation layers, which may come from any thread.
struct ValidationLog {
  std::mutex mutex;
  std::function<void(const std::string&)> on_message;
  std::vector<std::string> messages;
};

class Context {
 public:
  // Throws Error{bad_argument} that names the available devices if none of them fits `options`.
  explicit Context(const DeviceOptions& options);
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  [[nodiscard]] VkDevice device() const { return device_.handle; }
  [[nodiscard]] const DeviceInfo& info() const { return info_; }
  [[nodiscard]] VkPipelineLayout pipeline_layout() const { return pipeline_layout_.get(); }
  [[nodiscard]] const VkPhysicalDeviceMemoryProperties& memory() const { return memory_; }
  [[nodiscard]] PFN_vkCmdPushDescriptorSetKHR push_descriptors() const { return push_descriptors_; }
  // Only available with DeviceInfo::conditional.
  [[nodiscard]] PFN_vkCmdBeginConditionalRenderingEXT begin_conditional() const { return begin_conditional_; }
  [[nodiscard]] PFN_vkCmdEndConditionalRenderingEXT end_conditional() const { return end_conditional_; }
  [[nodiscard]] double nanoseconds_per_tick() const { return nanoseconds_per_tick_; }

  // Make a call that may fail. All such calls go through one of these, so that tests can let them fail
  // (DeviceOptions::fault). call() throws as check() does. Nothing is attempted after the device was lost.
  VkResult attempt(std::string_view what, const std::function<VkResult()>& make);
  void call(std::string_view what, const std::function<VkResult()>& make);
  [[nodiscard]] bool lost() const { return lost_; }
  // Makes a layout with set 0 and the push constants of all shaders, and optionally a set 1.
  OwnedPipelineLayout make_pipeline_layout(VkDescriptorSetLayout set_1 = VK_NULL_HANDLE);

  // Records commands, submits them and waits for them. Throws Error{internal} if the device is lost.
  void submit(const std::function<void(VkCommandBuffer)>& record);

  [[nodiscard]] std::vector<std::string> validation_messages() const;

 private:
  // Members are destroyed in reverse order, so objects of a device are destroyed before the device.
  struct OwnedInstance {
    VkInstance handle = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
    OwnedInstance() = default;
    OwnedInstance(const OwnedInstance&) = delete;
    OwnedInstance& operator=(const OwnedInstance&) = delete;
    ~OwnedInstance();
  };
  struct OwnedDevice {
    VkDevice handle = VK_NULL_HANDLE;
    OwnedDevice() = default;
    OwnedDevice(const OwnedDevice&) = delete;
    OwnedDevice& operator=(const OwnedDevice&) = delete;
    ~OwnedDevice();
  };

  void create_instance(bool validate);
  void choose_device(const DeviceOptions& options);
  void read_info(std::uint64_t most_buffer_bytes);
  void read_features();
  void create_device();
  void create_layouts();

  std::function<int(std::string_view)> fault_;
  bool lost_ = false;
  std::unique_ptr<ValidationLog> log_;
  OwnedInstance instance_;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkPhysicalDeviceMemoryProperties memory_{};
  bool integers64_ = false;  // shaders have 64-bit integers
  DeviceInfo info_;
  double nanoseconds_per_tick_ = 1;
  std::uint32_t queue_family_ = 0;
  OwnedDevice device_;
  VkQueue queue_ = VK_NULL_HANDLE;
  PFN_vkCmdPushDescriptorSetKHR push_descriptors_ = nullptr;
  PFN_vkCmdBeginConditionalRenderingEXT begin_conditional_ = nullptr;
  PFN_vkCmdEndConditionalRenderingEXT end_conditional_ = nullptr;
  OwnedCommandPool commands_;
  OwnedDescriptorSetLayout set_layout_;
  OwnedPipelineLayout pipeline_layout_;
};

// Slots of the one descriptor set that all shaders share (shaders/frame.glsl): storage buffers come first,
// then images.
constexpr std::uint32_t kFirstImageSlot = 20;
constexpr std::uint32_t kSlots = 24;
// The number of bytes of push constants.
constexpr std::uint32_t kPushBytes = 32;

}  // namespace pellucid::render
