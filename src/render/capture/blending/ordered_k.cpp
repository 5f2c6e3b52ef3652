// The ordered k-buffer: blending in draw order, which in-depth orders make nearly right, through
// a window of k fragments that are sorted. What leaves the window, the nearest, is blended under what left
// before, so a fragment may come after up to k farther ones and is blended in its place all the same: one
// geometry pass, in a number of bytes that does not depend on the scene. One that comes later still is
// blended where it is and marks its pixel: where none is marked, the image is exact.
#include <fmt/format.h>

#include "render/capture/registry.h"
#include "render/device/ordered_attachments.h"

namespace pellucid::render {
namespace {

// Words of a slot of the window, and of what is kept beside it: shaders/capture/blending/ordered_window.glsl.
constexpr std::uint32_t kSlotWords = 3;
constexpr std::uint32_t kBlendedWords = 7;

constexpr std::uint32_t window_attachments_for(std::uint32_t k) {
  return (kSlotWords * k + kBlendedWords + 3) / 4;
}

class OrderedK final : public Technique {
 public:
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return 16 * frame.pixels();  // a layer
  }
  void allocate(Frame& frame) override {
    const std::uint32_t attachments = window_attachments_for(frame.options.k);
    const DeviceInfo& device = frame.context.info();
    if (attachments > device.ordered_attachments) {
      throw Error(ErrorKind::bad_argument,
                  fmt::format("technique ordered-k needs {} attachments for k = {}, and {} has {}",
                              attachments, frame.options.k, device.name, device.ordered_attachments));
    }
    layers_ = frame.make_image("window layers", kOrderedFormat, attachments, ImageUse::read_back);
    target_ = OrderedTarget(frame.context, frame.pipelines.ordered(attachments), layers_);
  }
  void start(Frame& frame, Recorder& recorder) override {
    const Constants constants{frame.effect, frame.options.k};
    const std::string shader =
        fmt::format("capture/blending/ordered_window_{}.frag", target_.layout().attachments());
    frame.gather_in_order(recorder, shader, constants, layers_, target_);
    recorder.barrier();
    recorder.begin_resolve();
    recorder.dispatch(frame.pipelines.compute("capture/blending/fold_window.comp", constants),
                      frame.tiles_x(), frame.tiles_y());
  }

 private:
  Image layers_;
  OrderedTarget target_;
};

}  // namespace

TechniqueEntry ordered_k() {
  return {{.name = "ordered-k",
           .title = "blending in draw order, put right within a window of k fragments",
           .paper = "",
           .exact = false,
           .order_free = false,
           .captures = "all, in order where none comes after more than k farther ones; others are counted",
           .passes_formula = "1",
           .bytes_formula = "16 ceil((3 K + 7) / 4)",
           .groups = {OptionGroup::k},
           .blends_only = true,
           .needs_ordered = window_attachments_for(1)},
          [] { return std::unique_ptr<Technique>(std::make_unique<OrderedK>()); }};
}

}  // namespace pellucid::render
