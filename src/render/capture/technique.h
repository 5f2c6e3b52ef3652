// technique.h - the interface of a capture technique: it stores fragments of every pixel on the device and
// folds them into the final colours. docs/rendering.md says how to add one.
//
// For each band of the image, the renderer calls allocate(), then start() (which is recorded and submitted),
// then allocate_rounds(). For techniques that peel it then calls peel() for every round, and finish(). The
// last call is report().
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

  // Returns whether the technique reads Frame::counts. Then the pass that counts fragments is one of its
  // passes.
  [[nodiscard]] virtual bool needs_counts(const Frame& /*frame*/) const { return false; }
  // Returns the least number of bytes that the technique needs for the frame, if it keeps to
  // BudgetOptions::bytes. If that is more than the budget, the image is cut into bands.
  [[nodiscard]] virtual std::uint64_t least_bytes(const Frame& /*frame*/) const { return 0; }
  // Returns an upper bound of the bytes that the technique takes for the frame, for techniques that `auto`
  // chooses by it, and 0 for others.
  [[nodiscard]] virtual std::uint64_t most_bytes(const Frame& /*frame*/) const { return 0; }
  // Returns the bytes of the largest buffer that the technique needs for the frame. If that is too large for
  // the device, the image is cut into bands.
  [[nodiscard]] virtual std::uint64_t largest_buffer(const Frame& frame) const = 0;
  // Makes the buffers and images of a band.
  virtual void allocate(Frame& frame) = 0;
  // Records everything. A technique that peels records only what comes before the first round.
  virtual void start(Frame& frame, Recorder& recorder) = 0;
  // Makes what the rounds need. Called after start() has run, because counts from the device may decide how
  // much that is.
  virtual void allocate_rounds(Frame& /*frame*/) {}
  // Records one round of a technique that peels. Rounds repeat until one finds nothing left and sets
  // Counters::active_pixels to 0.
  virtual void peel(Frame& /*frame*/, Recorder& /*recorder*/, std::uint32_t /*round*/) {}
  [[nodiscard]] virtual bool peels() const { return false; }
  // Returns the number of rounds for techniques that know it after allocate(), and 0 for others.
  [[nodiscard]] virtual std::uint64_t known_rounds() const { return 0; }
  // Returns the shader that decides after a round whether a box can still have fragments, for techniques with
  // OptionGroup::culling. The bindings of the round stay in place for it (culling.h).
  [[nodiscard]] virtual std::string_view box_shader() const { return ""; }
  // Adds to `result` what only the technique knows, after the image is drawn. `counts` has the number of
  // fragments of every pixel.
  virtual void report(const Frame& /*frame*/, std::span<const std::uint32_t> /*counts*/,
                      RenderResult& /*result*/) {}
  // Records what comes after the last round of a technique that peels.
  virtual void finish(Frame& /*frame*/, Recorder& /*recorder*/) {}
};

struct TechniqueEntry {
  TechniqueInfo info;
  // Null for `auto`, which chooses one of the other techniques for every image (automatic.h).
  std::unique_ptr<Technique> (*make)();
};

// Returns the techniques that registry.h lists.
const std::vector<TechniqueEntry>& technique_entries();

}  // namespace pellucid::render
