// memory_plan.h - computes what fits into a memory budget: slots of 8 bytes for fragments, maps to them, and
// tails.
#pragma once

#include <cstdint>

namespace pellucid::render {

constexpr std::uint64_t kSlotBytes = 8;
constexpr std::uint64_t kMostSlots = (std::uint64_t{1} << 27U) - 1;  // shaders/capture/k_buffers/places.glsl
// Pixels that a group of shaders/capture/k_buffers/place_map.glsl handles, and bytes of what all groups
// share.
constexpr std::uint64_t kGroupPixels = 1024;
constexpr std::uint64_t kBudgetHead = 64 + 8 * 128;

// What has to be held.
struct BudgetDemand {
  std::uint64_t bytes = 0;  // the budget
  std::uint64_t most_buffer_bytes = 0;
  std::uint32_t width = 0, height = 0;
  std::uint64_t fragments = 0, covered = 0, deepest = 0;
  [[nodiscard]] std::uint64_t pixels() const { return std::uint64_t{width} * height; }
};

// Slots that all pixels have alike, the last `tail_slots` of them for a tail; 0: not even those fit. More
// than the deepest pixel needs are not taken.
std::uint64_t uniform_slots(const BudgetDemand& demand, std::uint64_t tail_slots);

// Places of different sizes, with a map to them.
struct MappedPlan {
  std::uint64_t slots = 0;  // for all pixels; 0: not every covered pixel gets one
  std::uint64_t pool_bytes = 0, map_bytes = 0, state_bytes = 0;
};
// `survey_words`: of a pixel, which share the pool's memory before fragments do; `other_bytes`: taken
// beforehand.
MappedPlan plan_mapped(const BudgetDemand& demand, std::uint64_t survey_words, std::uint64_t other_bytes);

// A tail for each block of pixels: what always fits.
struct BlockPlan {
  std::uint32_t side = 1;  // of a block
  std::uint64_t tail_bytes = 0;
  std::uint64_t mask_bytes = 0;      // a bit for each pixel; 0: no room for them
  std::uint64_t most_fragments = 0;  // of a block
};
// Throws Error{bad_argument} where not even one tail fits.
BlockPlan plan_blocks(const BudgetDemand& demand);

}  // namespace pellucid::render
