// The choice of `auto`: see automatic.h.
#include "automatic.h"

#include <fmt/format.h>

#include "capture/blending_techniques.h"
#include "capture/budget_techniques.h"
#include "capture/buffer_techniques.h"
#include "importance_terms.h"

namespace pellucid::render {
namespace {

std::string found_before(double repaired) {
  return fmt::format("{:.3g} % of the covered pixels were out of order when last tried", 100 * repaired);
}
std::string megabytes(std::uint64_t bytes) {
  return fmt::format("{:.3g} MB", static_cast<double>(bytes) / 1e6);
}

bool fits(const AutomaticDemand& demand, std::uint64_t bytes) {
  return demand.memory == 0 || bytes <= demand.memory;
}

// Why verified blending is worth it; empty: it is not.
std::string reason_to_verify(const AutomaticDemand& demand) {
  if (!demand.blends || !fits(demand, demand.verified_bytes)) return "";
  if (!demand.repaired) return "to see how many pixels the sequence of triangles draws in order";
  if (*demand.repaired > kMostRepaired) return "";
  return found_before(*demand.repaired);
}

std::string reason_to_capture_all(const AutomaticDemand& demand) {
  if (!demand.blends) return "the effect needs the fragments themselves";
  if (demand.repaired && *demand.repaired > kMostRepaired) return found_before(*demand.repaired);
  return "checking the sequence of triangles might take " + megabytes(demand.verified_bytes);
}

AutomaticChoice capture_all(const AutomaticDemand& demand) {
  const std::string reason = reason_to_capture_all(demand);
  if (fits(demand, demand.lists_bytes)) return {"ll", reason};
  return {"sb", fmt::format("{}, and lists {}", reason, megabytes(demand.lists_bytes))};
}

AutomaticChoice keep_to_budget(const AutomaticDemand& demand) {
  const std::string reason = fmt::format("a pool of all fragments would take {}, and {} are allowed",
                                         megabytes(demand.ranges_bytes), megabytes(demand.memory));
  const bool may_lose = demand.overflow == Overflow::nearest && demand.blends;
  if (!demand.atomics64) {
    if (may_lose) return {"fixed-k", reason + ": the nearest, as many of every pixel, the rest averaged"};
    throw Error(ErrorKind::bad_argument, "--technique auto: " + reason +
                                             ", and taking them round after round needs 64-bit atomics, "
                                             "which the device has not");
  }
  const bool chained = may_lose || demand.deepest <= kMostChained;
  if (demand.blends && chained && fits(demand, demand.slots_bytes))
    return {"k-plus", reason + ": slots of 8 bytes hold them all"};
  if (may_lose) return {"variable-k", reason + ": those that matter most, the rest averaged"};
  return {"bounded", reason + ": the nearest ones, round after round"};
}

}  // namespace

AutomaticChoice choose_technique(const AutomaticDemand& demand) {
  if (const std::string reason = reason_to_verify(demand); !reason.empty()) return {"verified", reason};
  if (fits(demand, demand.ranges_bytes)) return capture_all(demand);
  return keep_to_budget(demand);
}

std::optional<double> SequenceHistory::repaired() const {
  return frames_since_ < kFramesUntilTrial ? repaired_ : std::nullopt;
}

void SequenceHistory::add_frame(const std::string& technique, std::uint64_t repaired, std::uint64_t covered) {
  if (technique != "verified") {
    ++frames_since_;
    return;
  }
  repaired_ = covered == 0 ? 0.0 : static_cast<double>(repaired) / static_cast<double>(covered);
  frames_since_ = 0;
}

RenderOptions automatic_options(const RenderOptions& options) {
  check_importance(options.importance);
  RenderOptions own = options;
  own.pool = 0;
  own.sync = Sync::automatic;
  return own;
}

TechniqueEntry automatic() {
  return {{.name = "auto",
           .title = "for every frame the one that suits it: verified, ll, sb, or within --memory k-plus, "
                    "variable-k, bounded",
           .paper = "",
           .captures = "all; within --memory, as many as fit",
           .passes_formula = "of the chosen one",
           .bytes_formula = "of the chosen one",
           .budgeted = true},
          nullptr};
}

AutomaticDemand automatic_demand(const Frame& frame, const SequenceHistory& history) {
  const bool blends =
      frame.options.effect == Effect::transparency || frame.options.effect == Effect::wireframe;
  return {.blends = blends && !frame.options.keep_fragments,
          .memory = frame.options.memory,
          .overflow = frame.options.overflow,
          .atomics64 = frame.context.info().atomics64,
          .deepest = frame.deepest,
          .repaired = history.repaired(),
          .verified_bytes = verified_blend().make()->most_bytes(frame),
          .lists_bytes = linked_lists().make()->most_bytes(frame),
          .ranges_bytes = s_buffer().make()->most_bytes(frame),
          .slots_bytes = k_plus().make()->most_bytes(frame)};
}

}  // namespace pellucid::render
