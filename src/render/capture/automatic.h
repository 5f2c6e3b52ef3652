// automatic.h - chooses the technique that `auto` takes for a frame. Counts of this frame and of earlier
// frames go in, the name of a technique and the reason come out. The choice does not depend on times, so the
// same frames are drawn in the same way on every run.
//
// docs/rendering.md, section 3, describes the choice and where the limits come from.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "render/capture/technique.h"

namespace pellucid::render {

// Longer chains of slots are slower than capturing in rounds.
constexpr std::uint64_t kMostChained = 64;
// After verified blending was not worth it, this number of frames capture everything before the draw order is
// tried again.
constexpr std::uint32_t kFramesUntilTrial = 16;

// What verified blending had to repair: the share of the covered pixels, and the share of the triangles that
// were drawn again for them.
struct Repairs {
  double pixels = 0, triangles = 0;
};

struct AutomaticDemand {
  bool blends = true;                     // the effect blends, and the caller does not keep fragments
  std::uint64_t memory = 0;               // budget in bytes; 0: no limit
  Overflow overflow = Overflow::nearest;  // what is done where the budget is too small
  bool atomics64 = true;
  std::uint64_t deepest = 0;  // the largest number of fragments of a pixel
  std::uint64_t fragments = 0, covered = 0, triangles = 0;
  // The repairs of the last trial of verified blending. Empty: there was no trial yet, or a new one is due.
  std::optional<Repairs> repairs;
  // Upper bounds of the bytes that `verified`, `ll`, `sb` and `k-plus` take.
  std::uint64_t verified_bytes = 0, lists_bytes = 0, ranges_bytes = 0, slots_bytes = 0;
};
struct AutomaticChoice {
  std::string technique, reason;
};
// Returns the estimated time of a frame by verified blending with these repairs, relative to lists of all
// fragments.
double verified_by_lists(const AutomaticDemand& demand, const Repairs& repairs);

// Chooses a technique. Throws Error{bad_argument} where the budget is too small for what the device supports.
AutomaticChoice choose_technique(const AutomaticDemand& demand);

// Returns the repairs of one frame, from the statistics before and after it. A frame that was captured again
// counts as repaired completely.
Repairs repairs_between(const CaptureStats& before, const CaptureStats& after, const AutomaticDemand& demand);

// Remembers how many repairs the draw order needed in the last frames.
class DrawOrderHistory {
 public:
  [[nodiscard]] std::optional<Repairs> repairs() const;
  // Adds a frame. `repairs` is used only if `technique` is "verified".
  void add_frame(const std::string& technique, const Repairs& repairs);

 private:
  std::optional<Repairs> repairs_;
  std::uint32_t frames_since_ = 0;
};

// Returns the options for the chosen technique, without those that only some of the techniques use. Throws
// Error{bad_argument} for values that one of the techniques would refuse.
RenderOptions automatic_options(const RenderOptions& options);

// Returns the entry of `auto` in the list of techniques.
TechniqueEntry automatic();

// Collects what choose_technique() needs from a frame whose fragments have been counted.
AutomaticDemand automatic_demand(const Frame& frame, const DrawOrderHistory& history);

}  // namespace pellucid::render
