// memory.h - buffers and images with their own memory, and copies of data to and from them.
//
// There is one allocation per object, because a frame has only a few dozen. Every error names the object.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/device/context.h"

namespace pellucid::render {

enum class MemoryKind {
  device,   // fastest for the device; the host reads and writes by copies
  readback  // mapped: the host reads it directly
};

class Buffer {
 public:
  Buffer() = default;
  // `name` appears in errors ("fragment pool"). Usage for storage, transfer, vertices and indices is allowed.
  // Throws Error{bad_argument} for more bytes than a shader can address, and Error{internal} if memory is
  // exhausted.
  Buffer(Context& context, const std::string& name, std::uint64_t bytes,
         MemoryKind kind = MemoryKind::device);
  [[nodiscard]] VkBuffer get() const { return buffer_.get(); }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  explicit operator bool() const { return static_cast<bool>(buffer_); }

  // Copy data to the buffer and from it. Both wait for the device.
  void upload(Context& context, std::span<const std::byte> data) const;
  void download(Context& context, std::span<std::byte> data, std::uint64_t offset = 0) const;

 private:
  OwnedMemory memory_;
  OwnedBuffer buffer_;
  std::uint64_t bytes_ = 0;
  void* mapped_ = nullptr;
};

template <class T>
void upload(Context& context, const Buffer& buffer, std::span<const T> values) {
  buffer.upload(context, std::as_bytes(values));
}

template <class T>
Buffer make_filled(Context& context, const std::string& name, const std::vector<T>& values) {
  Buffer buffer(context, name, values.size() * sizeof(T));
  upload<T>(context, buffer, values);
  return buffer;
}

enum class ImageUse {
  attachment,  // written as an attachment, and read by shaders afterwards
  read_back    // also read by the fragment shaders that write it
};

struct ImageSpec {
  VkFormat format = VK_FORMAT_R32_SFLOAT;
  std::uint32_t width = 0, height = 0, layers = 1;
  ImageUse use = ImageUse::attachment;
  [[nodiscard]] bool depth() const {
    return format == VK_FORMAT_D32_SFLOAT || format == VK_FORMAT_D32_SFLOAT_S8_UINT;
  }
};

// An attachment that shaders read by texelFetch. Its layout is GENERAL after its first use.
class Image {
 public:
  Image() = default;
  Image(Context& context, const std::string& name, const ImageSpec& spec);
  // Returns the bytes that an image would take. Devices may round up.
  static std::uint64_t bytes_needed(const Context& context, const ImageSpec& spec);
  [[nodiscard]] VkImage get() const { return image_.get(); }
  [[nodiscard]] VkImageView view() const { return view_.get(); }             // all layers, as an attachment
  [[nodiscard]] VkImageView sampled_view() const { return sampled_.get(); }  // for shaders, without stencil
  [[nodiscard]] VkImageView stencil_view() const { return stencil_.get(); }  // for shaders, stencil only
  [[nodiscard]] const ImageSpec& spec() const { return spec_; }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  explicit operator bool() const { return static_cast<bool>(image_); }

 private:
  ImageSpec spec_;
  OwnedMemory memory_;
  OwnedImage image_;
  OwnedImageView view_, sampled_, stencil_;
  std::uint64_t bytes_ = 0;
};

}  // namespace pellucid::render
