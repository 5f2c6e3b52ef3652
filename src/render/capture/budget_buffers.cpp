// The nearest fragments of every pixel in a given number of bytes, and one layer behind them for the others:
// the same number of slots for all pixels (fixed-k), the same as far as they have fragments (k-plus), or as
// many as a pixel's importance says (variable-k). Keys go through a chain of 64-bit atomic minima, so the
// sequence of drawing does not matter; the colour then takes the place of the id: 8 bytes a fragment.
// Vasilakis, Vardis, Papaioannou, Moustakas, "Variable k-buffer using Importance Maps", Eurographics 2017;
// Vasilakis, Papaioannou, Fudos, "k+-buffer", TVCG 2015; the tail: Maule, Comba, Torchelsen, Bastos, "Hybrid
// Transparency", I3D 2013.
#include <bit>
#include <optional>

#include "../budget/allocation.h"
#include "../budget/plan.h"
#include "budget_techniques.h"

namespace pellucid::render {
namespace {

// Where no budget is given: so many bytes for each pixel.
constexpr std::uint64_t kBytesOfAPixel = 32;
constexpr std::uint32_t kPlaceBits = 27;  // shaders/budget/places.glsl
constexpr std::uint32_t kPlaceMask = (1U << kPlaceBits) - 1;
constexpr std::uint32_t kNoResidue = 0x80808080U;  // shaders/budget/terms.glsl
constexpr std::uint32_t kEmpty = 0xFFFFFFFFU;      // kNoKey, and a tail that nothing was put into

// Where no pixel has more, the survey is a word a pixel (shaders/budget/survey.glsl).
constexpr std::uint64_t kMostPacked = 1023;

// shaders/budget/places.glsl: kVariant.
enum class Places : std::uint32_t { uniform, mapped, mapped_with_weights };

// shaders/budget/tail.glsl: range_of().
std::uint32_t tail_range(std::uint64_t fragments) {
  constexpr std::uint32_t kMostDepthBits = 3;
  constexpr std::uint32_t kRangeBias = 8;
  return static_cast<std::uint32_t>(std::bit_width(fragments)) + kMostDepthBits + kRangeBias;
}

BudgetDemand demand_of(const Frame& frame) {
  const std::uint64_t memory = frame.options.memory;
  return {.bytes = memory != 0 ? memory : kBytesOfAPixel * frame.pixels(),
          .most_buffer_bytes = frame.context.info().max_buffer_bytes,
          .width = frame.width,
          .height = frame.height,
          .fragments = frame.fragments,
          .covered = frame.covered,
          .deepest = frame.deepest};
}

void add_k(CaptureStats& stats, std::uint32_t k) {
  stats.k_least = std::min(stats.k_least.value_or(k), k);
  stats.k_most = std::max(stats.k_most.value_or(k), k);
  stats.k_sum += k;
}

// A tail for blocks of pixels, where places for all of them do not fit.
class Blocks {
 public:
  void allocate(Frame& frame, const BlockPlan& plan) {
    plan_ = plan;
    tails_ = frame.make_buffer("tails of blocks", plan.tail_bytes);
    if (plan.mask_bytes > 0) mask_ = frame.make_buffer("mask of covered pixels", plan.mask_bytes);
  }
  void record(const Frame& frame, Recorder& recorder) const {
    recorder.bind(Slot::a, tails_);
    recorder.fill(tails_, 0);
    if (mask_) {
      recorder.bind(Slot::b, mask_);
      recorder.fill(mask_, 0);
    }
    recorder.barrier();
    recorder.push().p = {plan_.side, tail_range(plan_.most_fragments), mask_ ? 1U : 0U, 0};
    frame.gather(recorder, "budget/blocks.frag", {frame.effect});
    recorder.barrier();
    recorder.begin_resolve();
    recorder.dispatch(frame.pipelines.compute("budget/blocks.comp", {frame.effect}), frame.tiles_x(),
                      frame.tiles_y());
  }

 private:
  BlockPlan plan_;
  Buffer tails_, mask_;
};

class BudgetBuffer : public Technique {
 public:
  // How much there is to hold decides what is made of the budget.
  [[nodiscard]] bool needs_counts() const override { return true; }
  // No buffer is larger than the device lets a shader address.
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& /*frame*/) const override { return 0; }
  void allocate(Frame& frame) override {
    const BudgetDemand demand = demand_of(frame);
    if (!allocate_places(frame, demand)) blocks_.emplace().allocate(frame, plan_blocks(demand));
  }
  void start(Frame& frame, Recorder& recorder) override {
    if (blocks_) return blocks_->record(frame, recorder);
    record_places(frame, recorder);
  }
  void report(const Frame& frame, std::span<const std::uint32_t> counts, RenderResult& result) override {
    if (!frame.options.statistics && !frame.options.maps) return;
    const std::vector<std::uint32_t> slots =
        blocks_ ? std::vector<std::uint32_t>(counts.size()) : keys(frame);
    for (std::size_t p = 0; p < counts.size(); ++p) {
      if (counts[p] > 0) add_k(result.stats, slots[p]);
    }
    if (!frame.options.maps) return;
    const std::vector<float> seen = blocks_ ? std::vector<float>(counts.size()) : importance(frame);
    const std::uint32_t samples = frame.options.samples;
    for (std::size_t n = 0; n < counts.size(); ++n) {
      const std::uint64_t p = frame.sample_at(n / samples, static_cast<std::uint32_t>(n % samples));
      result.maps.importance.push_back(seen[p]);
      result.maps.k.push_back(counts[p] > 0 ? slots[p] : 0);
      result.maps.lost.push_back(counts[p] - std::min(counts[p], slots[p]));
    }
  }

 protected:
  // False: they do not fit.
  virtual bool allocate_places(Frame& frame, const BudgetDemand& demand) = 0;
  virtual void record_places(Frame& frame, Recorder& recorder) = 0;
  // Of every pixel: slots for fragments, and importance.
  [[nodiscard]] virtual std::vector<std::uint32_t> keys(const Frame& frame) const = 0;
  [[nodiscard]] virtual std::vector<float> importance(const Frame& frame) const = 0;

  // The passes over the fragments, once places are known.
  static void record_capture(const Frame& frame, Recorder& recorder, const Buffer& pool, Places places,
                             std::string_view resolve = "budget/resolve.comp") {
    const Constants constants{frame.effect, 0, static_cast<std::uint32_t>(places)};
    recorder.bind(Slot::a, pool);
    recorder.fill(pool, kEmpty);
    recorder.barrier();
    frame.gather(recorder, "budget/keys.frag", constants);
    recorder.barrier();
    frame.gather(recorder, "budget/colors.frag", constants);
    recorder.barrier();
    recorder.begin_resolve();
    recorder.dispatch(frame.pipelines.compute(resolve, constants), frame.tiles_x(), frame.tiles_y());
  }

 private:
  std::optional<Blocks> blocks_;
};

class FixedK final : public BudgetBuffer {
 protected:
  bool allocate_places(Frame& frame, const BudgetDemand& demand) override {
    slots_ = static_cast<std::uint32_t>(uniform_slots(demand));
    if (slots_ == 0) return false;
    pool_ = frame.make_buffer("fragment pool", kSlotBytes * slots_ * frame.pixels());
    return true;
  }
  void record_places(Frame& frame, Recorder& recorder) override {
    recorder.push().p = {slots_, tail_range(frame.deepest), 0, 0};
    record_capture(frame, recorder, pool_, Places::uniform);
  }
  [[nodiscard]] std::vector<std::uint32_t> keys(const Frame& frame) const override {
    return std::vector<std::uint32_t>(frame.pixels(), slots_ - 1);
  }
  [[nodiscard]] std::vector<float> importance(const Frame& frame) const override {
    return std::vector<float>(frame.pixels(), 1);
  }

 private:
  std::uint32_t slots_ = 0;
  Buffer pool_;
};

class MappedK final : public BudgetBuffer {
 public:
  explicit MappedK(bool by_importance) : by_importance_(by_importance) {}

 protected:
  bool allocate_places(Frame& frame, const BudgetDemand& demand) override {
    Importance wanted = importance_of(frame);
    wanted.packed = frame.deepest <= kMostPacked;
    Sharing sharing = by_importance_ ? Sharing::water : Sharing::uniform;
    if (by_importance_ && frame.options.allocation == Allocation::printed) sharing = Sharing::printed;
    const std::uint64_t given = given_bytes(frame, wanted);
    MappedPlan plan = plan_mapped(demand, wanted.survey_words(), given);
    // Less is surveyed, where there is no room for more: tails have no weights then, and in the end all
    // pixels are of equal importance.
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
    pool_ = frame.make_buffer("fragment pool", plan.pool_bytes);
    if (wanted.has(ImportanceTerm::image)) upload_image(frame, wanted.options.image);
    if (wanted.has(ImportanceTerm::residue)) keep_residue(frame);
    map_.allocate(frame, plan, sharing, wanted);
    // Edges of wireframes are not surveyed.
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
    recorder.push().p[1] = tail_range(frame.deepest);
    record_capture(frame, recorder, pool_, places_,
                   measures ? "budget/resolve_measure.comp" : "budget/resolve.comp");
  }
  [[nodiscard]] Importance importance_of(const Frame& frame) const {
    Importance importance;
    importance.options.noise = 0;
    if (!by_importance_) return importance;
    importance.options = frame.options.importance;
    for (const ImportanceTerm term : importance.options.terms)
      importance.terms |= static_cast<std::uint32_t>(term);
    if (importance.has(ImportanceTerm::image) && importance.has(ImportanceTerm::residue)) {
      throw Error(ErrorKind::bad_argument,
                  "--importance: not both image and residue: they lie in the same place");
    }
    if (importance.has(ImportanceTerm::image) && importance.options.image.bytes.empty())
      throw Error(ErrorKind::bad_argument, "--importance image: no --importance-image is given");
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

TechniqueEntry fixed_k() {
  return {{.name = "fixed-k",
           .title = "the k nearest fragments of every pixel and a tail, k as --memory allows",
           .paper = "Maule et al. 2013",
           .exact = false,
           .captures = "the k nearest of a pixel; the others blended without order",
           .passes_formula = "3",
           .bytes_formula = "8 k + 8",
           .budgeted = true,
           .keeps_tail = true,
           .needs_atomics64 = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<FixedK>()); }};
}

TechniqueEntry k_plus() {
  return {{.name = "k-plus",
           .title = "the min(N, k) nearest fragments and a tail, the largest k that --memory allows",
           .paper = "Vasilakis et al. 2015",
           .exact = false,
           .captures = "the k nearest of a pixel; the others blended without order",
           .passes_formula = "4",
           .bytes_formula = "8 min(N, k + 1) + 4",
           .budgeted = true,
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
           .budgeted = true,
           .keeps_tail = true,
           .needs_atomics64 = true},
          [] { return std::unique_ptr<Technique>(std::make_unique<MappedK>(true)); }};
}

}  // namespace pellucid::render
