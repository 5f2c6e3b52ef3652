// list_resolve.h - sorts and folds the lists of fragments that a technique stored. It works by tiles of 8 x 8
// pixels with similar list lengths. Lists go in, the final colours of the image come out.
#pragma once

#include <string>

#include "render/frame.h"

namespace pellucid::render {

class ListResolve {
 public:
  // `storage` is "ranges", "lists", "arrays" or "layers" (shaders/resolve/storage.glsl).
  explicit ListResolve(std::string storage) : storage_(std::move(storage)) {}
  void allocate(Frame& frame);
  [[nodiscard]] static std::uint64_t bytes(const Frame& frame);
  // Returns whether the driver ends the loops over the longest list before all of it is sorted.
  [[nodiscard]] static bool ends_early(const Frame& frame);
  // Sorts and folds all pixels. Slots a, b and c hold the storage, and `k` is its constant kK.
  void record(Frame& frame, Recorder& recorder, std::uint32_t k) const {
    record(frame, recorder, k, nullptr);
  }
  // Does the same only in the tiles of this list (shaders/resolve/marked_tiles.glsl), which is bound to slot
  // d. Pixels without fragments keep their colour.
  void repair(Frame& frame, Recorder& recorder, const Buffer& marked_tiles) const {
    record(frame, recorder, 0, &marked_tiles);
  }

 private:
  void record(Frame& frame, Recorder& recorder, std::uint32_t k, const Buffer* marked_tiles) const;

  std::string storage_;
  Buffer tiles_;
};

}  // namespace pellucid::render
