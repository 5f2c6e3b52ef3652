// list_resolve.h - sort and fold what a buffer technique stored, by tiles of equal list length.
#pragma once

#include <string>

#include "render/frame.h"

namespace pellucid::render {

class ListResolve {
 public:
  // `storage`: "ranges", "lists" or "arrays" (shaders/resolve/storage.glsl).
  explicit ListResolve(std::string storage) : storage_(std::move(storage)) {}
  void allocate(Frame& frame);
  [[nodiscard]] static std::uint64_t bytes(const Frame& frame);
  // Does a driver end the loops over the longest list before all of it is sorted?
  [[nodiscard]] static bool ends_early(const Frame& frame);
  // Slots a, b, c hold the storage; `k` is its constant kK.
  void record(Frame& frame, Recorder& recorder, std::uint32_t k) const {
    record(frame, recorder, k, nullptr);
  }
  // Only of the tiles listed there (shaders/resolve/marked_tiles.glsl), bound to slot d; pixels without
  // fragments keep what the image has there.
  void repair(Frame& frame, Recorder& recorder, const Buffer& marked_tiles) const {
    record(frame, recorder, 0, &marked_tiles);
  }

 private:
  void record(Frame& frame, Recorder& recorder, std::uint32_t k, const Buffer* marked_tiles) const;

  std::string storage_;
  Buffer tiles_;
};

}  // namespace pellucid::render
