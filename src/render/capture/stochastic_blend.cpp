// Stochastic transparency: as many of a pixel's k samples as a fragment's opacity says are hidden by it,
// chosen at random, and a sample keeps the depth of its nearest fragment. The share of samples that do not
// hide a fragment is the light that gets to it, on average. Samples are words, not those of an attachment,
// whose places would spoil edges. Enderton, Sintorn, Shirley, Luebke, "Stochastic Transparency", I3D 2010,
// with the paper's alpha correction.
#include "render/capture/blending_techniques.h"
#include "render/capture/color_sums.h"

namespace pellucid::render {
namespace {

class StochasticBlend final : public Technique {
 public:
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return std::max<std::uint64_t>(4 * std::uint64_t{frame.options.k}, 8) * frame.pixels();
  }
  void allocate(Frame& frame) override {
    samples_ = frame.make_buffer("depths of samples", 4 * std::uint64_t{frame.options.k} * frame.pixels());
    colors_ = frame.make_image("colours by light", kColorSums);
    depths_ = frame.make_image("optical depths", kDepthSums);
  }
  void start(Frame& frame, Recorder& recorder) override {
    const Constants constants{frame.effect, frame.options.k};
    recorder.bind(Slot::a, samples_);
    recorder.fill(samples_, 0xFFFFFFFFU);
    recorder.barrier();
    frame.gather(recorder, "capture/sample_depths.frag", constants);
    recorder.barrier();
    draw_sums(frame, recorder, "capture/sample_colors.frag", constants, {&colors_, &depths_});
    resolve_sums(frame, recorder, colors_, depths_);
  }

 private:
  Buffer samples_;
  Image colors_, depths_;
};

}  // namespace

TechniqueEntry stochastic_blend() {
  return {{.name = "stochastic",
           .title = "k random samples of a pixel, each with its nearest fragment",
           .paper = "Enderton et al. 2010",
           .exact = false,
           .captures = "all, by a random share of the light that gets to them; transmittance of all is exact",
           .passes_formula = "2",
           .bytes_formula = "4 K + 12",
           .blends_only = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<StochasticBlend>()); }};
}

}  // namespace pellucid::render
