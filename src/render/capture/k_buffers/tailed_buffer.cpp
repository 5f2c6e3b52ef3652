// Implements tailed_buffer.h: places or block tails, and the reported numbers of slots.
#include "render/capture/k_buffers/tailed_buffer.h"

#include <bit>

namespace pellucid::render {
namespace {

constexpr std::uint32_t kNoFragment =
    0xFFFFFFFFU;  // shaders/capture/k_buffers/places.glsl: both words of an empty slot

void add_k(CaptureStats& stats, std::uint32_t k) {
  stats.k_least = std::min(stats.k_least.value_or(k), k);
  stats.k_most = std::max(stats.k_most.value_or(k), k);
  stats.k_sum += k;
}

}  // namespace

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
  frame.gather(recorder, "capture/k_buffers/blocks.frag", {frame.effect});
  recorder.barrier();
  recorder.begin_resolve();
  recorder.dispatch(frame.pipelines.compute("capture/k_buffers/fold_blocks.comp", {frame.effect}),
                    frame.tiles_x(), frame.tiles_y());
}

BudgetDemand TailedBuffer::demand_of(const Frame& frame, std::uint64_t bytes) {
  return {.bytes = bytes,
          .most_buffer_bytes = frame.context.info().max_buffer_bytes,
          .width = frame.width,
          .height = frame.height,
          .fragments = frame.fragments,
          .covered = frame.covered,
          .deepest = frame.deepest};
}

std::uint64_t TailedBuffer::default_bytes(const Frame& frame) const {
  constexpr std::uint64_t kBytesOfAPixel = 32;
  return kBytesOfAPixel * frame.pixels();
}

void TailedBuffer::allocate(Frame& frame) {
  const std::uint64_t memory = frame.options.budget.bytes;
  const BudgetDemand demand = demand_of(frame, memory != 0 ? memory : default_bytes(frame));
  if (!allocate_places(frame, demand)) blocks_.emplace().allocate(frame, plan_blocks(demand));
}

void TailedBuffer::start(Frame& frame, Recorder& recorder) {
  if (blocks_) return blocks_->record(frame, recorder);
  record_places(frame, recorder);
}

void TailedBuffer::report(const Frame& frame, std::span<const std::uint32_t> counts, RenderResult& result) {
  if (!frame.options.statistics && !frame.options.budget.maps) return;
  const std::vector<std::uint32_t> slots = blocks_ ? std::vector<std::uint32_t>(counts.size()) : keys(frame);
  for (std::size_t p = 0; p < counts.size(); ++p) {
    if (counts[p] > 0) add_k(result.stats, slots[p]);
  }
  if (!frame.options.budget.maps) return;
  const std::vector<float> seen = blocks_ ? std::vector<float>(counts.size()) : importance(frame);
  const std::uint32_t samples = frame.options.samples;
  for (std::size_t n = 0; n < counts.size(); ++n) {
    const std::uint64_t p = frame.sample_at(n / samples, static_cast<std::uint32_t>(n % samples));
    result.maps.importance.push_back(seen[p]);
    result.maps.k.push_back(counts[p] > 0 ? slots[p] : 0);
    result.maps.lost.push_back(counts[p] - std::min(counts[p], slots[p]));
  }
}

void TailedBuffer::clear_pool(Recorder& recorder, const Buffer& pool) {
  recorder.bind(Slot::a, pool);
  recorder.fill(pool, kNoFragment);
  recorder.barrier();
}

void TailedBuffer::gather(const Frame& frame, Recorder& recorder, std::string_view shader,
                          const Constants& constants) {
  frame.gather(recorder, shader, constants);
  recorder.barrier();
}

void TailedBuffer::resolve(const Frame& frame, Recorder& recorder, std::string_view shader,
                           const Constants& constants) {
  recorder.begin_resolve();
  recorder.dispatch(frame.pipelines.compute(shader, constants), frame.tiles_x(), frame.tiles_y());
}

}  // namespace pellucid::render
