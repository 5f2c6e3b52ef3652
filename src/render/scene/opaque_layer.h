// opaque_layer.h - draws opaque surfaces before anything is captured. What lies behind them does not count as
// a fragment, and their colours are seen through those that remain. Shaders: scene/opaque.glsl.
#pragma once

#include "render/frame.h"
#include "render/options.h"

namespace pellucid::render {

class OpaqueLayer {
 public:
  // Returns whether there is something to draw before the effect can be captured.
  static bool needed(const Frame& frame) { return blends(frame.options.effect) && frame.scene.has_opaque(); }
  // With nothing to draw, makes an image of a single pixel, which no shader reads.
  explicit OpaqueLayer(const Frame& frame);
  void draw(const Frame& frame, Recorder& recorder) const;
  [[nodiscard]] const Image& nearest() const { return nearest_; }

 private:
  Image nearest_, depth_;
};

}  // namespace pellucid::render
