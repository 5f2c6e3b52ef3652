// layer_fold.h - stores what a round of peeling finds in the layer of every pixel, and folds it into the
// pixel's state. All techniques that peel share it; they differ in how they find layers.
//
// All compare depths that come the same way: what the depth test left with gl_FragCoord.z, or, without depth
// test, bits of gl_FragCoord.z with such bits in a buffer. A pixel without a further layer is known by what a
// round did not deliver, never by a depth: 1 is a depth like any other.
#pragma once

#include <string>

#include "render/frame.h"

namespace pellucid::render {

// shaders/capture/peeling/layers.glsl
enum class LayerStorage {
  image,   // one fragment, in an attachment of the technique's
  pairs,   // the smallest and the largest id
  lists,   // all
  arrays,  // the k drawn first
  chains   // the k of the smallest ids, at the far end of the largest
};

class LayerFold {
 public:
  struct Form {
    LayerStorage storage = LayerStorage::image;
    bool search = false;      // layers are found without depth test
    std::uint32_t sides = 1;  // 2: from the far end, too; needs `search`
    bool resumes = true;      // chains: the next round goes on with a layer of more than k
  };
  explicit LayerFold(const Form& form) : form_(form) {}

  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const;
  void allocate(Frame& frame);
  // Empties everything, once, before the first round.
  void clear(Recorder& recorder) const;
  // Begins a round: binds what its passes store to.
  void begin_round(Frame& frame, Recorder& recorder, std::uint32_t round) const;
  // Returns the constants of its geometry passes. For storage of pairs, `pass` 0 takes ids, 1 colours.
  [[nodiscard]] Constants constants(const Frame& frame, std::uint32_t pass = 0) const;
  // Returns the end of the names of shaders for this form: "pairs_2".
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
