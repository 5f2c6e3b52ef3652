// Multi-layer alpha blending: a pixel has four nodes for its nearest layers, and the farthest node also takes
// what has no place. A late fragment may find that the fragments around it have been merged already. The
// result therefore depends on the draw order, and only attachments that are read back in draw order make it
// the same each time. Based on: Salvi, Vaidyanathan, "Multi-Layer Alpha Blending", I3D 2014.
#include "render/capture/registry.h"
#include "render/device/ordered_attachments.h"

namespace pellucid::render {
namespace {

constexpr std::uint32_t kLayerNodes = 4;

class MultiLayerBlend final : public Technique {
 public:
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return 16 * frame.pixels();
  }
  void allocate(Frame& frame) override {
    layers_ = frame.make_image("layer nodes", kOrderedFormat, kNodeAttachments, ImageUse::read_back);
    target_ = OrderedTarget(frame.context, frame.pipelines.ordered(kNodeAttachments), layers_);
  }
  void start(Frame& frame, Recorder& recorder) override {
    const Constants constants{frame.effect, kLayerNodes};
    frame.gather_in_order(recorder, "capture/blending/layer_nodes.frag", constants, layers_, target_);
    recorder.barrier();
    recorder.begin_resolve();
    recorder.dispatch(frame.pipelines.compute("capture/blending/fold_layer_nodes.comp", constants),
                      frame.tiles_x(), frame.tiles_y());
  }

 private:
  static constexpr std::uint32_t kNodeAttachments = ordered_attachments_for(kLayerNodes);

  Image layers_;
  OrderedTarget target_;
};

}  // namespace

TechniqueEntry multi_layer_blend() {
  return {{.name = "mlab4",
           .title = "four layers, the farthest merged in draw order",
           .paper = "Salvi, Vaidyanathan 2014",
           .exact = false,
           .order_free = false,
           .captures = "all, in four layers: right up to four fragments, then by the draw order",
           .passes_formula = "1",
           .bytes_formula = "48",
           .blends_only = true,
           .needs_ordered = ordered_attachments_for(kLayerNodes)},
          [] { return std::unique_ptr<Technique>(std::make_unique<MultiLayerBlend>()); }};
}

}  // namespace pellucid::render
