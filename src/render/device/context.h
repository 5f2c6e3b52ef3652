// context.h - the Vulkan instance, one device and one queue, without a window; validated on demand.
//
// A GPU is taken where there is one, else a driver that runs on the CPU. Everything is submitted through
// `submit`, which waits: one command buffer per piece of work, so that synchronisation validation sees all of
// its hazards.
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

// ---- Owners of Vulkan objects: destroyed in the reverse order of their making, on every path.

// A child of a device. `Destroy` is the vkDestroy* or vkFree* of its type.
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

// Throw Error{internal} that names the call and the result, with a remedy where there is one.
void check(VkResult result, std::string_view what);

// What validation layers said; filled from any thread.
struct ValidationLog {
  std::mutex mutex;
  std::function<void(const std::string&)> on_message;
  std::vector<std::string> messages;
};

class Context {
 public:
  // Throws Error{bad_argument} where no device fits `options`, and names the devices that are there.
  explicit Context(const DeviceOptions& options);
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  [[nodiscard]] VkDevice device() const { return device_.handle; }
  [[nodiscard]] const DeviceInfo& info() const { return info_; }
  [[nodiscard]] VkPipelineLayout pipeline_layout() const { return pipeline_layout_.get(); }
  [[nodiscard]] const VkPhysicalDeviceMemoryProperties& memory() const { return memory_; }
  [[nodiscard]] PFN_vkCmdPushDescriptorSetKHR push_descriptors() const { return push_descriptors_; }
  // Only with DeviceInfo::conditional.
  [[nodiscard]] PFN_vkCmdBeginConditionalRenderingEXT begin_conditional() const { return begin_conditional_; }
  [[nodiscard]] PFN_vkCmdEndConditionalRenderingEXT end_conditional() const { return end_conditional_; }
  [[nodiscard]] double nanoseconds_per_tick() const { return nanoseconds_per_tick_; }

  // Every call that may fail goes through one of these, so that tests can let it fail
  // (DeviceOptions::fault); call() throws as check() does. Nothing is attempted once the device was lost.
  VkResult attempt(std::string_view what, const std::function<VkResult()>& make);
  void call(std::string_view what, const std::function<VkResult()>& make);
  [[nodiscard]] bool lost() const { return lost_; }
  // Set 0 and push constants of all shaders, and perhaps a set 1.
  OwnedPipelineLayout make_pipeline_layout(VkDescriptorSetLayout set_1 = VK_NULL_HANDLE);

  // Record, run and wait. Throws Error{internal} on device loss.
  void submit(const std::function<void(VkCommandBuffer)>& record);

  [[nodiscard]] std::vector<std::string> validation_messages() const;

 private:
  // Members are destroyed in reverse: what was made of a device goes before it.
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
  bool integers64_ = false;  // in shaders
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

// The one descriptor set that all shaders share (shaders/frame.glsl): storage buffers, then images.
constexpr std::uint32_t kFirstImageSlot = 20;
constexpr std::uint32_t kSlots = 24;
// Bytes of push constants.
constexpr std::uint32_t kPushBytes = 32;

}  // namespace pellucid::render
