// technique.h - the interface of a capture technique: it stores fragments of every pixel on the device and
// folds them into the final colours. docs/rendering.md says how to add one.
//
// The renderer calls, for each band of the image: allocate(); start(), recorded and submitted;
// allocate_rounds(); for techniques that peel, peel() for every round and finish(); and report().
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "render/frame.h"

namespace pellucid::render {

class Technique {
 public:
  Technique() = default;
  Technique(const Technique&) = delete;
  Technique& operator=(const Technique&) = delete;
  virtual ~Technique() = default;

  // Returns whether it reads Frame::counts. If so, the pass that counts is one of its passes.
  [[nodiscard]] virtual bool needs_counts(const Frame& /*frame*/) const { return false; }
  // Returns the least bytes that it needs for the frame, of techniques that keep to BudgetOptions::bytes.
  // Where that is more than the budget, the image is cut into bands.
  [[nodiscard]] virtual std::uint64_t least_bytes(const Frame& /*frame*/) const { return 0; }
  // Returns the most bytes that it takes for the frame, of techniques that `auto` chooses by it; of others 0.
  [[nodiscard]] virtual std::uint64_t most_bytes(const Frame& /*frame*/) const { return 0; }
  // Returns the bytes of the largest buffer that it needs for the frame. Where that is too large for the
  // device, the image is cut into bands.
  [[nodiscard]] virtual std::uint64_t largest_buffer(const Frame& frame) const = 0;
  // Makes buffers and images of a band.
  virtual void allocate(Frame& frame) = 0;
  // Records everything, or, of techniques that peel, what comes before the first round.
  virtual void start(Frame& frame, Recorder& recorder) = 0;
  // Makes what the rounds need, once start() is done: what it counted on the device may decide how much that
  // is.
  virtual void allocate_rounds(Frame& /*frame*/) {}
  // Records one round of a technique that peels. Rounds follow until one leaves nothing to be found, and sets
  // Counters::active_pixels to 0.
  virtual void peel(Frame& /*frame*/, Recorder& /*recorder*/, std::uint32_t /*round*/) {}
  [[nodiscard]] virtual bool peels() const { return false; }
  // Returns the number of rounds, of techniques that know it after allocate(); of others 0.
  [[nodiscard]] virtual std::uint64_t known_rounds() const { return 0; }
  // Returns the shader that decides, after a round, whether a box can have fragments left, of techniques with
  // OptionGroup::culling. What the round bound stays bound (culling.h).
  [[nodiscard]] virtual std::string_view box_shader() const { return ""; }
  // Adds to `result` what only the technique knows, once the image is drawn. `counts`: fragments of every
  // pixel.
  virtual void report(const Frame& /*frame*/, std::span<const std::uint32_t> /*counts*/,
                      RenderResult& /*result*/) {}
  // Records what comes after the last round of a technique that peels.
  virtual void finish(Frame& /*frame*/, Recorder& /*recorder*/) {}
};

struct TechniqueEntry {
  TechniqueInfo info;
  // Null: for every image, one of the others is chosen (automatic.h).
  std::unique_ptr<Technique> (*make)();
};

// Returns the techniques that registry.h lists.
const std::vector<TechniqueEntry>& technique_entries();

}  // namespace pellucid::render
