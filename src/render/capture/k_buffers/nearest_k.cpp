// Keeps the k nearest fragments of every pixel (KB).
//
// Fragments of a pixel are kept apart in one of three ways (Sync). In ordered attachments and in critical
// sections each fragment is inserted completely, in one geometry pass. Chains of 64-bit atomic minima over
// keys (depth, id) need neither; a second pass then stores the colours of the fragments that were kept.
// buffers/nearest_rounds.cpp does the same in several rounds.
//
// Based on: Bavoil et al., "Multi-Fragment Effects on the GPU using the k-Buffer", I3D 2007. Differs in: the
// result of the paper depends on timing, this one does not.
#include <fmt/format.h>

#include "render/capture/registry.h"
#include "render/device/ordered_attachments.h"

namespace pellucid::render {
namespace {

class NearestK final : public Technique {
 public:
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    if (frame.sync == Sync::ordered) return 16 * frame.pixels();  // one layer of the image
    return (frame.sync == Sync::interlock ? 12 : 8) * frame.options.k * frame.pixels();
  }

  void allocate(Frame& frame) override {
    const std::uint64_t slots = frame.options.k * frame.pixels();
    if (frame.sync == Sync::ordered) {
      const std::uint32_t attachments = ordered_attachments_for(frame.options.k);
      layers_ = frame.make_image("fragment layers", kOrderedFormat, attachments, ImageUse::read_back);
      target_ = OrderedTarget(frame.context, frame.pipelines.ordered(attachments), layers_);
    } else if (frame.sync == Sync::interlock) {
      slots_ = frame.make_buffer("fragment slots", 12 * slots);
    } else {
      slots_ = frame.make_buffer("fragment keys", 8 * slots);
      colors_ = frame.make_buffer("fragment colours", 4 * slots);
    }
  }

  void start(Frame& frame, Recorder& recorder) override {
    const Constants constants{frame.effect, frame.options.k};
    if (slots_) {
      recorder.bind(Slot::a, slots_);
      recorder.fill(slots_, 0xFFFFFFFFU);
    }
    if (frame.sync == Sync::ordered) {
      insert_in_order(frame, recorder, constants);
      resolve(frame, recorder, "resolve/keys_layers.comp", constants);
    } else if (frame.sync == Sync::interlock) {
      recorder.barrier();
      frame.gather(recorder, "capture/k_buffers/interlock_slots.frag", constants);
      resolve(frame, recorder, "resolve/keys_words.comp", constants);
    } else {
      recorder.bind(Slot::c, colors_);
      recorder.barrier();
      frame.gather(recorder, "capture/k_buffers/nearest_keys.frag", constants);
      recorder.barrier();
      frame.gather(recorder, "capture/k_buffers/nearest_colors.frag", constants);
      resolve(frame, recorder, "resolve/keys.comp", constants);
    }
  }

 private:
  void insert_in_order(Frame& frame, Recorder& recorder, const Constants& constants) const {
    const std::string shader =
        fmt::format("capture/k_buffers/ordered_slots_{}.frag", target_.layout().attachments());
    frame.gather_in_order(recorder, shader, constants, layers_, target_);
  }
  static void resolve(const Frame& frame, Recorder& recorder, std::string_view shader,
                      const Constants& constants) {
    recorder.barrier();
    recorder.begin_resolve();
    recorder.dispatch(frame.pipelines.compute(shader, constants), frame.tiles_x(), frame.tiles_y());
  }

  Buffer slots_, colors_;
  Image layers_;
  OrderedTarget target_;
};

}  // namespace

TechniqueEntry k_buffer() {
  return {{.name = "kb",
           .title = "the k nearest fragments of every pixel",
           .paper = "Bavoil et al. 2007",
           .exact = false,
           .captures = "the k nearest of a pixel",
           .passes_formula = "1 or 2",
           .bytes_formula = "12 K",
           .groups = {OptionGroup::k, OptionGroup::sync},
           .syncs = {Sync::ordered, Sync::interlock, Sync::atomics}},
          [] { return std::unique_ptr<Technique>(std::make_unique<NearestK>()); }};
}

}  // namespace pellucid::render
