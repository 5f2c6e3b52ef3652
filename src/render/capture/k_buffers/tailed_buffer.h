// tailed_buffer.h - the base class of fixed-k, hybrid, k-plus and variable-k. Within a memory budget they
// keep the nearest fragments of every pixel, and one translucent layer behind them for the others, the tail.
#pragma once

#include <optional>

#include "render/capture/k_buffers/memory_plan.h"
#include "render/capture/technique.h"

namespace pellucid::render {

// Returns the range of the sums of this number of fragments, as range_of() of
// shaders/capture/k_buffers/tail.glsl does.
std::uint32_t tail_range(std::uint64_t fragments);

class BlockTails {
 public:
  void allocate(Frame& frame, const BlockPlan& plan);
  void record(const Frame& frame, Recorder& recorder) const;

 private:
  BlockPlan plan_;
  Buffer tails_, mask_;
};

// The forms of places: kVariant of shaders/capture/k_buffers/places.glsl.
enum class Places : std::uint32_t { uniform, mapped, mapped_with_weights, uniform_by_opacity };

class TailedBuffer : public Technique {
 public:
  // The counts decide how the budget is used.
  [[nodiscard]] bool needs_counts(const Frame& /*frame*/) const override { return true; }
  // 0, because plans never exceed the largest buffer that a shader can address.
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& /*frame*/) const override { return 0; }
  void allocate(Frame& frame) final;
  void start(Frame& frame, Recorder& recorder) final;
  void report(const Frame& frame, std::span<const std::uint32_t> counts, RenderResult& result) final;

 protected:
  static BudgetDemand demand_of(const Frame& frame, std::uint64_t bytes);
  // Returns the budget that is used if none is given.
  [[nodiscard]] virtual std::uint64_t default_bytes(const Frame& frame) const;
  // Makes the buffers for places. Returns false if they do not fit.
  virtual bool allocate_places(Frame& frame, const BudgetDemand& demand) = 0;
  virtual void record_places(Frame& frame, Recorder& recorder) = 0;
  // Return the number of slots for fragments, and the importance, of every pixel.
  [[nodiscard]] virtual std::vector<std::uint32_t> keys(const Frame& frame) const = 0;
  [[nodiscard]] virtual std::vector<float> importance(const Frame& frame) const = 0;

  // Empties all slots. Called before the first pass that puts keys into slots.
  static void clear_pool(Recorder& recorder, const Buffer& pool);
  // Records a pass over the fragments, and a barrier after it.
  static void gather(const Frame& frame, Recorder& recorder, std::string_view shader,
                     const Constants& constants);
  static void resolve(const Frame& frame, Recorder& recorder, std::string_view shader,
                      const Constants& constants);

 private:
  std::optional<BlockTails> blocks_;
};

}  // namespace pellucid::render
