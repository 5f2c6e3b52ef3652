// culling.h - triangles that are peeled completely are not drawn again.
//
// The scene's triangles are drawn in groups of neighbours. After a round of peeling the box of each group is
// drawn against the layers that the round left, with an occlusion query; the next round draws a group only if
// a sample of its box may still have fragments (conditional rendering: the CPU waits for nothing). The box of
// a culled group is not drawn either, so its query finds nothing again: culled stays culled. Section 4.3 of
// the depth-fighting paper, for parts of objects instead of objects.
#pragma once

#include <span>

#include "render/frame.h"

namespace pellucid::render {

class Culling {
 public:
  // Of what `frame` draws.
  explicit Culling(const Frame& frame);
  [[nodiscard]] std::span<const DrawRange> groups() const { return groups_; }
  [[nodiscard]] std::uint64_t triangles() const;  // of all groups
  [[nodiscard]] const Buffer& predicates() const { return predicates_; }

  // Before the first round: all are drawn.
  void start(Recorder& recorder) const;
  // After a round: `shader` (capture/box_*.frag) discards what cannot have fragments left.
  void test(const Frame& frame, Recorder& recorder, std::string_view shader) const;
  // Triangles that the last test left to be drawn; waits for it.
  [[nodiscard]] std::uint64_t triangles_left(Context& context) const;

 private:
  std::vector<DrawRange> groups_;
  Buffer corners_, indices_, bounds_, predicates_;
  OwnedQueryPool queries_;
};

}  // namespace pellucid::render
