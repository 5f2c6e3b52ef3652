// Implements automatic.h: the choice of `auto`, and the history of draw orders that it is based on.
#include "render/capture/automatic.h"

#include <fmt/format.h>

#include <limits>

#include "render/capture/registry.h"
#include "render/options.h"
#include "render/resolve/list_resolve.h"

namespace pellucid::render {
namespace {

std::string found_before(const Repairs& repairs) {
  return fmt::format("{:.3g} % of the covered pixels were out of order when last tried",
                     100 * repairs.pixels);
}

bool is_worth_it(const AutomaticDemand& demand) {
  return verified_by_lists(demand, *demand.repairs) < 1;
}

std::string megabytes(std::uint64_t bytes) {
  return fmt::format("{:.3g} MB", static_cast<double>(bytes) / 1e6);
}

bool fits(const AutomaticDemand& demand, std::uint64_t bytes) {
  return demand.memory == 0 || bytes <= demand.memory;
}

// Returns why verified blending is worth it, or an empty text where it is not.
std::string reason_to_verify(const AutomaticDemand& demand) {
  if (!demand.blends || !fits(demand, demand.verified_bytes)) return "";
  if (!demand.repairs) return "to see how many pixels the draw order draws in order";
  return is_worth_it(demand) ? found_before(*demand.repairs) : "";
}

std::string reason_to_capture_all(const AutomaticDemand& demand) {
  if (!demand.blends) return "the effect needs the fragments themselves";
  if (demand.repairs && !is_worth_it(demand)) return found_before(*demand.repairs);
  return "checking the draw order might take " + megabytes(demand.verified_bytes);
}

AutomaticChoice capture_all(const AutomaticDemand& demand) {
  const std::string reason = reason_to_capture_all(demand);
  if (fits(demand, demand.lists_bytes)) return {"ll", reason};
  return {"sb", fmt::format("{}, and lists {}", reason, megabytes(demand.lists_bytes))};
}

AutomaticChoice keep_to_budget(const AutomaticDemand& demand) {
  const std::string reason = "a pool of all fragments would take more than " + megabytes(demand.memory);
  const bool may_lose = demand.overflow == Overflow::nearest && demand.blends;
  if (!demand.atomics64) {
    if (may_lose) return {"fixed-k", reason + ": the nearest, as many of every pixel, the rest averaged"};
    throw Error(ErrorKind::bad_argument, "technique auto: " + reason +
                                             ", and capturing them in several rounds needs 64-bit atomics, "
                                             "which the device does not support");
  }
  const bool chained = may_lose || demand.deepest <= kMostChained;
  if (demand.blends && chained && fits(demand, demand.slots_bytes))
    return {"k-plus", reason + ": slots of 8 bytes hold them all"};
  if (may_lose) return {"variable-k", reason + ": those that matter most, the rest averaged"};
  return {"bounded", reason + ": the nearest fragments, in several rounds"};
}

}  // namespace

double verified_by_lists(const AutomaticDemand& demand, const Repairs& repairs) {
  // The cost of a triangle, of a fragment that is blended, and of a fragment that is captured after it was
  // blended. The unit is the cost of a fragment that is put into a list and sorted. Measured on a driver that
  // runs on the CPU (docs/rendering.md).
  constexpr double kTriangle = 0.7;
  constexpr double kBlendedFragment = 0.38;
  constexpr double kRepairedFragment = 0.8;
  const auto triangles = static_cast<double>(demand.triangles);
  const auto fragments = static_cast<double>(std::max<std::uint64_t>(demand.fragments, 1));
  // Repairs draw their triangles twice: to count fragments, and to store them.
  const double verified = kTriangle * triangles * (1 + 2 * repairs.triangles) +
                          (kBlendedFragment + kRepairedFragment * repairs.pixels) * fragments;
  return verified / (kTriangle * triangles + fragments);
}

AutomaticChoice choose_technique(const AutomaticDemand& demand) {
  if (const std::string reason = reason_to_verify(demand); !reason.empty()) return {"verified", reason};
  if (fits(demand, demand.ranges_bytes)) return capture_all(demand);
  return keep_to_budget(demand);
}

std::optional<Repairs> DrawOrderHistory::repairs() const {
  return frames_since_ < kFramesUntilTrial ? repairs_ : std::nullopt;
}

void DrawOrderHistory::add_frame(const std::string& technique, const Repairs& repairs) {
  if (technique != "verified") {
    ++frames_since_;
    return;
  }
  repairs_ = repairs;
  frames_since_ = 0;
}

Repairs repairs_between(const CaptureStats& before, const CaptureStats& after,
                        const AutomaticDemand& demand) {
  if (after.pool_exceeded) return {1, 1};
  const auto share = [](std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
  };
  return {share(after.repaired_pixels - before.repaired_pixels, demand.covered),
          share(after.repaired_triangles - before.repaired_triangles, demand.triangles)};
}

RenderOptions automatic_options(const RenderOptions& options) {
  check_importance(options.budget.importance);
  RenderOptions own = options;
  own.pool.nodes = 0;
  own.k_buffer.sync = Sync::automatic;
  return own;
}

TechniqueEntry automatic() {
  return {
      {.name = "auto",
       .title = "the technique that fits the frame: verified, ll, sb, or within a memory budget k-plus, "
                "variable-k, bounded",
       .paper = "",
       .captures = "all; within a memory budget, as many as fit",
       .passes_formula = "of the chosen one",
       .bytes_formula = "of the chosen one",
       .groups = {OptionGroup::overflow, OptionGroup::budget, OptionGroup::importance, OptionGroup::sorting}},
      nullptr};
}

AutomaticDemand automatic_demand(const Frame& frame, const DrawOrderHistory& history) {
  constexpr std::uint64_t kNeverFits = std::numeric_limits<std::uint64_t>::max();
  // Where lists are too long for the loops of the driver, the frame is captured again, and the bytes that
  // this takes are not known here. Such a technique counts as one that never fits.
  const auto bytes_of = [&](const TechniqueEntry& technique) {
    const bool again = frame.options.budget.bytes != 0 && ListResolve::ends_early(frame);
    return again ? kNeverFits : technique.make()->most_bytes(frame);
  };
  std::uint64_t triangles = 0;
  for (const DrawRange& range : frame.scene.ranges) triangles += range.triangles;
  return {.blends = blends(frame.options.effect) && !frame.options.keep_fragments,
          .memory = frame.options.budget.bytes,
          .overflow = frame.options.pool.overflow,
          .atomics64 = frame.context.info().atomics64,
          .deepest = frame.deepest,
          .fragments = frame.fragments,
          .covered = frame.covered,
          .triangles = triangles,
          .repairs = history.repairs(),
          .verified_bytes = bytes_of(verified_blend()),
          .lists_bytes = bytes_of(linked_lists()),
          .ranges_bytes = bytes_of(s_buffer()),
          .slots_bytes = k_plus().make()->most_bytes(frame)};
}

}  // namespace pellucid::render
