// Weighted blended transparency: colours are added up with weights that fall with depth, in one pass.
// McGuire, Bavoil, "Weighted Blended Order-Independent Transparency", JCGT 2013.
#include "render/capture/blending_techniques.h"
#include "render/capture/color_sums.h"

namespace pellucid::render {
namespace {

class WeightedBlend final : public Technique {
 public:
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override { return 8 * frame.pixels(); }
  void allocate(Frame& frame) override {
    colors_ = frame.make_image("weighted colours", kColorSums);
    depths_ = frame.make_image("optical depths", kDepthSums);
  }
  void start(Frame& frame, Recorder& recorder) override {
    draw_sums(frame, recorder, "capture/weighted.frag", {frame.effect}, {&colors_, &depths_});
    resolve_sums(frame, recorder, colors_, depths_);
  }

 private:
  Image colors_, depths_;
};

}  // namespace

TechniqueEntry weighted_blend() {
  return {{.name = "wboit",
           .title = "sums of colours, the nearer the heavier, in place of an order",
           .paper = "McGuire, Bavoil 2013",
           .exact = false,
           .captures = "all, as their mean by a weight of depth; transmittance of all is exact",
           .passes_formula = "1",
           .bytes_formula = "12",
           .blends_only = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<WeightedBlend>()); }};
}

}  // namespace pellucid::render
