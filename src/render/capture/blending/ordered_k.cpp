// The ordered k-buffer: blends in draw order through a sorted window of k fragments. In-depth orders make the
// draw order nearly right, and the window corrects most of the rest.
//
// When the window is full, its nearest fragment leaves it and is blended under those that left before. A
// fragment that comes after at most k farther ones is therefore still blended in its place. This takes one
// geometry pass and a number of bytes that does not depend on the scene. A fragment that comes even later is
// blended where it comes, and its pixel is marked. If no pixel is marked, the image is exact.
#include <fmt/format.h>

#include "render/capture/registry.h"
#include "render/device/ordered_attachments.h"

namespace pellucid::render {
namespace {

// Words of a slot of the window, and words that are kept beside the window
// (shaders/capture/blending/ordered_window.glsl).
constexpr std::uint32_t kSlotWords = 3;
constexpr std::uint32_t kBlendedWords = 7;

constexpr std::uint32_t window_attachments_for(std::uint32_t k) {
  return (kSlotWords * k + kBlendedWords + 3) / 4;
}

class OrderedK final : public Technique {
 public:
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return 16 * frame.pixels();  // one layer of the image
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
           .title = "blending in draw order, corrected within a window of k fragments",
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
