// automatic.h - chooses the technique that `auto` takes for a frame, from counts of this frame and of the
// frames before. Times have no part in it, so the same frames are drawn the same way on every run.
//
// docs/rendering.md, section 3, says what it chooses between, and where the limits are from.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "render/capture/technique.h"

namespace pellucid::render {

// Chains of more slots than this are slower than rounds.
constexpr std::uint64_t kMostChained = 64;
// Number of frames that capture everything until the draw order is tried again.
constexpr std::uint32_t kFramesUntilTrial = 16;

// What became of a draw order that was verified: shares of the covered pixels, and of the
// triangles that were drawn again for them.
struct Repairs {
  double pixels = 0, triangles = 0;
};

struct AutomaticDemand {
  bool blends = true;                     // the effect does, and no fragments are to be kept
  std::uint64_t memory = 0;               // bytes; 0: as many as it takes
  Overflow overflow = Overflow::nearest;  // what is done where they do not suffice
  bool atomics64 = true;
  std::uint64_t deepest = 0;  // fragments of a pixel
  std::uint64_t fragments = 0, covered = 0, triangles = 0;
  // When verified blending was last tried; none: not yet, or a trial is due.
  std::optional<Repairs> repairs;
  std::uint64_t verified_bytes = 0, lists_bytes = 0, ranges_bytes = 0, slots_bytes = 0;  // at most
};
struct AutomaticChoice {
  std::string technique, reason;
};
// What a frame takes by verified blending where it needs these repairs; 1: by lists of all fragments.
double verified_by_lists(const AutomaticDemand& demand, const Repairs& repairs);

// Throws Error{bad_argument} where the budget is too small for what the device can do.
AutomaticChoice choose_technique(const AutomaticDemand& demand);

// What `after` has more than `before`. What was captured again had to be repaired, all of it.
Repairs repairs_between(const CaptureStats& before, const CaptureStats& after, const AutomaticDemand& demand);

// How well the draw order did in the last frames.
class DrawOrderHistory {
 public:
  [[nodiscard]] std::optional<Repairs> repairs() const;
  // `repairs`: of verified blending, else of no meaning.
  void add_frame(const std::string& technique, const Repairs& repairs);

 private:
  std::optional<Repairs> repairs_;
  std::uint32_t frames_since_ = 0;
};

// Without what only some of the techniques have a meaning for. Throws Error{bad_argument} for what one that
// may be taken would refuse.
RenderOptions automatic_options(const RenderOptions& options);

// Returns how `auto` is listed.
TechniqueEntry automatic();

// Of a frame that was counted.
AutomaticDemand automatic_demand(const Frame& frame, const DrawOrderHistory& history);

}  // namespace pellucid::render
