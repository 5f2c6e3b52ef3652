// memory_plan.h - computes what fits into a memory budget. The budget and counts of fragments go in, numbers
// of slots (8 bytes each) and sizes of buffers come out.
#pragma once

#include <cstdint>

namespace pellucid::render {

constexpr std::uint64_t kSlotBytes = 8;
constexpr std::uint64_t kMostSlots = (std::uint64_t{1} << 27U) - 1;  // shaders/capture/k_buffers/places.glsl
// The number of pixels that one group of shaders/capture/k_buffers/place_map.glsl handles, and the bytes that
// all groups share.
constexpr std::uint64_t kGroupPixels = 1024;
constexpr std::uint64_t kBudgetHead = 64 + 8 * 128;

// The budget and the fragments that it has to hold.
struct BudgetDemand {
  std::uint64_t bytes = 0;  // the budget
  std::uint64_t most_buffer_bytes = 0;
  std::uint32_t width = 0, height = 0;
  std::uint64_t fragments = 0, covered = 0, deepest = 0;
  [[nodiscard]] std::uint64_t pixels() const { return std::uint64_t{width} * height; }
};

// Returns the number of slots that every pixel gets, including `tail_slots` for a tail, or 0 if not even
// those fit. Never more than the deepest pixel needs.
std::uint64_t uniform_slots(const BudgetDemand& demand, std::uint64_t tail_slots);

// Sizes of a pool in which pixels have different numbers of slots, and of the map that says where they begin.
struct MappedPlan {
  std::uint64_t slots = 0;  // of all pixels together; 0: not every covered pixel gets one
  std::uint64_t pool_bytes = 0, map_bytes = 0, state_bytes = 0;
};
// Plans such a pool. The survey takes `survey_words` words per pixel in the memory of the pool, before
// fragments are stored there. `other_bytes` of the budget are already taken.
MappedPlan plan_mapped(const BudgetDemand& demand, std::uint64_t survey_words, std::uint64_t other_bytes);

// Sizes of tails that are shared by blocks of pixels. They fit into any budget that holds one tail.
struct BlockPlan {
  std::uint32_t side = 1;  // of a block, pixels
  std::uint64_t tail_bytes = 0;
  std::uint64_t mask_bytes = 0;      // one bit per pixel; 0: they do not fit
  std::uint64_t most_fragments = 0;  // in a block
};
// Plans block tails. Throws Error{bad_argument} where not even one tail fits.
BlockPlan plan_blocks(const BudgetDemand& demand);

}  // namespace pellucid::render
