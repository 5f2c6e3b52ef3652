// Moment-based transparency: four power moments of optical depth over depth tell how much light gets to each
// fragment, well enough to weight its colour. Muenstermann, Krumpen, Klein, Peters, "Moment-Based
// Order-Independent Transparency", I3D 2018; shaders/capture/moments.glsl.
#include "render/capture/blending_techniques.h"
#include "render/capture/color_sums.h"

namespace pellucid::render {
namespace {

constexpr VkFormat kMoments = VK_FORMAT_R32G32B32A32_SFLOAT;

class MomentBlend final : public Technique {
 public:
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return 16 * frame.pixels();
  }
  void allocate(Frame& frame) override {
    moments_ = frame.make_image("moments", kMoments);
    depths_ = frame.make_image("optical depths", kDepthSums);
    colors_ = frame.make_image("colours by light", kColorSums);
  }
  void start(Frame& frame, Recorder& recorder) override {
    draw_sums(frame, recorder, "capture/moments.frag", {frame.effect}, {&moments_, &depths_});
    recorder.bind(Slot::image_1, depths_);
    recorder.bind(Slot::image_2, moments_);
    draw_sums(frame, recorder, "capture/moment_colors.frag", {frame.effect}, {&colors_});
    resolve_sums(frame, recorder, colors_, depths_);
  }

 private:
  Image moments_, depths_, colors_;
};

}  // namespace

TechniqueEntry moment_blend() {
  return {{.name = "mboit4",
           .title = "light that gets to a fragment, from four moments of depth",
           .paper = "Muenstermann et al. 2018",
           .exact = false,
           .captures = "all, by an estimate of the light that gets to them; transmittance of all is exact",
           .passes_formula = "2",
           .bytes_formula = "28",
           .blends_only = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<MomentBlend>()); }};
}

}  // namespace pellucid::render
