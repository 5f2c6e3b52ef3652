// opaque_layer.h - what is opaque, drawn before anything is captured: what lies behind it is no fragment, and
// its colour is what is seen through those that remain. Shaders: interface/opaque.glsl.
#pragma once

#include "render/frame.h"
#include "render/options.h"

namespace pellucid::render {

class OpaqueLayer {
 public:
  // Is there something to draw before the effect can be captured?
  static bool needed(const Frame& frame) { return blends(frame.options.effect) && frame.scene.has_opaque(); }
  // With nothing to draw it is an image of a single pixel, which no shader looks at.
  explicit OpaqueLayer(const Frame& frame);
  void draw(const Frame& frame, Recorder& recorder) const;
  [[nodiscard]] const Image& nearest() const { return nearest_; }

 private:
  Image nearest_, depth_;
};

}  // namespace pellucid::render
