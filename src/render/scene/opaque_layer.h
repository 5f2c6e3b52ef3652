// opaque_layer.h - draws opaque surfaces before anything is captured. Surfaces behind them do not count as
// fragments, and their colours show through the fragments that remain. Shaders: scene/opaque.glsl.
#pragma once

#include "render/frame.h"
#include "render/options.h"

namespace pellucid::render {

class OpaqueLayer {
 public:
  // Returns whether there is something to draw before the effect can be captured.
  static bool needed(const Frame& frame) { return blends(frame.options.effect) && frame.scene.has_opaque(); }
  // If there is nothing to draw, makes an image of a single pixel, which no shader reads.
  explicit OpaqueLayer(const Frame& frame);
  void draw(const Frame& frame, Recorder& recorder) const;
  [[nodiscard]] const Image& nearest() const { return nearest_; }

 private:
  Image nearest_, depth_;
};

}  // namespace pellucid::render
