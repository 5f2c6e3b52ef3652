// Techniques in which pixels have different numbers of slots. k-plus gives every pixel one slot per fragment,
// up to a k that is the same for all. variable-k gives out slots by the importance of pixels.
//
// A survey of the fragments decides which slots of the pool belong to a pixel. Fragments are stored through a
// chain of 64-bit atomic minima, or in critical sections in which each one replaces the farthest that is kept
// (Sync). Based on: Vasilakis, Vardis, Papaioannou, Moustakas, "Variable k-buffer using Importance Maps",
// Eurographics 2017; Vasilakis, Papaioannou, Fudos, "k+-buffer: An Efficient, Memory-Friendly and Dynamic
// k-buffer Framework", TVCG 2015.
#include <fmt/format.h>

#include <limits>

#include "render/capture/k_buffers/place_map.h"
#include "render/capture/k_buffers/tailed_buffer.h"
#include "render/capture/registry.h"

namespace pellucid::render {
namespace {

constexpr std::uint32_t kPlaceBits = 27;  // shaders/capture/k_buffers/places.glsl
constexpr std::uint32_t kPlaceMask = (1U << kPlaceBits) - 1;
constexpr std::uint32_t kNoResidue = 0x80808080U;  // shaders/capture/k_buffers/importance.comp
// If no pixel has more fragments than this, the survey takes one word per pixel
// (shaders/capture/k_buffers/survey.glsl).
constexpr std::uint64_t kMostPacked = 1023;
// In critical sections, one invocation sorts the fragments of a pixel. Drivers may end its loops after some
// 65,000 turns (docs/rendering.md).
constexpr std::uint64_t kMostSorted = 2048;

class MappedK final : public TailedBuffer {
 public:
  explicit MappedK(bool by_importance) : by_importance_(by_importance) {}

  // Returns the bytes that keep all fragments.
  [[nodiscard]] std::uint64_t most_bytes(const Frame& frame) const override {
    constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();
    const BudgetDemand demand = demand_of(frame, kNoLimit);
    Importance wanted = importance_of(frame);
    wanted.packed = frame.deepest <= kMostPacked;
    const std::uint64_t given = given_bytes(frame, wanted);
    const MappedPlan plan = plan_mapped(demand, wanted.survey_words(), given);
    return plan.slots < frame.fragments ? kNoLimit
                                        : plan.map_bytes + plan.state_bytes + plan.pool_bytes + given;
  }

 protected:
  bool allocate_places(Frame& frame, const BudgetDemand& demand) override {
    Importance wanted = importance_of(frame);
    wanted.packed = frame.deepest <= kMostPacked;
    Sharing sharing = by_importance_ ? Sharing::water : Sharing::uniform;
    if (by_importance_ && frame.options.budget.allocation == Allocation::printed) sharing = Sharing::printed;
    const std::uint64_t given = given_bytes(frame, wanted);
    MappedPlan plan = plan_mapped(demand, wanted.survey_words(), given);
    // If there is not enough memory, less is surveyed: first tails lose their weights, and in the end all
    // pixels are equally important.
    if (plan.slots == 0 && !wanted.packed && !wanted.has(ImportanceTerm::opacity)) {
      wanted.depths = false;
      plan = plan_mapped(demand, wanted.survey_words(), given);
    }
    if (plan.slots == 0) {
      wanted.terms = 0;
      wanted.depths = wanted.packed;
      plan = plan_mapped(demand, wanted.survey_words(), 0);
    }
    if (plan.slots == 0) return false;
    refuse_to_sort_too_many(frame, plan.slots);
    pool_ = frame.make_buffer("fragment pool", plan.pool_bytes);
    if (wanted.has(ImportanceTerm::image)) upload_image(frame, wanted.options.image);
    if (wanted.has(ImportanceTerm::residue)) keep_residue(frame);
    map_.allocate(frame, plan, sharing, wanted);
    // Edges of wireframes are not part of the survey.
    if (wanted.depths && frame.options.effect == Effect::transparency) places_ = Places::mapped_with_weights;
    return true;
  }
  void record_places(Frame& frame, Recorder& recorder) override {
    if (frame.residue == nullptr || !uses_residue_) return record_frame(frame, recorder, given_);
    if (is_first_) {
      recorder.fill(*frame.residue, kNoResidue);
      record_frame(frame, recorder, *frame.residue);
      recorder.barrier();
      recorder.fill(frame.counters, 0);
      recorder.barrier();
    }
    record_frame(frame, recorder, *frame.residue);
  }
  [[nodiscard]] std::vector<std::uint32_t> keys(const Frame& frame) const override {
    const std::vector<std::uint32_t> words = map_.places(frame);
    std::vector<std::uint32_t> keys(frame.pixels());
    for (std::size_t p = 0; p < keys.size(); ++p) {
      const std::uint32_t slots = (words[p + 1] & kPlaceMask) - (words[p] & kPlaceMask);
      keys[p] = slots - (words[p] >> kPlaceBits != 0 ? 1U : 0U);
    }
    return keys;
  }
  [[nodiscard]] std::vector<float> importance(const Frame& frame) const override {
    return map_.importance(frame);
  }

 private:
  void record_frame(const Frame& frame, Recorder& recorder, const Buffer& given) const {
    map_.record(frame, recorder, pool_, given);
    const bool measures = uses_residue_ && frame.effect != kDumpEffect;
    if (measures) recorder.bind(Slot::e, *frame.residue);
    const Constants constants{frame.effect, frame.options.k_buffer.heap_from,
                              static_cast<std::uint32_t>(places_)};
    recorder.push().p = {0, tail_range(frame.deepest), frame.options.k_buffer.lock_turns, 0};
    clear_pool(recorder, pool_);
    record_keys(frame, recorder, constants);
    gather(frame, recorder, "capture/k_buffers/place_colors.frag", constants);
    resolve(frame, recorder,
            measures ? "capture/k_buffers/fold_places_measure.comp" : "capture/k_buffers/fold_places.comp",
            constants);
  }
  static void record_keys(const Frame& frame, Recorder& recorder, const Constants& constants) {
    if (frame.sync == Sync::atomics)
      return gather(frame, recorder, "capture/k_buffers/place_keys.frag", constants);
    const bool interlock = frame.sync == Sync::interlock;
    gather(frame, recorder,
           interlock ? "capture/k_buffers/max_first_interlock.frag" : "capture/k_buffers/max_first.frag",
           constants);
    recorder.dispatch(frame.pipelines.compute("capture/k_buffers/sort_slots.comp", constants),
                      frame.tiles_x(), frame.tiles_y());
    recorder.barrier();
  }
  static void refuse_to_sort_too_many(const Frame& frame, std::uint64_t slots) {
    const bool is_limited = frame.context.info().cpu && frame.sync != Sync::atomics;
    if (!is_limited || std::min(frame.deepest, slots) <= kMostSorted) return;
    throw Error(
        ErrorKind::bad_argument,
        fmt::format(
            "{} synchronisation: a pixel has {} fragments, more than the {} that this driver can sort: take "
            "atomics",
            frame.sync == Sync::interlock ? "interlock" : "spinlock", frame.deepest, kMostSorted));
  }
  [[nodiscard]] Importance importance_of(const Frame& frame) const {
    Importance importance;
    importance.options.noise = 0;
    if (!by_importance_) return importance;
    importance.options = frame.options.budget.importance;
    for (const ImportanceTerm term : importance.options.terms)
      importance.terms |= static_cast<std::uint32_t>(term);
    if (importance.has(ImportanceTerm::image) && importance.has(ImportanceTerm::residue)) {
      throw Error(
          ErrorKind::bad_argument,
          "terms of importance: image and residue cannot be combined, because they use the same memory");
    }
    if (importance.has(ImportanceTerm::image) && importance.options.image.bytes.empty())
      throw Error(ErrorKind::bad_argument,
                  "terms of importance: image is among them, but there is no importance image");
    return importance;
  }
  static std::uint64_t residue_bytes(const Frame& frame) {
    return std::max<std::uint64_t>((frame.pixels() + 3) / 4 * 4, 16);
  }
  static std::uint64_t given_bytes(const Frame& frame, const Importance& importance) {
    if (importance.has(ImportanceTerm::image)) return image_bytes(importance.options.image);
    return importance.has(ImportanceTerm::residue) ? residue_bytes(frame) : 0;
  }
  void keep_residue(Frame& frame) {
    uses_residue_ = true;
    is_first_ = !*frame.residue || frame.residue->bytes() != residue_bytes(frame);
    if (is_first_) *frame.residue = Buffer(frame.context, "residues", residue_bytes(frame));
    frame.technique_bytes += frame.residue->bytes();
  }
  static std::uint64_t image_bytes(const ImportanceImage& image) {
    return std::max<std::uint64_t>((image.bytes.size() + 3) / 4 * 4, 16);
  }
  void upload_image(Frame& frame, const ImportanceImage& image) {
    std::vector<std::uint8_t> bytes = image.bytes;
    bytes.resize(image_bytes(image));
    given_ = frame.make_buffer("importance image", bytes.size());
    upload<std::uint8_t>(frame.context, given_, bytes);
  }

  bool by_importance_;
  Places places_ = Places::mapped;
  bool uses_residue_ = false, is_first_ = false;
  PlaceMap map_;
  Buffer pool_, given_;
};

}  // namespace

TechniqueEntry k_plus() {
  return {
      {.name = "k-plus",
       .title = "the min(N, k) nearest fragments and a tail, the largest k that the memory budget allows",
       .paper = "Vasilakis et al. 2015",
       .exact = false,
       .captures = "the k nearest of a pixel; the others blended without order",
       .passes_formula = "4",
       .bytes_formula = "8 min(N, k + 1) + 4",
       .groups = {OptionGroup::budget, OptionGroup::maps, OptionGroup::sync, OptionGroup::critical_sections},
       .syncs = {Sync::atomics, Sync::interlock, Sync::spinlock},
       .keeps_tail = true,
       .needs_atomics64 = true},
      [] { return std::unique_ptr<Technique>(std::make_unique<MappedK>(false)); }};
}

TechniqueEntry variable_k() {
  return {{.name = "variable-k",
           .title = "the nearest fragments and a tail, k by the importance of a pixel",
           .paper = "Vasilakis et al. 2017",
           .exact = false,
           .captures = "the k(p) nearest of a pixel; the others blended without order",
           .passes_formula = "4",
           .bytes_formula = "8 min(N, k(p) + 1) + 4",
           .groups = {OptionGroup::budget, OptionGroup::maps, OptionGroup::importance, OptionGroup::sync,
                      OptionGroup::critical_sections},
           .syncs = {Sync::atomics, Sync::interlock, Sync::spinlock},
           .keeps_tail = true,
           .needs_atomics64 = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<MappedK>(true)); }};
}

}  // namespace pellucid::render
