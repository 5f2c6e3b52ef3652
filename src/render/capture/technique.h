// technique.h - what a capture technique is: how to add one, see docs/rendering.md.
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

  // Does it read Frame::counts? The pass that counts is one of its passes then.
  [[nodiscard]] virtual bool needs_counts(const Frame& /*frame*/) const { return false; }
  // Of those that keep to RenderOptions::memory: what they need for a image at least. Where that is more,
  // the image is cut into bands.
  [[nodiscard]] virtual std::uint64_t least_bytes(const Frame& /*frame*/) const { return 0; }
  // All that it takes for a image, at most; of those that `auto` chooses by it. Else 0.
  [[nodiscard]] virtual std::uint64_t most_bytes(const Frame& /*frame*/) const { return 0; }
  // Bytes of the largest buffer that it needs for a image: where it is too large, the image is cut into
  // bands.
  [[nodiscard]] virtual std::uint64_t largest_buffer(const Frame& frame) const = 0;
  // Buffers and images of a band, and what has to be done once before the first round.
  virtual void allocate(Frame& frame) = 0;
  virtual void start(Frame& frame, Recorder& recorder) = 0;
  // Once start() is done: what it counted on the device may decide how much memory the rounds need.
  virtual void allocate_rounds(Frame& /*frame*/) {}
  // Techniques that peel: one round, until one leaves nothing to be found (counters.active_pixels is 0 then).
  virtual void peel(Frame& /*frame*/, Recorder& /*recorder*/, std::uint32_t /*round*/) {}
  [[nodiscard]] virtual bool peels() const { return false; }
  // Of those that peel and know, after allocate(), how many rounds there will be; 0: they do not.
  [[nodiscard]] virtual std::uint64_t known_rounds() const { return 0; }
  // Those with OptionGroup::culling: the shader that says, after a round, whether a box can have fragments
  // left; what the round bound stays bound (culling.h).
  [[nodiscard]] virtual std::string_view box_shader() const { return ""; }
  // What only the technique knows of the image, once it is drawn; `counts`: fragments of every pixel.
  virtual void report(const Frame& /*frame*/, std::span<const std::uint32_t> /*counts*/,
                      RenderResult& /*result*/) {}
  // After the last round of those that peel.
  virtual void finish(Frame& /*frame*/, Recorder& /*recorder*/) {}
};

struct TechniqueEntry {
  TechniqueInfo info;
  // Null: for every image, one of the others is chosen (automatic.h).
  std::unique_ptr<Technique> (*make)();
};

// All of them, each defined in a file of its own (registry.h).
const std::vector<TechniqueEntry>& technique_entries();

}  // namespace pellucid::render
