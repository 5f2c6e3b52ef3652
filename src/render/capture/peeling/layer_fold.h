// layer_fold.h - stores the fragments that a round of peeling finds in the current layer of every pixel, and
// folds them into the state of the pixel. All peeling techniques share it. They differ in how they find
// layers.
//
// Depths are only compared with depths of the same origin: gl_FragCoord.z with what the depth test left, or,
// without the depth test, the bits of gl_FragCoord.z with such bits in a buffer. Whether a pixel has a
// further layer is decided by what a round delivered, never by a depth, because 1 is a valid depth.
#pragma once

#include <string>

#include "render/frame.h"

namespace pellucid::render {

// What is stored of a layer: shaders/capture/peeling/layers.glsl.
enum class LayerStorage {
  image,   // one fragment, in an attachment of the technique
  pairs,   // the smallest and the largest id
  lists,   // all fragments
  arrays,  // the k fragments that are drawn first
  chains   // the k smallest ids; at the far end, the k largest
};

class LayerFold {
 public:
  struct Form {
    LayerStorage storage = LayerStorage::image;
    bool search = false;      // layers are found without the depth test
    std::uint32_t sides = 1;  // 2: peels from the far end, too; needs `search`
    bool resumes = true;      // chains: the next round continues with a layer of more than k fragments
  };
  explicit LayerFold(const Form& form) : form_(form) {}

  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const;
  void allocate(Frame& frame);
  // Empties all storage, before the first round.
  void clear(Recorder& recorder) const;
  // Begins a round: binds the buffers that its passes store to.
  void begin_round(Frame& frame, Recorder& recorder, std::uint32_t round) const;
  // Returns the constants of the geometry passes. For LayerStorage::pairs, pass 0 takes ids and pass 1 takes
  // colours.
  [[nodiscard]] Constants constants(const Frame& frame, std::uint32_t pass = 0) const;
  // Returns the suffix of the shaders for this form, such as "pairs_2".
  [[nodiscard]] std::string shader_suffix() const;
  void fold(Frame& frame, Recorder& recorder) const;
  // Writes the image after the last round.
  void finish(Frame& frame, Recorder& recorder) const;

 private:
  void bind(Recorder& recorder) const;
  [[nodiscard]] std::uint64_t storage_bytes(const Frame& frame) const;

  Form form_;
  Buffer depths_, heads_, nodes_, coplanar_;
  Buffer front_, front_group_, back_, back_group_;
};

}  // namespace pellucid::render
