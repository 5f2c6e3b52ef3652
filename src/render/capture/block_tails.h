// block_tails.h - a tail for every block of pixels, where places for all of them do not fit into a budget.
#pragma once

#include "render/budget/plan.h"
#include "render/frame.h"

namespace pellucid::render {

// The range of sums of so many fragments: range_of() of shaders/budget/tail.glsl.
std::uint32_t tail_range(std::uint64_t fragments);

class BlockTails {
 public:
  void allocate(Frame& frame, const BlockPlan& plan);
  void record(const Frame& frame, Recorder& recorder) const;

 private:
  BlockPlan plan_;
  Buffer tails_, mask_;
};

}  // namespace pellucid::render
