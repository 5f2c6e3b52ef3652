// automatic.h - which technique `auto` takes for a frame, by what was counted of it and of the frames before.
//
// Everything it goes by is a count, no time: the same frames are drawn the same way on every run. What it
// chooses between, and where the limits are from: docs/rendering.md, section 3.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "capture/technique.h"

namespace pellucid::render {

// Above that share of repaired pixels verified blending is slower than capturing everything at once.
constexpr double kMostRepaired = 0.5;
// Chains of so many slots are slower than rounds.
constexpr std::uint64_t kMostChained = 64;
// After so many frames that captured everything, the sequence of triangles is tried again.
constexpr std::uint32_t kFramesUntilTrial = 16;

struct AutomaticDemand {
  bool blends = true;                     // the effect does, and no fragments are to be kept
  std::uint64_t memory = 0;               // bytes; 0: as many as it takes
  Overflow overflow = Overflow::nearest;  // what is done where they do not suffice
  bool atomics64 = true;
  std::uint64_t deepest = 0;  // fragments of a pixel
  // Of the pixels that are covered, those that had to be repaired when verified blending was last tried;
  // none: not yet, or a trial is due.
  std::optional<double> repaired;
  std::uint64_t verified_bytes = 0, lists_bytes = 0, ranges_bytes = 0, slots_bytes = 0;  // at most
};
struct AutomaticChoice {
  std::string technique, reason;
};
// Throws Error{bad_argument} where the budget is too small for what the device can do.
AutomaticChoice choose_technique(const AutomaticDemand& demand);

// How well the sequence of triangles did in the last frames.
class SequenceHistory {
 public:
  [[nodiscard]] std::optional<double> repaired() const;
  void add_frame(const std::string& technique, std::uint64_t repaired, std::uint64_t covered);

 private:
  std::optional<double> repaired_;
  std::uint32_t frames_since_ = 0;
};

// Without what only some of the techniques have a meaning for. Throws Error{bad_argument} for what one that
// may be taken would refuse.
RenderOptions automatic_options(const RenderOptions& options);

// How `auto` is listed.
TechniqueEntry automatic();

// Of a frame that was counted.
AutomaticDemand automatic_demand(const Frame& frame, const SequenceHistory& history);

}  // namespace pellucid::render
