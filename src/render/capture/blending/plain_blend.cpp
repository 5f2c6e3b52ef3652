// Hardware blending in draw order. It is the baseline of all capture techniques. Its image is right where the
// draw order runs from front to back in every pixel.
#include "render/capture/registry.h"

namespace pellucid::render {
namespace {

class PlainBlend final : public Technique {
 public:
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return 16 * frame.pixels();
  }
  void allocate(Frame& frame) override { blended_ = frame.make_image("blended colours", kBlended); }
  void start(Frame& frame, Recorder& recorder) override {
    recorder.prepare(blended_);
    Attachments attachments = frame.attachments();
    attachments.colors = {&blended_};
    recorder.draw(frame.scene,
                  frame.pipelines.scene({.fragment_shader = "capture/blending/blend.frag",
                                         .constants = {frame.effect},
                                         .colors = {kBlended},
                                         .blend = Blend::under}),
                  attachments);
    recorder.barrier();
    recorder.begin_resolve();
    recorder.bind(Slot::image_0, blended_);
    recorder.dispatch(frame.pipelines.compute("capture/blending/finish_blended.comp", {}), frame.tiles_x(),
                      frame.tiles_y());
  }

 private:
  Image blended_;
};

}  // namespace

TechniqueEntry plain_blend() {
  return {{.name = "blend",
           .title = "hardware blending in draw order, the first in front",
           .paper = "Porter, Duff 1984",
           .exact = false,
           .order_free = false,
           .captures = "all, but in draw order",
           .passes_formula = "1",
           .bytes_formula = "16",
           .blends_only = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<PlainBlend>()); }};
}

}  // namespace pellucid::render
