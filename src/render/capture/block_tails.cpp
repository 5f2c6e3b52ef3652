// Tails of blocks: see block_tails.h.
#include "render/capture/block_tails.h"

#include <bit>

namespace pellucid::render {

std::uint32_t tail_range(std::uint64_t fragments) {
  constexpr std::uint32_t kMostDepthBits = 3;
  constexpr std::uint32_t kRangeBias = 8;
  return static_cast<std::uint32_t>(std::bit_width(fragments)) + kMostDepthBits + kRangeBias;
}

void BlockTails::allocate(Frame& frame, const BlockPlan& plan) {
  plan_ = plan;
  tails_ = frame.make_buffer("tails of blocks", plan.tail_bytes);
  if (plan.mask_bytes > 0) mask_ = frame.make_buffer("mask of covered pixels", plan.mask_bytes);
}

void BlockTails::record(const Frame& frame, Recorder& recorder) const {
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

}  // namespace pellucid::render
