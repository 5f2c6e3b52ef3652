// memory.h - buffers and images with memory of their own, and copies of data to them and from them.
//
// There is one allocation for each object, as a frame has a few dozen. Every failure names what was asked
// for.
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
  readback  // the host reads it where it lies
};

class Buffer {
 public:
  Buffer() = default;
  // `name` is what an error calls it ("fragment pool"). Storage, transfer, vertex and index use are allowed.
  // Throws Error{bad_argument} beyond what a shader can address, Error{internal} out of memory.
  Buffer(Context& context, const std::string& name, std::uint64_t bytes,
         MemoryKind kind = MemoryKind::device);
  [[nodiscard]] VkBuffer get() const { return buffer_.get(); }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  explicit operator bool() const { return static_cast<bool>(buffer_); }

  // Waits for the device.
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
  attachment,  // and to be read by shaders afterwards
  read_back    // by the fragment shaders that write it, too
};

struct ImageSpec {
  VkFormat format = VK_FORMAT_R32_SFLOAT;
  std::uint32_t width = 0, height = 0, layers = 1;
  ImageUse use = ImageUse::attachment;
  [[nodiscard]] bool depth() const {
    return format == VK_FORMAT_D32_SFLOAT || format == VK_FORMAT_D32_SFLOAT_S8_UINT;
  }
};

// An attachment that shaders read by texelFetch. Its layout is GENERAL from its first use on.
class Image {
 public:
  Image() = default;
  Image(Context& context, const std::string& name, const ImageSpec& spec);
  // What it would take: devices may round up.
  static std::uint64_t bytes_needed(const Context& context, const ImageSpec& spec);
  [[nodiscard]] VkImage get() const { return image_.get(); }
  [[nodiscard]] VkImageView view() const { return view_.get(); }             // all layers, as an attachment
  [[nodiscard]] VkImageView sampled_view() const { return sampled_.get(); }  // what shaders read: no stencil
  [[nodiscard]] VkImageView stencil_view() const { return stencil_.get(); }  // the same of it alone
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
