// tailed_buffer.h - keeps the nearest fragments of every pixel within a memory budget, and one translucent
// layer behind them for the others, the tail. It is what fixed-k, hybrid, k-plus and variable-k share.
#pragma once

#include <optional>

#include "render/capture/k_buffers/memory_plan.h"
#include "render/capture/technique.h"

namespace pellucid::render {

// Returns the range of sums of this number of fragments: range_of() of shaders/capture/k_buffers/tail.glsl.
std::uint32_t tail_range(std::uint64_t fragments);

class BlockTails {
 public:
  void allocate(Frame& frame, const BlockPlan& plan);
  void record(const Frame& frame, Recorder& recorder) const;

 private:
  BlockPlan plan_;
  Buffer tails_, mask_;
};

// shaders/capture/k_buffers/places.glsl: kVariant.
enum class Places : std::uint32_t { uniform, mapped, mapped_with_weights, uniform_by_opacity };

class TailedBuffer : public Technique {
 public:
  // How much there is to hold decides what is made of the budget.
  [[nodiscard]] bool needs_counts(const Frame& /*frame*/) const override { return true; }
  // No buffer is larger than the device lets a shader address.
  [[nodiscard]] std::uint64_t largest_buffer(const Frame& /*frame*/) const override { return 0; }
  void allocate(Frame& frame) final;
  void start(Frame& frame, Recorder& recorder) final;
  void report(const Frame& frame, std::span<const std::uint32_t> counts, RenderResult& result) final;

 protected:
  static BudgetDemand demand_of(const Frame& frame, std::uint64_t bytes);
  // Where no budget is given.
  [[nodiscard]] virtual std::uint64_t default_bytes(const Frame& frame) const;
  // False: they do not fit.
  virtual bool allocate_places(Frame& frame, const BudgetDemand& demand) = 0;
  virtual void record_places(Frame& frame, Recorder& recorder) = 0;
  // Of every pixel: slots for fragments, and importance.
  [[nodiscard]] virtual std::vector<std::uint32_t> keys(const Frame& frame) const = 0;
  [[nodiscard]] virtual std::vector<float> importance(const Frame& frame) const = 0;

  // Before the first pass that puts keys into slots of a pool.
  static void clear_pool(Recorder& recorder, const Buffer& pool);
  // A pass over the fragments, and all that comes after it waits for it.
  static void gather(const Frame& frame, Recorder& recorder, std::string_view shader,
                     const Constants& constants);
  static void resolve(const Frame& frame, Recorder& recorder, std::string_view shader,
                      const Constants& constants);

 private:
  std::optional<BlockTails> blocks_;
};

}  // namespace pellucid::render
