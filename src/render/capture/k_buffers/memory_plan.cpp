// Implements memory_plan.h: what fits into a memory budget.
#include "render/capture/k_buffers/memory_plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "pellucid/base.h"

namespace pellucid::render {
namespace {

constexpr std::uint64_t kBlockTailBytes = 16;  // per block
constexpr std::uint64_t kLeastBuffer = 16;

std::uint64_t tail_bytes(const BudgetDemand& demand, std::uint64_t side) {
  return kBlockTailBytes * ((demand.width + side - 1) / side) * ((demand.height + side - 1) / side);
}

}  // namespace

std::uint64_t uniform_slots(const BudgetDemand& demand, std::uint64_t tail_slots) {
  const std::uint64_t bytes = std::min(demand.bytes, demand.most_buffer_bytes);
  const std::uint64_t needed = std::max<std::uint64_t>(demand.deepest, 1) + tail_slots;
  const std::uint64_t most = std::min(bytes, kSlotBytes * kMostSlots);
  const std::uint64_t slots = std::min(most / (kSlotBytes * demand.pixels()), needed);
  return slots < tail_slots || slots * kSlotBytes * demand.pixels() < kLeastBuffer ? 0 : slots;
}

MappedPlan plan_mapped(const BudgetDemand& demand, std::uint64_t survey_words, std::uint64_t other_bytes) {
  MappedPlan plan;
  const std::uint64_t pixels = demand.pixels();
  plan.map_bytes = std::max(4 * (pixels + 1), kLeastBuffer);
  plan.state_bytes = kBudgetHead + 8 * ((pixels + kGroupPixels - 1) / kGroupPixels);
  const std::uint64_t taken = plan.map_bytes + plan.state_bytes + other_bytes;
  const std::uint64_t room = std::min(demand.bytes - std::min(demand.bytes, taken), demand.most_buffer_bytes);
  const std::uint64_t slots = std::min({room / kSlotBytes, demand.fragments, kMostSlots});
  plan.pool_bytes = std::max({kSlotBytes * slots, 4 * survey_words * pixels, kLeastBuffer});
  if (slots >= demand.covered && plan.pool_bytes <= room) plan.slots = slots;
  return plan;
}

BlockPlan plan_blocks(const BudgetDemand& demand) {
  if (demand.bytes < kBlockTailBytes) {
    throw Error(ErrorKind::bad_argument,
                fmt::format("memory budget: {} bytes do not hold one tail, which takes {}", demand.bytes,
                            kBlockTailBytes));
  }
  BlockPlan plan;
  const auto side_of = [&](std::uint64_t bytes) {
    std::uint32_t side = BlockPlan{}.side;
    while (tail_bytes(demand, side) > std::min(bytes, demand.most_buffer_bytes)) side *= 2;
    return side;
  };
  // In larger blocks, spending the memory on smaller blocks helps more than a mask of covered pixels. Also,
  // each pixel counts the bits of its block by itself, which takes longer in large blocks.
  constexpr std::uint32_t kMostMaskedSide = 64;
  const std::uint64_t mask = std::max((demand.pixels() + 31) / 32 * 4, kLeastBuffer);
  if (mask + kBlockTailBytes <= demand.bytes && side_of(demand.bytes - mask) <= kMostMaskedSide)
    plan.mask_bytes = mask;
  plan.side = side_of(demand.bytes - plan.mask_bytes);
  plan.tail_bytes = tail_bytes(demand, plan.side);
  const std::uint64_t block_pixels = std::uint64_t{plan.side} * plan.side;
  plan.most_fragments = std::min(demand.fragments, demand.deepest * block_pixels);
  return plan;
}

}  // namespace pellucid::render
