// The same number of slots for all pixels: the nearest k, and a tail. In one of three ways (Sync): a chain of
// 64-bit atomic minima over keys, then a pass for colours; chains of 32-bit minima, over depths and then over
// ids, for devices that have no others; or insertion into ordered attachments, in one pass.
// Maule, Comba, Torchelsen, Bastos, "Hybrid Transparency", I3D 2013; Vasilakis, Vardis, Papaioannou,
// Moustakas, "Variable k-buffer using Importance Maps", Eurographics 2017, where this is what the others are
// measured against.
#include <fmt/format.h>

#include "render/capture/k_buffers/tailed_buffer.h"
#include "render/capture/registry.h"
#include "render/device/ordered_attachments.h"

namespace pellucid::render {
namespace {

// What weighs the colours of a tail: optical depth, as a fine mixture would, or, as in the paper, opacity.
enum class TailWeight { optical_depth, opacity };

// Nothing is counted beforehand: sums in attachments are of 32 bits, for as many opaque fragments.
constexpr std::uint64_t kMostInAttachments = 65'535;

class FixedK final : public TailedBuffer {
 public:
  explicit FixedK(TailWeight weight) : weight_(weight) {}
  // With a k of its own, not what fits: then the image is cut into bands.
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return takes_k(frame) && frame.sync != Sync::ordered ? default_bytes(frame) : 0;
  }
  // Attachments have the number of slots that fits, however many fragments there are.
  [[nodiscard]] bool needs_counts(const Frame& frame) const override {
    return frame.sync != Sync::ordered || attachments_in(frame, bytes_given(frame)) == 0;
  }

 protected:
  [[nodiscard]] std::uint64_t default_bytes(const Frame& frame) const override {
    if (!takes_k(frame)) return TailedBuffer::default_bytes(frame);
    if (frame.sync != Sync::ordered) return kSlotBytes * (frame.options.k + tail_slots()) * frame.pixels();
    return image_bytes(frame, attachments_for(frame.options.k));
  }
  bool allocate_places(Frame& frame, const BudgetDemand& demand) override {
    if (frame.sync == Sync::ordered) return allocate_layers(frame, demand.bytes);
    const auto slots = static_cast<std::uint32_t>(uniform_slots(demand, tail_slots()));
    if (slots == 0) return false;
    k_ = slots - tail_slots();
    pool_ = frame.make_buffer("fragment pool", kSlotBytes * slots * frame.pixels());
    return true;
  }
  void record_places(Frame& frame, Recorder& recorder) override {
    if (frame.sync == Sync::ordered) return insert_in_order(frame, recorder);
    const Constants constants{frame.effect, 0, static_cast<std::uint32_t>(places())};
    recorder.push().p = {k_ + tail_slots(), tail_range(frame.deepest), 0, 0};
    clear_pool(recorder, pool_);
    if (frame.sync == Sync::atomics32) {
      for (const char* shader : {"capture/k_buffers/halves_depths.frag", "capture/k_buffers/halves_ids.frag",
                                 "capture/k_buffers/place_colors_halves.frag"})
        gather(frame, recorder, shader, constants);
    } else {
      for (const char* shader : {"capture/k_buffers/place_keys.frag", "capture/k_buffers/place_colors.frag"})
        gather(frame, recorder, shader, constants);
    }
    resolve(frame, recorder, "capture/k_buffers/fold_places.comp", constants);
  }
  [[nodiscard]] std::vector<std::uint32_t> keys(const Frame& frame) const override {
    return std::vector<std::uint32_t>(frame.pixels(), k_);
  }
  [[nodiscard]] std::vector<float> importance(const Frame& frame) const override {
    return std::vector<float>(frame.pixels(), 1);
  }

 private:
  // Without a budget, which says what fits.
  [[nodiscard]] bool takes_k(const Frame& frame) const {
    return by_opacity() && frame.options.budget.bytes == 0;
  }
  [[nodiscard]] std::uint64_t bytes_given(const Frame& frame) const {
    return frame.options.budget.bytes != 0 ? frame.options.budget.bytes : default_bytes(frame);
  }

  // Opacities are one sum more.
  [[nodiscard]] bool by_opacity() const { return weight_ == TailWeight::opacity; }
  [[nodiscard]] Places places() const { return by_opacity() ? Places::uniform_by_opacity : Places::uniform; }
  [[nodiscard]] std::uint32_t tail_slots() const { return by_opacity() ? 2 : 1; }
  // Words of a tail in attachments: shaders/capture/k_buffers/core_layers.glsl.
  [[nodiscard]] std::uint32_t tail_words() const { return by_opacity() ? 5 : 4; }
  [[nodiscard]] std::uint32_t attachments_for(std::uint32_t k) const {
    return (3 * k + tail_words() + 3) / 4;
  }
  static std::uint64_t image_bytes(const Frame& frame, std::uint32_t attachments) {
    return Image::bytes_needed(frame.context,
                               frame.image_spec(kOrderedFormat, attachments, ImageUse::read_back));
  }
  // The most that fit; 0: not even a tail.
  [[nodiscard]] std::uint32_t attachments_in(const Frame& frame, std::uint64_t bytes) const {
    std::uint32_t count = frame.context.info().ordered_attachments;
    while (count > 0 && image_bytes(frame, count) > bytes) --count;
    return 4 * count >= tail_words() ? count : 0;
  }
  bool allocate_layers(Frame& frame, std::uint64_t bytes) {
    const std::uint32_t most = frame.context.info().ordered_attachments;
    if (takes_k(frame) && attachments_for(frame.options.k) > most) {
      throw Error(
          ErrorKind::bad_argument,
          fmt::format("ordered synchronisation needs {} attachments for k = {}, and {} has {}",
                      attachments_for(frame.options.k), frame.options.k, frame.context.info().name, most));
    }
    const std::uint32_t attachments = attachments_in(frame, bytes);
    if (attachments == 0) return false;
    k_ = takes_k(frame) ? frame.options.k : (4 * attachments - tail_words()) / 3;
    // No more than it takes for them.
    layers_ = frame.make_image("fragment layers", kOrderedFormat, attachments_for(k_), ImageUse::read_back);
    target_ = OrderedTarget(frame.context, frame.pipelines.ordered(attachments_for(k_)), layers_);
    return true;
  }
  void insert_in_order(const Frame& frame, Recorder& recorder) const {
    const Constants constants{frame.effect, k_, static_cast<std::uint32_t>(places())};
    recorder.push().p = {0, tail_range(std::max(frame.deepest, kMostInAttachments)), 0, 0};
    const std::string shader =
        fmt::format("capture/k_buffers/ordered_core_{}.frag", target_.layout().attachments());
    frame.gather_in_order(recorder, shader, constants, layers_, target_);
    recorder.barrier();
    resolve(frame, recorder, "capture/k_buffers/fold_places_layers.comp", constants);
  }

  TailWeight weight_;
  std::uint32_t k_ = 0;
  Buffer pool_;
  Image layers_;
  OrderedTarget target_;
};

TechniqueInfo fixed_info(const char* name, const char* title, const char* bytes_formula,
                         std::vector<OptionGroup> groups) {
  return {.name = name,
          .title = title,
          .paper = "Maule et al. 2013",
          .exact = false,
          .captures = "the k nearest of a pixel; the others blended without order",
          .passes_formula = "1, 3 or 4",
          .bytes_formula = bytes_formula,
          .groups = std::move(groups),
          .syncs = {Sync::atomics, Sync::atomics32, Sync::ordered},
          .keeps_tail = true};
}

}  // namespace

TechniqueEntry fixed_k() {
  return {fixed_info("fixed-k",
                     "the k nearest fragments of every pixel and a tail, k as the memory budget allows",
                     "8 k + 8 or 12 k + 16", {OptionGroup::budget, OptionGroup::maps, OptionGroup::sync}),
          [] { return std::unique_ptr<Technique>(std::make_unique<FixedK>(TailWeight::optical_depth)); }};
}

TechniqueEntry hybrid() {
  return {fixed_info("hybrid",
                     "the k nearest fragments of every pixel and a tail by opacity, k as given or as the "
                     "memory budget allows",
                     "8 k + 16 or 12 k + 20",
                     {OptionGroup::k, OptionGroup::budget, OptionGroup::maps, OptionGroup::sync}),
          [] { return std::unique_ptr<Technique>(std::make_unique<FixedK>(TailWeight::opacity)); }};
}

}  // namespace pellucid::render
