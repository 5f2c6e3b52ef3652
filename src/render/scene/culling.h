// culling.h - avoids drawing triangles again that are peeled completely. Groups of triangles go in, and
// predicates that decide which of them are drawn come out.
//
// A group consists of triangles that are neighbours in the draw order. After a round of peeling, the box of
// each group is drawn against the layers that the round left, with an occlusion query. The next round draws a
// group only if a sample of its box may still have fragments. Conditional rendering decides this on the
// device, so the CPU does not wait. The box of a culled group is not drawn either, so its query finds nothing
// again, and the group stays culled. This is section 4.3 of the depth-fighting paper, for parts of objects
// instead of objects.
#pragma once

#include <span>

#include "render/frame.h"

namespace pellucid::render {

class Culling {
 public:
  // Makes the boxes of the groups that `frame` draws.
  explicit Culling(const Frame& frame);
  [[nodiscard]] std::span<const DrawRange> groups() const { return groups_; }
  [[nodiscard]] std::uint64_t triangles() const;  // of all groups
  [[nodiscard]] const Buffer& predicates() const { return predicates_; }

  // Sets all predicates. Called before the first round.
  void start(Recorder& recorder) const;
  // Tests all boxes after a round. `shader` is a form of capture/peeling/box_left.frag. It discards the
  // samples that cannot have fragments left.
  void test(const Frame& frame, Recorder& recorder, std::string_view shader) const;
  // Counts the triangles that the last test left to be drawn. Waits for the device.
  [[nodiscard]] std::uint64_t triangles_left(Context& context) const;

 private:
  std::vector<DrawRange> groups_;
  Buffer corners_, indices_, bounds_, predicates_;
  OwnedQueryPool queries_;
};

}  // namespace pellucid::render
