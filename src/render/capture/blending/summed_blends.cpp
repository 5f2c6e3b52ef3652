// Blending by sums instead of an order. Each fragment adds its weighted colour to the sums of its pixel, and
// the image shows the weighted mean. The techniques differ in the weights.
#include <algorithm>

#include "render/capture/registry.h"

namespace pellucid::render {
namespace {

// Sums of weighted colours and opacities, in half floats as published.
constexpr VkFormat kColorSums = VK_FORMAT_R16G16B16A16_SFLOAT;
// Sums of optical depths. They give the exact transmittance of all fragments together.
constexpr VkFormat kDepthSums = VK_FORMAT_R32_SFLOAT;

// Draws one geometry pass that adds the outputs of `fragment_shader` to `targets`, which start with 0.
void draw_sums(const Frame& frame, Recorder& recorder, std::string_view fragment_shader,
               const Constants& constants, const std::vector<const Image*>& targets) {
  std::vector<VkFormat> formats;
  for (const Image* target : targets) {
    recorder.prepare(*target);
    formats.push_back(target->spec().format);
  }
  Attachments attachments = frame.attachments();
  attachments.colors = targets;
  recorder.draw(frame.scene,
                frame.pipelines.scene({.fragment_shader = fragment_shader,
                                       .constants = constants,
                                       .colors = formats,
                                       .blend = Blend::add}),
                attachments);
  recorder.barrier();
}

// Turns the sums into the final colours.
void resolve_sums(const Frame& frame, Recorder& recorder, const Image& colors, const Image& depths) {
  recorder.begin_resolve();
  recorder.bind(Slot::image_0, colors);
  recorder.bind(Slot::image_1, depths);
  recorder.dispatch(frame.pipelines.compute("capture/blending/fold_sums.comp", {}), frame.tiles_x(),
                    frame.tiles_y());
}

// Weighted blended transparency: adds up colours with weights that fall with depth, in one pass. Based on:
// McGuire, Bavoil, "Weighted Blended Order-Independent Transparency", JCGT 2013.
class WeightedBlend final : public Technique {
 public:
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override { return 8 * frame.pixels(); }
  void allocate(Frame& frame) override {
    colors_ = frame.make_image("weighted colours", kColorSums);
    depths_ = frame.make_image("optical depths", kDepthSums);
  }
  void start(Frame& frame, Recorder& recorder) override {
    draw_sums(frame, recorder, "capture/blending/weighted.frag", {frame.effect}, {&colors_, &depths_});
    resolve_sums(frame, recorder, colors_, depths_);
  }

 private:
  Image colors_, depths_;
};

// Moment-based transparency: weights the colour of each fragment by an estimate of the light that reaches it.
// The estimate comes from four power moments of optical depth over depth. Based on: Muenstermann, Krumpen,
// Klein, Peters, "Moment-Based Order-Independent Transparency", I3D 2018; see
// shaders/capture/blending/moments.frag.
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
    draw_sums(frame, recorder, "capture/blending/moments_sums.frag", {frame.effect}, {&moments_, &depths_});
    recorder.bind(Slot::image_1, depths_);
    recorder.bind(Slot::image_2, moments_);
    draw_sums(frame, recorder, "capture/blending/moments_colors.frag", {frame.effect}, {&colors_});
    resolve_sums(frame, recorder, colors_, depths_);
  }

 private:
  Image moments_, depths_, colors_;
};

// Stochastic transparency: a pixel has k samples. A fragment covers a share of them that equals its opacity,
// chosen at random, and each sample keeps the depth of its nearest fragment. On average, the share of samples
// that do not hide a fragment is the light that reaches it. The samples are words of a buffer. The samples of
// a multisampled attachment have different positions, which would spoil edges. Based on: Enderton, Sintorn,
// Shirley, Luebke, "Stochastic Transparency", I3D 2010, with the alpha correction of the paper.
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
    frame.gather(recorder, "capture/blending/stochastic_depths.frag", constants);
    recorder.barrier();
    draw_sums(frame, recorder, "capture/blending/stochastic_colors.frag", constants, {&colors_, &depths_});
    resolve_sums(frame, recorder, colors_, depths_);
  }

 private:
  Buffer samples_;
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

TechniqueEntry moment_blend() {
  return {{.name = "mboit4",
           .title = "light transmittance in front of a fragment, from four moments of depth",
           .paper = "Muenstermann et al. 2018",
           .exact = false,
           .captures = "all, by an estimate of the light that gets to them; transmittance of all is exact",
           .passes_formula = "2",
           .bytes_formula = "28",
           .blends_only = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<MomentBlend>()); }};
}

TechniqueEntry stochastic_blend() {
  return {{.name = "stochastic",
           .title = "k random samples of a pixel, each with its nearest fragment",
           .paper = "Enderton et al. 2010",
           .exact = false,
           .captures = "all, by a random share of the light that gets to them; transmittance of all is exact",
           .passes_formula = "2",
           .bytes_formula = "4 K + 12",
           .groups = {OptionGroup::k},
           .blends_only = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<StochasticBlend>()); }};
}

}  // namespace pellucid::render
