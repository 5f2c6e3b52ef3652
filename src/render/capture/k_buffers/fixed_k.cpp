// Fixed k: gives all pixels the same number of slots for their nearest fragments, and a tail for the others.
//
// There are three ways to store them (Sync). A chain of 64-bit atomic minima over keys is followed by a pass
// for colours. Chains of 32-bit minima, first over depths and then over ids, serve devices without 64-bit
// atomics. Insertion into ordered attachments takes one pass.
//
// Based on: Maule, Comba, Torchelsen, Bastos, "Hybrid Transparency", I3D 2013. It is also the baseline of
// Vasilakis, Vardis, Papaioannou, Moustakas, "Variable k-buffer using Importance Maps", Eurographics 2017.
#include <fmt/format.h>

#include "render/capture/k_buffers/tailed_buffer.h"
#include "render/capture/registry.h"
#include "render/device/ordered_attachments.h"

namespace pellucid::render {
namespace {

// The weights of the colours in a tail: optical depth, as for a fine mixture of the fragments, or opacity, as
// in the paper.
enum class TailWeight { optical_depth, opacity };

// Fragments are not counted before they go to attachments, so the sums there have 32 bits, enough for this
// many opaque fragments.
constexpr std::uint64_t kMostInAttachments = 65'535;

class FixedK final : public TailedBuffer {
 public:
  explicit FixedK(TailWeight weight) : weight_(weight) {}
  // Applies only where k is given. Then the image is cut into bands if the buffers are too large.
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& frame) const override {
    return takes_k(frame) && frame.sync != Sync::ordered ? default_bytes(frame) : 0;
  }
  // Attachments have as many slots as fit, whatever the number of fragments is.
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
  // Returns whether RenderOptions::k decides the number of slots. Otherwise the budget does.
  [[nodiscard]] bool takes_k(const Frame& frame) const {
    return by_opacity() && frame.options.budget.bytes == 0;
  }
  [[nodiscard]] std::uint64_t bytes_given(const Frame& frame) const {
    return frame.options.budget.bytes != 0 ? frame.options.budget.bytes : default_bytes(frame);
  }

  // Weighting by opacity takes one sum more.
  [[nodiscard]] bool by_opacity() const { return weight_ == TailWeight::opacity; }
  [[nodiscard]] Places places() const { return by_opacity() ? Places::uniform_by_opacity : Places::uniform; }
  [[nodiscard]] std::uint32_t tail_slots() const { return by_opacity() ? 2 : 1; }
  // The words of a tail in attachments (shaders/capture/k_buffers/core_layers.glsl).
  [[nodiscard]] std::uint32_t tail_words() const { return by_opacity() ? 5 : 4; }
  [[nodiscard]] std::uint32_t attachments_for(std::uint32_t k) const {
    return (3 * k + tail_words() + 3) / 4;
  }
  static std::uint64_t image_bytes(const Frame& frame, std::uint32_t attachments) {
    return Image::bytes_needed(frame.context,
                               frame.image_spec(kOrderedFormat, attachments, ImageUse::read_back));
  }
  // Returns the largest number of attachments that fit, or 0 if not even a tail fits.
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
    // Only as many attachments are made as k slots and the tail need.
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
